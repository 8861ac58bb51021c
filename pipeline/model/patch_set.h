// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "model/mesh.h"
#include "model/scene.h"
#include "model/surface.h"

namespace kinelux::model {

/// A trimmed piece of one surface: what carries radiosity as a smooth function.
struct Patch {
    ObjectId object;
    MaterialId material;
    Surface surface;
    std::vector<Vec2> points;        ///< the domain's vertices (u,v)
    std::vector<Triangle> triangles; ///< a triangulation of the domain, counter-clockwise in (u,v)
    std::vector<std::vector<std::uint32_t>>
        loops;                  ///< closed boundaries: outer counter-clockwise first, holes clockwise
    double deviation_max = 0.0; ///< largest distance of the source vertices from the surface [m]
    double deviation_rms = 0.0; ///< [m]
};

/// Triangles that no patch holds, of all objects; each belongs to exactly one cluster later.
struct SmallTriangles {
    std::vector<Vec3> points; ///< [m]
    std::vector<Triangle> triangles;
    std::vector<ObjectId> objects;     ///< one per triangle
    std::vector<MaterialId> materials; ///< one per triangle
};

/// All geometry that exchanges light. Two-sided faces are in it twice, back to back, each copy one-sided.
struct PatchSet {
    std::vector<Patch> patches;
    SmallTriangles small;
};

/// @throws GeometryError  ids out of range of the scene, indices out of range, wrong sizes, not finite
void check(const PatchSet& patches, const Scene& scene);

} // namespace kinelux::model
