// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "model/surface.h"

namespace kinelux::model {

using Triangle = std::array<std::uint32_t, 3>; ///< corner indices, counter-clockwise seen from the front

/// An indexed triangle soup in double precision; the outside form of all geometry. The front of a face is the side its
/// normal (p1 - p0) x (p2 - p0) points to.
struct Mesh {
    std::vector<Vec3> points; ///< [m]
    std::vector<Triangle> triangles;
    std::vector<MaterialId> materials; ///< one per triangle
    std::vector<std::uint8_t>
        two_sided; ///< one per triangle, 1 = both sides exchange light; empty until cleaned
    std::vector<std::uint32_t>
        source_faces; ///< one per triangle: number of the face in the file it came from
    std::vector<Surface>
        surfaces; ///< exact surfaces of the file's faces, in the mesh's coordinates; empty: none stated
    std::vector<std::uint32_t>
        surface_of; ///< one per triangle: into `surfaces`, or no_surface; empty where `surfaces` is. The corners
    ///< lie on the surface; `orientation` is such that its normal points to the triangle's front
};

constexpr std::uint32_t no_surface = 0xffffffffU; ///< of a triangle that no exact surface is known of

double area(const Mesh& mesh);                                ///< [m2]
double signed_volume(const Mesh& mesh);                       ///< [m3]; meaningful where the mesh is closed
Vec3 triangle_normal(const Mesh& mesh, std::size_t triangle); ///< unit; (0,0,0) for a face without area

/// @param where  starts the message, e.g. the object's name
/// @throws GeometryError  sizes differ, an index is out of range, a coordinate is not finite
void check(const Mesh& mesh, const std::string& where);

} // namespace kinelux::model
