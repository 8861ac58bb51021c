// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace kinelux::geometry {

/// A corner of one triangle of a list.
struct TriangleCorner {
    std::uint32_t triangle;
    std::uint32_t corner; ///< 0..2
};

/// Closed boundary loops of a set of triangles: directed edges that another triangle runs the other way cancel, the
/// rest are chained; where a loop comes back to a point of its own it is closed there. Counter-clockwise around the
/// triangles seen from their front, clockwise around holes. Corners match where their coordinates are equal; triangles
/// that meet along a divided edge keep their own loops, so that the signed sum over all loops is right in any case.
/// @param triangles  corners; two equal corners: left out
/// @return  loops of three corners or more, each starting at its first corner in order of the triangles
std::vector<std::vector<TriangleCorner>> boundary_loops(std::span<const std::array<Vec3, 3>> triangles);

/// Indices of the points of a closed loop at which it turns.
/// @param tolerance  a point turns where it is further than this share of its two edges' lengths off their direction;
///                   0: only points exactly on the way are left out
std::vector<std::size_t> turning_points(std::span<const Vec3> loop, double tolerance);

} // namespace kinelux::geometry
