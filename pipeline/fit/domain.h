// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "fit/charts.h"
#include "fit/faces.h"
#include "model/patch_set.h"

namespace kinelux::fit {

using Edge = std::array<std::uint32_t, 2>; ///< from, to; into the points beside it

/// A directed edge of a chart behind which no face of the chart lies; the chart is on its left.
struct BoundaryEdge {
    std::uint32_t face; ///< into Body::faces
    std::uint32_t k;    ///< from corner k to corner k + 1
};

std::vector<BoundaryEdge> boundary_edges(const Body& body, const Chart& chart);

/// A chart laid into its plane.
struct FlatChart {
    model::Surface surface;                 ///< a plane; the domain lies in u, v >= 0 and touches both axes
    std::vector<Vec2> points;               ///< projected corners of its faces
    std::vector<model::Triangle> triangles; ///< its faces
    std::vector<Edge> boundary;             ///< the chart is on the left of each
    Vec2 extent{0.0};                       ///< largest u and v [m]
    double area = 0.0;                      ///< of the projected faces [m2]
};

/// Projects a chart onto its plane. The axes follow the direction that the most boundary length runs along, modulo a
/// right angle, so that grids align with walls; u is the longer side.
FlatChart flatten(const Body& body, const Chart& chart);

} // namespace kinelux::fit
