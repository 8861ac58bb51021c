// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "core/vec.h"
#include "model/mesh.h"
#include "visibility/loops.h"

namespace kinelux::visibility {

/// Joins the triangles of a planar polygon to few convex polygons: edges between two pieces are removed one after
/// another where what results is convex. At most four times as many pieces as possible.
/// @param points     [m]
/// @param triangles  into points, counter-clockwise seen from where `normal` points to, without overlap
/// @param normal     unit, of the plane
/// @cite Hertel, Mehlhorn, Fast triangulation of simple polygons, Foundations of Computation Theory 1983
Loops3 convex_pieces(std::span<const Vec3> points, std::span<const model::Triangle> triangles,
                     const Vec3& normal);

} // namespace kinelux::visibility
