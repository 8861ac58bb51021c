// SPDX-License-Identifier: GPL-3.0-or-later
// Cracks and T-junctions are put into closed surfaces at random places; all of them are to be closed.
#include "clean/stitch.h"

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "clean/merge_points.h"

namespace kinelux::clean {
namespace {

struct Surface {
    std::vector<Vec3> points;
    std::vector<model::Triangle> triangles;
};

// A ball of radius 1 with bumps, closed.
Surface bumpy_ball(int rings) {
    Surface ball;
    const int around = 2 * rings;
    const auto point = [&](int i, int j) {
        const double v = std::numbers::pi * i / rings, u = 2.0 * std::numbers::pi * j / around;
        const double r = 1.0 + 0.05 * std::sin(5.0 * u) * std::sin(4.0 * v) * std::sin(v);
        return r * Vec3(std::sin(v) * std::cos(u), std::sin(v) * std::sin(u), std::cos(v));
    };
    ball.points.push_back(point(0, 0));
    for (int i = 1; i < rings; ++i)
        for (int j = 0; j < around; ++j) ball.points.push_back(point(i, j));
    ball.points.push_back(point(rings, 0));
    const auto number = [&](int i, int j) {
        if (i == 0) return 0u;
        if (i == rings) return static_cast<std::uint32_t>(ball.points.size() - 1);
        return static_cast<std::uint32_t>(1 + (i - 1) * around + j % around);
    };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < around; ++j) {
            if (i > 0) ball.triangles.push_back({number(i, j), number(i + 1, j), number(i, j + 1)});
            if (i + 1 < rings)
                ball.triangles.push_back({number(i, j + 1), number(i + 1, j), number(i + 1, j + 1)});
        }
    return ball;
}

double volume(const std::vector<Vec3>& points, const std::vector<model::Triangle>& triangles) {
    double sum = 0.0;
    for (const model::Triangle& t : triangles)
        sum += glm::dot(points[t[0]], glm::cross(points[t[1]], points[t[2]])) / 6.0;
    return sum;
}

std::size_t open_edges(const std::vector<model::Triangle>& triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
    for (const model::Triangle& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) ++count[std::minmax(t[k], t[(k + 1) % 3])];
    std::size_t open = 0;
    for (const auto& [edge, n] : count) open += n != 2 ? 1 : 0;
    return open;
}

TEST(StitchBorders, leave_a_closed_surface_alone) {
    const Surface ball = bumpy_ball(20);
    ASSERT_EQ(open_edges(ball.triangles), 0u);
    const Stitched result = stitch_borders(ball.points, ball.triangles, 1e-3);
    EXPECT_EQ(result.triangles, ball.triangles);
    EXPECT_EQ(result.joined_points + result.divided_edges, 0u);
}

// Random triangles are taken out of the surface, to corners of their own a little off.
TEST(StitchBorders, close_injected_cracks) {
    Surface ball = bumpy_ball(30);
    const double whole = volume(ball.points, ball.triangles);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> jitter(-2e-5, 2e-5);
    for (int fault = 0; fault < 200; ++fault) {
        model::Triangle& t = ball.triangles[random() % ball.triangles.size()];
        for (std::uint32_t& corner : t) {
            ball.points.push_back(ball.points[corner] + Vec3(jitter(random), jitter(random), jitter(random)));
            corner = static_cast<std::uint32_t>(ball.points.size() - 1);
        }
    }
    ASSERT_GT(open_edges(ball.triangles), 300u);
    EXPECT_GT(open_edges(stitch_borders(ball.points, ball.triangles, 1e-6).triangles), 300u);
    const Stitched result = stitch_borders(ball.points, ball.triangles, 2e-4);
    EXPECT_EQ(open_edges(result.triangles), 0u);
    EXPECT_NEAR(volume(ball.points, result.triangles), whole, 1e-4);
    EXPECT_LE(result.largest_move, 2e-4);
    EXPECT_GT(result.joined_points, 300u);
}

// Random edges are divided in one of their two triangles only, at one to three points a little beside them.
TEST(StitchBorders, close_injected_t_junctions) {
    Surface ball = bumpy_ball(30);
    const double whole = volume(ball.points, ball.triangles);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> share(0.2, 0.8), jitter(-1e-6, 1e-6);
    std::vector<std::uint8_t> touched(ball.triangles.size(), 0);
    std::size_t faults = 0;
    for (int attempt = 0; attempt < 300; ++attempt) {
        const std::size_t f = random() % touched.size();
        if (touched[f]++ != 0) continue;
        const model::Triangle t = ball.triangles[f];
        std::uint32_t last = t[0];
        const auto parts = 2 + random() % 3;
        for (std::size_t k = 1; k < parts; ++k) {
            const double along =
                (static_cast<double>(k - 1) + share(random)) / static_cast<double>(parts - 1);
            ball.points.push_back(ball.points[t[0]] + along * (ball.points[t[1]] - ball.points[t[0]]) +
                                  Vec3(jitter(random), jitter(random), jitter(random)));
            const auto next = static_cast<std::uint32_t>(ball.points.size() - 1);
            ball.triangles.push_back({last, next, t[2]});
            last = next;
            ++faults;
        }
        ball.triangles[f] = {last, t[1], t[2]};
    }
    ASSERT_GT(open_edges(ball.triangles), faults);
    const Stitched result = stitch_borders(ball.points, ball.triangles, 1e-4);
    EXPECT_EQ(open_edges(result.triangles), 0u);
    EXPECT_NEAR(volume(ball.points, result.triangles), whole, 1e-5);
    // Where both triangles of an edge were divided, each gets the other's points.
    EXPECT_GE(result.divided_edges, faults);
    EXPECT_LE(result.largest_move, 1e-5);
    for (std::size_t k = 0; k < result.triangles.size(); ++k)
        EXPECT_LT(result.source[k], ball.triangles.size());
}

// A strip of faces that is thinner than the tolerance keeps its points: edges join them.
TEST(StitchBorders, keep_details_that_edges_join) {
    std::vector<Vec3> points;
    std::vector<model::Triangle> triangles;
    for (int i = 0; i <= 10; ++i) {
        points.emplace_back(0.1 * i, 0.0, 0.0);
        points.emplace_back(0.1 * i, 1e-6, 0.0);
    }
    for (std::uint32_t i = 0; i < 20; i += 2) {
        triangles.push_back({i, i + 2, i + 1});
        triangles.push_back({i + 1, i + 2, i + 3});
    }
    const Stitched result = stitch_borders(points, triangles, 1e-5);
    EXPECT_EQ(result.triangles.size(), triangles.size());
    EXPECT_EQ(result.joined_points, 0u);
}

} // namespace
} // namespace kinelux::clean
