// SPDX-License-Identifier: GPL-3.0-or-later
// The catalogue's formulas against each other: reciprocity, limits, additivity, and one integrated out of the next.
#include "support/closed_forms.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/quadrature.h"

namespace kinelux::support {
namespace {

constexpr double pi = std::numbers::pi;

Extent square(double low, double high) { return {low, high, low, high}; }

// The mean of f over a rectangle, by Gauss.
template <class Function>
double mean_over(const Extent& extent, const Function& f) {
    const auto& rule = geometry::gauss_rule(32);
    double sum = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i)
        for (std::size_t j = 0; j < rule.nodes.size(); ++j)
            sum += rule.weights[i] * rule.weights[j] *
                   f(extent.low_u + (extent.high_u - extent.low_u) * rule.nodes[i],
                     extent.low_v + (extent.high_v - extent.low_v) * rule.nodes[j]);
    return sum;
}

TEST(ClosedForms, parallel_squares_have_the_published_values) {
    EXPECT_NEAR(parallel_equal_rectangles(1, 1, 1), 0.1998248957, 1e-10);
    EXPECT_NEAR(parallel_equal_rectangles(1, 1, 0.1), 0.8269945224, 1e-10);
    EXPECT_NEAR(parallel_equal_rectangles(1, 1, 0.01), 0.9804166029, 1e-10);
}

TEST(ClosedForms, corner_terms_of_opposed_rectangles_are_the_simple_formula) {
    for (const double c : {0.1, 0.5, 1.0, 3.0})
        EXPECT_NEAR(parallel_rectangles({0, 2, 0, 0.7}, {0, 2, 0, 0.7}, c),
                    parallel_equal_rectangles(2, 0.7, c), 1e-12);
}

TEST(ClosedForms, parallel_rectangles_are_the_mean_of_their_points) {
    const Extent from{0, 1, 0, 0.5}, to{2, 3.5, 1, 4};
    const auto corner = [](double a, double b) { // odd in both, so that parts on all sides add up
        return std::copysign(1.0, a) * std::copysign(1.0, b) *
               element_to_parallel_rectangle(std::abs(a), std::abs(b), 0.8);
    };
    const double mean = mean_over(from, [&](double u, double v) {
        return corner(to.high_u - u, to.high_v - v) - corner(to.low_u - u, to.high_v - v) -
               corner(to.high_u - u, to.low_v - v) + corner(to.low_u - u, to.low_v - v);
    });
    EXPECT_NEAR(parallel_rectangles(from, to, 0.8) / mean, 1.0, 1e-10);
}

TEST(ClosedForms, rectangles_are_reciprocal) {
    const Extent a{0, 1, 0.2, 0.5}, b{0.3, 3.5, 0.1, 4};
    EXPECT_NEAR(a.area() * parallel_rectangles(a, b, 0.6), b.area() * parallel_rectangles(b, a, 0.6), 1e-12);
    EXPECT_NEAR(a.area() * perpendicular_rectangles(a, b), b.area() * perpendicular_rectangles(b, a), 1e-12);
    EXPECT_NEAR(2 * hinged_rectangles(1.5, 2, 3, 1.0), 3 * hinged_rectangles(1.5, 3, 2, 1.0), 1e-12);
    EXPECT_NEAR(coaxial_discs(1, 2, 3), 4 * coaxial_discs(2, 1, 3), 1e-13);
}

TEST(ClosedForms, perpendicular_rectangles_agree_in_all_three_formulas) {
    EXPECT_NEAR(perpendicular_rectangles_common_edge(1, 1, 1), 0.200043776075, 1e-12);
    for (const double h : {0.2, 1.0, 2.5}) {
        const double expected = perpendicular_rectangles_common_edge(1.3, 0.8, h);
        EXPECT_NEAR(perpendicular_rectangles({0, 1.3, 0, 0.8}, {0, 1.3, 0, h}), expected, 1e-12);
        EXPECT_NEAR(hinged_rectangles(1.3, 0.8, h, 0.5 * pi), expected, 1e-12);
    }
}

TEST(ClosedForms, perpendicular_rectangles_are_the_mean_of_their_points) {
    const Extent from{0, 1, 1, 2};
    const double mean = mean_over(from, [&](double u, double v) {
        const auto part = [&](double along) {
            return std::copysign(element_to_perpendicular_rectangle(std::abs(along), 0.9, v), along);
        };
        return part(1.5 - u) - part(-0.5 - u);
    });
    EXPECT_NEAR(perpendicular_rectangles(from, {-0.5, 1.5, 0, 0.9}) / mean, 1.0, 1e-10);
}

TEST(ClosedForms, hinged_squares_have_the_values_found_by_graded_gauss) {
    const std::pair<double, double> published[] = {{30, 0.6190283},  {45, 0.4833477},  {60, 0.3709053},
                                                   {90, 0.2000438},  {120, 0.0866150}, {150, 0.0213453},
                                                   {170, 0.00236206}};
    for (const auto& [angle, value] : published)
        EXPECT_NEAR(hinged_rectangles(1, 1, 1, angle * pi / 180.0), value, 1e-7) << angle;
    EXPECT_NEAR(hinged_rectangles(1, 1, 1, 5 * pi / 180.0), 0.9203, 2e-4);
}

TEST(ClosedForms, long_hinges_and_gaps_tend_to_crossed_strings) {
    for (const double angle : {0.1, 1.0, 2.0})
        EXPECT_NEAR(hinged_rectangles(1e5, 1, 1, angle), infinite_hinged_strips(angle), 1e-4);
    EXPECT_NEAR(parallel_equal_rectangles(1, 1e5, 0.3), infinite_parallel_strips(1, 0.3), 1e-4);
}

TEST(ClosedForms, hinges_are_additive) {
    // A wall beside twice as long a floor: the far half by the corner formula.
    const double whole = hinged_rectangles(1, 1, 2, 0.5 * pi), near = hinged_rectangles(1, 1, 1, 0.5 * pi);
    EXPECT_NEAR(whole - near, perpendicular_rectangles({0, 1, 0, 1}, {0, 1, 1, 2}), 1e-13);
}

TEST(ClosedForms, discs_close_a_cylinder_and_are_the_mean_of_their_points) {
    for (const double h : {0.1, 1.0, 5.0}) {
        const double r = 0.7;
        EXPECT_NEAR(coaxial_discs(r, r, h) + cylinder_to_end(r, h) * 2 * h / r, 1.0, 1e-13);
        EXPECT_NEAR(cylinder_to_itself(r, h) + 2 * cylinder_to_end(r, h), 1.0, 1e-13);
    }
    EXPECT_NEAR(coaxial_discs(1, 1, 1), 0.3819660113, 1e-10);
    const auto& rule = geometry::gauss_rule(32);
    double mean = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i)
        mean += rule.weights[i] * 2.0 * rule.nodes[i] * element_to_disc(1.5, 0.8, rule.nodes[i]);
    EXPECT_NEAR(coaxial_discs(1, 1.5, 0.8), mean, 1e-10);
}

TEST(ClosedForms, elements_at_the_limit_see_all_or_the_cosine) {
    EXPECT_NEAR(4 * element_to_parallel_rectangle(1e6, 1e6, 1), 1.0, 1e-5);
    EXPECT_NEAR(2 * element_to_perpendicular_rectangle(1e6, 1e6, 1), 0.5, 1e-5);
    EXPECT_NEAR(element_to_disc(1, 1, 0), 0.5, 1e-15);
    EXPECT_NEAR(element_to_disc(1, 1, 1e-4), 0.5, 1e-7);
    EXPECT_NEAR(element_to_sphere(1, 2, 0), 0.25, 1e-15);
    // A sphere fills the same of the sky as the disc of its outline.
    EXPECT_NEAR(element_to_sphere(1, 2, 0), element_to_disc(1 * std::cos(pi / 6), 1.5, 0), 1e-15);
    EXPECT_NEAR(outer_sphere_to_inner(1, 2) + outer_sphere_to_itself(1, 2), 1.0, 1e-15);
    EXPECT_NEAR(parallel_rectangles(square(0, 1), square(0, 1), 1e-3), parallel_equal_rectangles(1, 1, 1e-3),
                1e-9);
}

} // namespace
} // namespace kinelux::support
