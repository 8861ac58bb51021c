// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "fit/domain.h"

namespace kinelux::fit {

/// A triangulation of the convex hull of points that keeps edges.
struct Triangulation {
    std::vector<Vec2> points;               ///< the given ones first, then crossings of edges
    std::vector<model::Triangle> triangles; ///< counter-clockwise
    std::vector<std::array<std::int32_t, 3>>
        neighbours;                                ///< behind the edge from corner k to k + 1; -1 = none
    std::vector<std::array<std::uint8_t, 3>> kept; ///< 1 = that edge lies on a given edge
};

/// Constrained Delaunay triangulation. Equal points are one corner: the first of them is named.
/// @param points  at least three, not all on one line, else the result has no triangles
Triangulation triangulate(std::span<const Vec2> points, std::span<const Edge> edges);

} // namespace kinelux::fit
