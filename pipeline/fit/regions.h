// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "fit/domain.h"

namespace kinelux::fit {

/// A connected piece of a plane with its exact boundary.
struct Region {
    std::vector<Vec2> points;
    std::vector<model::Triangle> triangles; ///< as few as the boundary's points need, counter-clockwise
    std::vector<std::vector<std::uint32_t>> loops; ///< outer counter-clockwise first, holes clockwise
    double area = 0.0;                             ///< [m2]
    Vec2 inner{0.0};                               ///< a point well inside
};

struct RegionOptions {
    double least_width = 0.0;  ///< a region thinner than this joins a neighbour [m]
    double least_share = 1e-8; ///< a region smaller than this share of the whole joins a neighbour [1]
};

/// The regions into which cuts divide what lies on the left of the boundary edges. Cuts that separate nothing leave no
/// trace. Edges of both kinds may meet at common points only.
std::vector<Region> divide_domain(std::span<const Vec2> points, std::span<const Edge> boundary,
                                  std::span<const Edge> cuts, const RegionOptions& options);

/// Closed loops of directed edges, the outermost first. Where loops touch in a point they do not cross.
std::vector<std::vector<std::uint32_t>> chain_loops(std::span<const Vec2> points,
                                                    std::span<const Edge> edges);

} // namespace kinelux::fit
