// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "model/scene.h"

namespace kinelux::reference {

/// A triangle of the scene in world position.
struct WorldTriangle {
    Vec3 corner{0.0}, edge1{0.0}, edge2{0.0}; ///< [m]
    Vec3 normal{0.0};                         ///< unit, to the front; (0,0,0) without area
    double area = 0.0;                        ///< [m2]
    ObjectId object;
    std::uint32_t triangle = 0; ///< of the object's mesh
    MaterialId material;
    bool both_sides = false; ///< the back reflects and emits as the front does

    /// The point at the image of the unit square under the area-preserving map to the triangle.
    Vec3 point(const Vec2& square) const;
};

/// All triangles of a scene at one time, in order of objects, then of their meshes.
struct World {
    World(const model::Scene& scene, double time_s);

    std::vector<WorldTriangle> triangles;
    std::vector<std::size_t> first_of_object; ///< into triangles

    const WorldTriangle& at(std::size_t object, std::size_t triangle) const {
        return triangles[first_of_object[object] + triangle];
    }
};

} // namespace kinelux::reference
