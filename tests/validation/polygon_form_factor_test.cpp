// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/polygon_form_factor.h"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "pair_recipes.h"
#include "support/closed_forms.h"
#include "support/pair_reference.h"

namespace kinelux::kernel {
namespace {

using Polygon = std::vector<Vec3>;
constexpr double degree = std::numbers::pi / 180.0;

Polygon rectangle(const Vec3& corner, const Vec3& u, const Vec3& v) {
    return {corner, corner + u, corner + u + v, corner + v};
}

void expect_factor(const Polygon& a, const Polygon& b, double expected, double tolerance) {
    const auto factor = polygon_form_factor(a, b);
    EXPECT_NEAR(factor.value / expected, 1.0, tolerance);
    EXPECT_GE(3.0 * factor.error + 1e-15, std::abs(factor.value - expected))
        << "the error is more than it says";
}

TEST(PolygonFormFactor, meets_facing_squares_at_any_gap) {
    for (const double gap : {1e-9, 1e-6, 1e-3, 0.1, 1.0, 5.0, 20.0, 100.0}) {
        SCOPED_TRACE(gap);
        const double expected = gap > 5.0 ? support::parallel_rectangles({0, 1, 0, 1}, {0, 1, 0, 1}, gap)
                                          : support::parallel_equal_rectangles(1, 1, gap);
        // Far away the closed form itself cancels: it loses the fourth power of the distance.
        const double cancelled = gap > 5.0 ? 1e-14 * std::pow(gap, 4) : 0.0;
        const auto factor = polygon_form_factor(rectangle(Vec3(0), {1, 0, 0}, {0, 1, 0}),
                                                rectangle({0, 0, gap}, {0, 1, 0}, {1, 0, 0}));
        EXPECT_NEAR(factor.value / expected, 1.0, 1e-12 + cancelled);
        EXPECT_LT(factor.error, 1e-11);
    }
}

TEST(PolygonFormFactor, meets_hinges_of_any_angle) {
    for (const double angle : {0.1, 5.0, 10.0, 30.0, 90.0, 120.0, 170.0, 179.0}) {
        SCOPED_TRACE(angle);
        const double a = angle * degree;
        expect_factor(rectangle(Vec3(0), {0.7, 0, 0}, {0, 1.4, 0}),
                      rectangle(Vec3(0), {0, 1.4, 0}, {1.9 * std::cos(a), 0, 1.9 * std::sin(a)}),
                      support::hinged_rectangles(1.4, 0.7, 1.9, a), 1e-10);
    }
}

TEST(PolygonFormFactor, meets_rectangles_shifted_and_of_other_sizes) {
    expect_factor(rectangle(Vec3(0), {1, 0, 0}, {0, 0.5, 0}), rectangle({2, 1, 0.8}, {0, 3, 0}, {1.5, 0, 0}),
                  support::parallel_rectangles({0, 1, 0, 0.5}, {2, 3.5, 1, 4}, 0.8), 1e-12);
    // A floor from y = 0.2 on, a wall over the x axis, overlapping in part: corners and edges on one line.
    expect_factor(rectangle({0, 0.2, 0}, {1, 0, 0}, {0, 0.3, 0}),
                  rectangle({0.3, 0, 0}, {0, 0, 1.5}, {2, 0, 0}),
                  support::perpendicular_rectangles({0, 1, 0.2, 0.5}, {0.3, 2.3, 0, 1.5}), 1e-12);
}

TEST(PolygonFormFactor, clips_at_both_horizons) {
    // A wall that reaches below the floor counts from the floor on, and a floor behind the wall does not see it.
    const Polygon floor = rectangle({0, -1, 0}, {1, 0, 0}, {0, 2, 0});
    const Polygon wall = rectangle({0, 0, -1}, {1, 0, 0}, {0, 0, 2});
    const double towards = polygon_form_factor(floor, Polygon(wall.rbegin(), wall.rend())).value;
    EXPECT_NEAR(towards, 0.5 * support::perpendicular_rectangles_common_edge(1, 1, 1), 1e-12);
    EXPECT_EQ(polygon_form_factor(floor, rectangle({2, 0, 0}, {1, 0, 0}, {0, 1, 0})).value, 0.0)
        << "in its plane";
    EXPECT_EQ(polygon_form_factor(floor, rectangle({0, 0, 1}, {1, 0, 0}, {0, 1, 0})).value, 0.0)
        << "its back";
}

TEST(PolygonFormFactor, closes_a_box_and_a_box_with_a_window) {
    const std::array<Polygon, 6> faces{
        rectangle(Vec3(0), {2, 0, 0}, {0, 1, 0}),   rectangle({0, 0, 0.1}, {0, 1, 0}, {2, 0, 0}),
        rectangle(Vec3(0), {0, 1, 0}, {0, 0, 0.1}), rectangle({2, 0, 0}, {0, 0, 0.1}, {0, 1, 0}),
        rectangle(Vec3(0), {0, 0, 0.1}, {2, 0, 0}), rectangle({0, 1, 0}, {2, 0, 0}, {0, 0, 0.1})};
    for (const Polygon& from : faces) {
        double sum = 0.0;
        for (const Polygon& to : faces) sum += polygon_form_factor(from, to).value;
        EXPECT_NEAR(sum, 1.0, 1e-12);
    }
    const Polygon window = rectangle({0.5, 0.25, 0.1}, {0, 0.5, 0}, {1, 0, 0});
    const std::vector<Polygon> rest{faces[1], Polygon(window.rbegin(), window.rend())};
    const std::vector<Polygon> floor{faces[0]};
    EXPECT_NEAR(polygon_form_factor(floor, rest).value + polygon_form_factor(faces[0], window).value,
                polygon_form_factor(faces[0], faces[1]).value, 1e-13);
}

TEST(PolygonFormFactor, is_reciprocal_and_does_not_notice_place_or_scale) {
    const Polygon a = rectangle(Vec3(0), {1, 0, 0}, {0, 0.3, 0}),
                  b{{0.2, 0.1, 0.4}, {0.1, 0.9, 0.9}, {1, 0.3, 0.5}};
    const double area_b = 0.5 * glm::length(glm::cross(b[1] - b[0], b[2] - b[0]));
    const double forward = polygon_form_factor(a, b).value;
    EXPECT_GT(forward, 1e-3);
    EXPECT_NEAR(0.3 * forward, area_b * polygon_form_factor(b, a).value, 1e-14);
    for (const double scale : {1e-6, 1e6}) {
        Polygon c = a, d = b;
        for (Vec3& p : c) p = scale * p + Vec3(0.0, scale, 0.0);
        for (Vec3& p : d) p = scale * p + Vec3(0.0, scale, 0.0);
        EXPECT_NEAR(polygon_form_factor(c, d).value / forward, 1.0, 1e-12);
    }
}

TEST(PolygonFormFactor, is_the_constant_term_of_the_reference_blocks_of_random_pairs) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed)
        for (std::size_t kind = 0; kind + 1 < validation::pair_class_names.size();
             ++kind) { // all without holes
            const auto pair = validation::make_pair({static_cast<validation::PairClass>(kind), seed, 0});
            const auto triangles = [](const geometry::ElementShape& shape) {
                std::vector<Polygon> loops;
                for (const auto& facet : shape.facets)
                    loops.emplace_back(facet.corners.begin(), facet.corners.end());
                return loops;
            };
            const auto reference = support::pair_reference(pair.a, pair.b);
            const double factor = polygon_form_factor(triangles(pair.a), triangles(pair.b)).value;
            const double expected = reference.values[0] * std::sqrt(pair.b.area / pair.a.area);
            EXPECT_NEAR(factor, expected, 3e-7 * expected + 1e-9)
                << validation::pair_class_names[kind] << " seed " << seed << " " << pair.what;
        }
}

} // namespace
} // namespace kinelux::kernel
