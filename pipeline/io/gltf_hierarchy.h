// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/vec.h"
#include "model/scene.h"

// The nodes of a glTF file and how they move; private to io.
namespace kinelux::io {

struct GltfNode {
    std::string name;
    int parent = -1; ///< -1: a root
    Vec3 translation{0.0};
    Quat rotation{1.0, 0.0, 0.0, 0.0};
    Vec3 scale{1.0};
    std::optional<Mat4> matrix; ///< instead of the three above; such a node cannot be animated
};

/// The keys of one animated property of one node.
struct GltfTrack {
    int node = -1;
    bool is_rotation = false; ///< else a translation
    model::Interpolation interpolation = model::Interpolation::Linear;
    std::vector<double> times_s;                 ///< strictly increasing, at least one
    std::vector<Quat> values;                    ///< one per key; a translation is kept in (x, y, z)
    std::vector<Quat> in_tangents, out_tangents; ///< one per key where the interpolation is cubic, else empty

    Quat at(double time_s) const; ///< clamped to the first and last key; of a cubic rotation not yet unit
    /// Rates of change just before and after a time of a cubic track [1/s]; zero outside its keys.
    std::pair<Quat, Quat> slopes_at(double time_s) const;
};

struct GltfHierarchy {
    std::vector<GltfNode> nodes; ///< parents form no circle
    std::vector<GltfTrack> tracks;

    /// Where a node's own coordinates lie when nothing moves.
    Mat4 rest_world_from_node(int node) const;
    /// The node itself or its nearest ancestor that has a track; -1: none, the node rests.
    int mover_of(int node) const;
    /// The path of an animated node by itself, as it moves everything below it while its ancestors rest. Its keys are
    /// those of all its tracks, and between them it is what the tracks say.
    /// @return  without parent; unset where the path is not a rigid motion (scaled parents)
    std::optional<model::Motion> motion_of(int mover) const;

private:
    const GltfTrack* track_of(int node, bool is_rotation) const;
};

} // namespace kinelux::io
