// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/domain_cut.h"

#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "core/sequence.h"

namespace kinelux::geometry {
namespace {

double twice_area(const model::DomainTriangle& t) {
    return (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
}

// A fan of triangles around a random point of a square, corners at awkward numbers.
std::vector<model::DomainTriangle> fan(std::uint64_t seed) {
    core::Random random(seed);
    const Vec2 centre = 0.2 + 0.6 * random.next_2d();
    std::vector<model::DomainTriangle> triangles;
    const std::vector<Vec2> ring{{0.0, 0.0}, {random.next(), 0.0}, {1.0, 0.0}, {1.0, random.next()},
                                 {1.0, 1.0}, {random.next(), 1.0}, {0.0, 1.0}, {0.0, random.next()}};
    for (std::size_t i = 0; i < ring.size(); ++i)
        triangles.push_back({ring[i], ring[(i + 1) % ring.size()], centre});
    return triangles;
}

TEST(DomainCut, lines_divide_into_the_fewest_parts_that_are_small_enough) {
    EXPECT_EQ(grid_lines(0.0, 3.0, 1.0).size(), 4U);
    EXPECT_EQ(grid_lines(0.0, 3.0 + 1e-12, 1.0).size(), 4U);
    EXPECT_EQ(grid_lines(0.0, 3.1, 1.0).size(), 5U);
    EXPECT_EQ(grid_lines(-1.0, 1.0, 100.0).size(), 2U);
    EXPECT_EQ(grid_lines(0.1, 0.7, 0.2).back(), 0.7);
}

TEST(DomainCut, pieces_keep_the_area_and_lie_in_their_cells) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const std::vector<double> u_lines = grid_lines(0.0, 1.0, 0.13), v_lines = grid_lines(0.0, 1.0, 0.29);
        double area = 0.0;
        for (const DomainCell& cell : cut_domain(fan(seed), u_lines, v_lines)) {
            for (const model::DomainTriangle& t : cell.triangles) {
                area += 0.5 * twice_area(t);
                for (const Vec2& p : t) {
                    EXPECT_GE(p.x, u_lines[cell.column] - 1e-10) << "seed " << seed;
                    EXPECT_LE(p.x, u_lines[cell.column + 1] + 1e-10);
                    EXPECT_GE(p.y, v_lines[cell.row] - 1e-10);
                    EXPECT_LE(p.y, v_lines[cell.row + 1] + 1e-10);
                }
            }
        }
        EXPECT_NEAR(area, 1.0, 1e-13) << "seed " << seed;
    }
}

TEST(DomainCut, neighbours_share_their_corners_to_the_last_bit) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        std::set<std::tuple<double, double, double, double>> edges;
        for (const DomainCell& cell :
             cut_domain(fan(seed), grid_lines(0.0, 1.0, 0.13), grid_lines(0.0, 1.0, 0.29))) {
            for (const model::DomainTriangle& t : cell.triangles) {
                for (int k = 0; k < 3; ++k) {
                    const Vec2 &a = t[k], &b = t[(k + 1) % 3];
                    EXPECT_TRUE(edges.insert({a.x, a.y, b.x, b.y}).second) << "seed " << seed;
                }
            }
        }
        double open = 0.0;
        for (const auto& [ax, ay, bx, by] : edges) {
            if (!edges.contains({bx, by, ax, ay})) open += std::hypot(bx - ax, by - ay);
        }
        EXPECT_NEAR(open, 4.0, 1e-12) << "seed " << seed;
    }
}

TEST(DomainCut, corners_almost_on_a_line_leave_no_slivers) {
    const double off = 1e-13;
    const std::vector<model::DomainTriangle> domain{
        {Vec2{0.0, 0.0}, Vec2{0.5 + off, 0.0}, Vec2{0.5 - off, 1.0}}};
    const std::vector<double> u_lines{0.0, 0.5, 1.0}, v_lines{0.0, 1.0};
    const std::vector<DomainCell> cells = cut_domain(domain, u_lines, v_lines);
    ASSERT_EQ(cells.size(), 1U);
    EXPECT_EQ(cells[0].triangles.size(), 1U);
}

TEST(DomainCut, cells_outside_the_domain_are_left_out) {
    const std::vector<model::DomainTriangle> domain{{Vec2{0.0, 0.0}, Vec2{1.0, 0.0}, Vec2{0.0, 1.0}}};
    const std::vector<double> lines{0.0, 0.25, 0.5, 0.75, 1.0};
    EXPECT_EQ(cut_domain(domain, lines, lines).size(), 10U);
}

} // namespace
} // namespace kinelux::geometry
