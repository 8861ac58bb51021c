// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "geometry/pose.h"
#include "model/cluster_tree.h"
#include "model/patch_set.h"

namespace kinelux::support {

/// A place to put a scene: scaled about the origin, then turned and moved. Form factors are the same in all of them.
struct Placement {
    std::string name;
    double scale = 1.0;
    geometry::Pose pose;

    Vec3 point(const Vec3& p) const { return pose.point(scale * p); }
};

/// As it is, turned, in millimetres and kilometres, ten kilometres away, and turned there.
inline std::vector<Placement> placements() {
    const Quat turn = glm::normalize(Quat(0.3, 0.5, -0.2, 0.7)),
               other = glm::normalize(Quat(0.9, 0.1, 0.3, 0.2));
    return {{"as it is"},
            {"turned", 1.0, {turn, Vec3(0.0)}},
            {"scaled by 1e-3", 1e-3, {}},
            {"scaled by 1e3", 1e3, {}},
            {"moved by 1e4 m", 1.0, {Quat(1, 0, 0, 0), Vec3(6e3, -8e3, 0)}},
            {"turned and moved by 1e4 m", 1.0, {other, Vec3(0, 6e3, -8e3)}}};
}

/// Planar patches and small triangles in a placement.
inline model::PatchSet placed(model::PatchSet set, const Placement& place) {
    for (model::Patch& patch : set.patches) {
        patch.surface.origin = place.point(patch.surface.origin);
        patch.surface.axis_u = place.pose.direction(patch.surface.axis_u);
        patch.surface.axis_v = place.pose.direction(patch.surface.axis_v);
        patch.surface.axis_w = place.pose.direction(patch.surface.axis_w);
        for (Vec2& point : patch.points) point *= place.scale;
    }
    for (Vec3& point : set.small.points) point = place.point(point);
    return set;
}

/// Elements of such patches: their domains are in the patches' own coordinates.
inline model::ClusterTree placed(model::ClusterTree tree, const Placement& place) {
    for (model::DomainTriangle& triangle : tree.domain_triangles)
        for (Vec2& point : triangle) point *= place.scale;
    return tree;
}

} // namespace kinelux::support
