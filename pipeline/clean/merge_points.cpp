// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/merge_points.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace kinelux::clean {

namespace {

// The cell of a grid of cubes whose edge is the tolerance; without tolerance, the point itself.
using Cell = std::array<double, 3>;

Cell cell_of(const Vec3& x, const Vec3& base, double tolerance) {
    if (tolerance <= 0.0) return {x.x, x.y, x.z};
    const Vec3 place = glm::floor((x - base) / tolerance);
    return {place.x, place.y, place.z};
}

using Grid = std::map<Cell, std::vector<std::uint32_t>>;

std::optional<std::uint32_t> earliest_near(const Grid& grid, const std::vector<Vec3>& kept, const Vec3& x,
                                           const Cell& centre, double tolerance) {
    std::optional<std::uint32_t> best;
    const int reach = tolerance > 0.0 ? 1 : 0;
    for (int i = -reach; i <= reach; ++i) {
        for (int j = -reach; j <= reach; ++j) {
            for (int k = -reach; k <= reach; ++k) {
                const auto at = grid.find({centre[0] + i, centre[1] + j, centre[2] + k});
                if (at == grid.end()) continue;
                for (const std::uint32_t candidate : at->second) {
                    if (glm::distance(kept[candidate], x) > tolerance) continue;
                    if (!best || candidate < *best) best = candidate;
                }
            }
        }
    }
    return best;
}

} // namespace

MergedPoints merge_points(std::span<const Vec3> points, double tolerance) {
    MergedPoints merged;
    Vec3 base{std::numeric_limits<double>::infinity()};
    for (const Vec3& x : points) base = glm::min(base, x);
    Grid grid;
    for (const Vec3& x : points) {
        const Cell cell = cell_of(x, base, tolerance);
        std::optional<std::uint32_t> number = earliest_near(grid, merged.points, x, cell, tolerance);
        if (!number) {
            number = static_cast<std::uint32_t>(merged.points.size());
            grid[cell].push_back(*number);
            merged.points.push_back(x);
        }
        merged.number.push_back(*number);
    }
    return merged;
}

} // namespace kinelux::clean
