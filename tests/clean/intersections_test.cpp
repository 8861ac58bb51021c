// SPDX-License-Identifier: GPL-3.0-or-later
// Faults are put into a good surface at random places; exactly they are to be found.
#include "clean/intersections.h"

#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::clean {
namespace {

struct Surface {
    std::vector<Vec3> points;
    std::vector<model::Triangle> triangles;
};

// A flat grid of unit cells, two triangles each: cell (i, j) has the triangles 2 (j n + i) and the next.
Surface flat_grid(std::uint32_t n) {
    Surface grid;
    for (std::uint32_t j = 0; j <= n; ++j) {
        for (std::uint32_t i = 0; i <= n; ++i) grid.points.emplace_back(i, j, 0.0);
    }
    for (std::uint32_t j = 0; j < n; ++j) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t p = j * (n + 1) + i;
            grid.triangles.push_back({p, p + 1, p + n + 2});
            grid.triangles.push_back({p, p + n + 2, p + n + 1});
        }
    }
    return grid;
}

// A small upright triangle of its own through the middle of a cell's first triangle.
void add_spike(Surface& grid, std::uint32_t n, std::uint32_t cell) {
    const std::uint32_t row = cell / n;
    const double x = cell % n + 0.7, y = row + 0.3;
    const auto first = static_cast<std::uint32_t>(grid.points.size());
    grid.points.emplace_back(x - 0.05, y, -0.1);
    grid.points.emplace_back(x + 0.05, y, -0.1);
    grid.points.emplace_back(x, y, 0.1);
    grid.triangles.push_back({first, first + 1, first + 2});
}

// The boxes of more pairs meet than are tested at a time (2^20), so that batches are joined as well.
TEST(Intersections, injected_crossings_are_found_and_nothing_else) {
    constexpr std::uint32_t n = 330;
    constexpr std::size_t faults = 200;
    Surface grid = flat_grid(n);
    EXPECT_EQ(find_self_intersections(grid.points, grid.triangles).pairs, 0U);

    std::mt19937 random(20031);
    std::set<std::uint32_t> expected;
    while (expected.size() < 2 * faults) {
        const auto cell = static_cast<std::uint32_t>(random() % (n * n));
        if (!expected.insert(2 * cell).second) continue;
        expected.insert(static_cast<std::uint32_t>(grid.triangles.size()));
        add_spike(grid, n, cell);
    }
    const SelfIntersections found = find_self_intersections(grid.points, grid.triangles);
    EXPECT_EQ(found.pairs, faults);
    EXPECT_EQ(found.faces, std::vector<std::uint32_t>(expected.begin(), expected.end()));
}

} // namespace
} // namespace kinelux::clean
