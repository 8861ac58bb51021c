// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geometry/element_shape.h"
#include "geometry/pose.h"
#include "model/scene.h"
#include "model/surface_field.h"
#include "sample/sampler.h"
#include "visibility/occluders.h"

namespace kinelux::sample {

struct ShadowMeshOptions {
    double tolerance =
        0.03; ///< of direct irradiance in the middle of an edge, relative to the larger of its value
              ///< there and its mean over all surfaces, > 0
    double smallest_edge = 0.0; ///< edges no longer than this are not cut [m], > 0
};

struct ShadowMesh {
    model::DisplayMesh mesh;
    double unresolved_area =
        0.0; ///< of triangles in penumbra whose edges may not be cut but differ by more [m2]
};

/// Cuts the triangles of a display mesh where direct light is not linear along their edges: at shadows and close to
/// sources, in one frame. Conforming inside each patch and cluster, by bisection of longest edges (Rivara 1984), which
/// keeps triangles from getting thin. Points of the given mesh keep their numbers; the same light gives the same mesh.
/// @param rest        from display_mesh()
/// @param poses       one per object
/// @param occluders   in these poses
ShadowMesh shadow_mesh(const model::DisplayMesh& rest, const model::PatchSet& patches,
                       std::span<const geometry::ElementShape> rest_elements, const model::Scene& scene,
                       double time_s, std::span<const geometry::Pose> poses,
                       const visibility::Occluders& occluders, const DirectLightOptions& direct,
                       const ShadowMeshOptions& options);

} // namespace kinelux::sample
