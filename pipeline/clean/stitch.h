// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::clean {

/// Triangles without cracks and T-junctions narrower than a tolerance.
struct Stitched {
    std::vector<model::Triangle> triangles; ///< of the same points
    std::vector<std::size_t> source;        ///< of each: the triangle it was, or was a part of
    std::size_t joined_points = 0;          ///< at borders, made one with another
    std::size_t divided_edges = 0;          ///< at borders, times they were divided at a point beside them
    std::size_t dropped = 0;                ///< triangles that lost their area
    double largest_move = 0.0;              ///< of a point to another, or of an edge to a point [m]
};

/// Makes borders meet: border points nearer to each other than the tolerance become one (the earlier), unless an edge joins
/// them; then border edges are divided at border points nearer to them than that. Borders are edges of one triangle; what
/// already meets is left alone. Triangles of which two corners become one are dropped.
/// @param tolerance  [m]; 0 does nothing
Stitched stitch_borders(std::span<const Vec3> points, std::span<const model::Triangle> triangles,
                        double tolerance);

} // namespace kinelux::clean
