// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/transport.h"

#include <numbers>

#include <gtest/gtest.h>

#include "core/sequence.h"
#include "kernel/far_pair.h"
#include "kernel/polygon_irradiance.h"
#include "support/shapes.h"

namespace kinelux::kernel {
namespace {

using support::rectangle;

double form_factor(const model::Patch& a, const model::Patch& b, double tolerance, int degree = 2) {
    model::PatchSet set;
    set.patches = {a, b};
    const auto shapes = support::shapes_of(set, 1, degree);
    const auto occluders = support::occluders_of(set, support::plain_scene(1));
    const auto block = transport(shapes[0], shapes[1], occluders, {.tolerance = tolerance});
    return block.values.empty() ? 0.0 : block.values[0] * std::sqrt(shapes[1].area / shapes[0].area);
}

// Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-11.
double parallel_squares(double distance) {
    const double x = 1.0 / distance, x2 = x * x;
    return 2.0 / (std::numbers::pi * x2) *
           (std::log((1.0 + x2) / std::sqrt(1.0 + 2.0 * x2)) +
            2.0 * x * std::sqrt(1.0 + x2) * std::atan(x / std::sqrt(1.0 + x2)) - 2.0 * x * std::atan(x));
}

TEST(Transport, facing_unit_squares_meet_the_closed_form) {
    EXPECT_NEAR(parallel_squares(1.0), 0.1998249, 1e-7);
    for (const double gap : {4.0, 2.0, 1.0, 0.5, 0.3, 0.1}) {
        const auto below = rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0));
        const auto above = rectangle(Vec3(0, 0, gap), Vec3(0, 1, 0), Vec3(1, 0, 0));
        const double ratio = form_factor(below, above, 1e-3) / parallel_squares(gap);
        RecordProperty("gap_" + std::to_string(gap), std::to_string(ratio - 1.0));
        EXPECT_NEAR(ratio, 1.0, 1e-3) << "gap " << gap;
    }
}

TEST(Transport, hinged_unit_squares_meet_the_closed_form) {
    // Shared edge; values by Lambert's contour with graded Gauss quadrature, 90 degrees also Howell C-14.
    const std::pair<double, double> hinges[] = {{30, 0.6190283}, {45, 0.4833477},  {60, 0.3709053},
                                                {90, 0.2000438}, {120, 0.0866150}, {150, 0.0213453}};
    for (const auto& [angle, expected] : hinges) {
        const double a = angle * std::numbers::pi / 180.0;
        const auto floor = rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0));
        const auto wall = rectangle(Vec3(0), Vec3(0, 1, 0), Vec3(std::cos(a), 0, std::sin(a)));
        EXPECT_NEAR(form_factor(floor, wall, 1e-3) / expected, 1.0, 2e-3) << "angle " << angle;
    }
}

TEST(Transport, is_symmetric) {
    model::PatchSet set;
    set.patches = {rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 2, 0)),
                   rectangle(Vec3(0.2, 0.1, 0.7), Vec3(0, 0.5, 0.2), Vec3(0.8, 0, 0))};
    const auto shapes = support::shapes_of(set, 1, 2);
    const auto occluders = support::occluders_of(set, support::plain_scene(1));
    const auto ab = transport(shapes[0], shapes[1], occluders, {});
    const auto ba = transport(shapes[1], shapes[0], occluders, {});
    ASSERT_EQ(ab.values.size(), 36u);
    double norm = 0.0, difference = 0.0;
    for (std::size_t k = 0; k < 6; ++k)
        for (std::size_t l = 0; l < 6; ++l) {
            norm += ab.values[k * 6 + l] * ab.values[k * 6 + l];
            difference += std::pow(ab.values[k * 6 + l] - ba.values[l * 6 + k], 2.0);
        }
    EXPECT_LT(std::sqrt(difference / norm), 1e-12);
}

TEST(Transport, of_faces_that_look_away_is_nothing) {
    const auto floor = rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0));
    const auto roof_top = rectangle(Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 1, 0));
    const auto neighbour = rectangle(Vec3(1, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0));
    EXPECT_EQ(form_factor(floor, roof_top, 1e-3), 0.0);
    EXPECT_EQ(form_factor(floor, neighbour, 1e-3), 0.0);
}

TEST(Transport, rows_of_a_closed_box_sum_to_one) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(1.0, 2.0, 0.7), support::Facing::Inwards);
    const auto scene = support::plain_scene(1);
    const auto occluders = support::occluders_of(set, scene);
    for (const int n : {1, 2, 4}) {
        const auto shapes = support::shapes_of(set, n, 2);
        for (const auto& a : shapes) {
            double sum = 0.0;
            for (const auto& b : shapes) {
                const auto block = transport(a, b, occluders, {});
                if (!block.values.empty()) sum += block.values[0] * std::sqrt(b.area / a.area);
            }
            EXPECT_NEAR(sum, 1.0, 3e-3) << "n " << n << " element " << a.id.value;
        }
    }
}

TEST(Transport, a_wall_between_hides) {
    model::PatchSet set;
    set.patches = {rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)),
                   rectangle(Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(1, 0, 0)),
                   rectangle(Vec3(-2, -2, 0.5), Vec3(5, 0, 0), Vec3(0, 5, 0)),
                   rectangle(Vec3(-2, -2, 0.5), Vec3(2.5, 0, 0), Vec3(0, 5, 0))};
    const auto shapes = support::shapes_of(set, 1, 2);
    const auto scene = support::plain_scene(1);
    EXPECT_TRUE(transport(shapes[0], shapes[1], support::occluders_of(set, scene), {}).values.empty());

    // Only x < 0.5 covered at half height: by symmetry the shares that pass and that are cut off are equal.
    set.patches.erase(set.patches.begin() + 2);
    const auto half = transport(shapes[0], shapes[1], support::occluders_of(set, scene), {});
    const auto open =
        transport(shapes[0], shapes[1], support::occluders_of(set, scene), {.occlusion = false});
    // The wall's edge grazes the rays between mirrored nodes of the two rules, an eighth of the weight.
    EXPECT_NEAR(half.values.at(0) / open.values.at(0), 0.5, 0.13);
}

TEST(Transport, errors_behind_a_wall_are_relative_to_the_block_down_to_the_floor) {
    // Small squares far apart, so that their block is a small part of the largest possible one; close to each of them a
    // wall hides some, so that either side has a shadow that begins with a step.
    model::PatchSet set;
    set.patches = {rectangle(Vec3(0), Vec3(0.1, 0, 0), Vec3(0, 0.1, 0)),
                   rectangle(Vec3(0, 0, 1), Vec3(0, 0.1, 0), Vec3(0.1, 0, 0)),
                   rectangle(Vec3(-2, -2, 0.002), Vec3(2.14, 0.1, 0), Vec3(-0.2, 4.28, 0)),
                   rectangle(Vec3(-2, -2, 0.998), Vec3(0.1, 2.13, 0), Vec3(4.26, -0.2, 0))};
    const auto shapes = support::shapes_of(set, 1, 2);
    const auto occluders = support::occluders_of(set, support::plain_scene(1));
    constexpr double sight_tolerance = 1e-2;
    const auto block_with = [&](double floor, double tolerance) {
        return transport(shapes[0], shapes[1], occluders,
                         {.tolerance = 1e-4, .sight_tolerance = tolerance, .sight_floor = floor});
    };
    const auto exact = block_with(1e-4, 1e-4);
    ASSERT_GT(exact.values.at(0), 1e-4);
    for (const double floor : {1e-4, 1e-3}) {
        const TransportBlock block = block_with(floor, sight_tolerance);
        double norm = 0.0, off = 0.0;
        for (std::size_t k = 0; k < block.values.size(); ++k) {
            norm += block.values[k] * block.values[k];
            off += (block.values[k] - exact.values[k]) * (block.values[k] - exact.values[k]);
        }
        const double allowed = sight_tolerance * std::max(std::sqrt(norm), floor);
        EXPECT_LE(block.error, allowed);
        EXPECT_LE(std::sqrt(off), allowed);
    }
    EXPECT_GT(block_with(0.1, sight_tolerance).error, block_with(1e-4, sight_tolerance).error);
}

TEST(PolygonIrradiance, meets_the_parallel_rectangle_formula) {
    // Howell B-3: a corner-aligned parallel rectangle a x b at distance c.
    const double a = 1.3, b = 0.6, c = 0.8, x = a / c, y = b / c;
    const double expected = (x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)) +
                             y / std::sqrt(1 + y * y) * std::atan(x / std::sqrt(1 + y * y))) /
                            (2 * std::numbers::pi);
    const std::vector<Vec3> corners{Vec3(0, 0, c), Vec3(0, b, c), Vec3(a, b, c), Vec3(a, 0, c)};
    EXPECT_NEAR(point_to_polygon(Vec3(0), Vec3(0, 0, 1), corners), expected, 1e-14);
}

TEST(PolygonIrradiance, of_a_half_space_below_the_horizon_is_cut) {
    // A huge wall standing on the receiver's plane fills half the hemisphere's projection: 1/2.
    const double huge = 1e6;
    const std::vector<Vec3> wall{Vec3(1, -huge, -huge), Vec3(1, -huge, huge), Vec3(1, huge, huge),
                                 Vec3(1, huge, -huge)};
    EXPECT_NEAR(point_to_polygon(Vec3(0), Vec3(0, 0, 1), wall), 0.5, 1e-5);
    EXPECT_EQ(point_to_polygon(Vec3(2, 0, 0), Vec3(0, 0, 1), wall), 0.0) << "seen from behind";
    EXPECT_EQ(point_to_polygon(Vec3(1, 0, 0), Vec3(0, 0, 1), wall), 0.0) << "in its plane";
}

TEST(BoundedKernel, never_sends_more_than_what_leaves_a_node_however_near_the_other_is) {
    for (const double gap : {1.0, 1e-3, 1e-9, 1e-17})
        for (const double weight : {1e-6, 1.0}) {
            const geometry::SurfaceNode x{Vec3(0), Vec3(0, 0, 1), weight};
            const geometry::SurfaceNode y{Vec3(0, 0, gap), Vec3(0, 0, -1), 0.5};
            const double kernel = bounded_kernel(x, y);
            EXPECT_GT(kernel, 0.0);
            EXPECT_LE(kernel * x.weight, 1.0) << "gap " << gap;
            EXPECT_LE(kernel * y.weight, 1.0) << "gap " << gap;
        }
}

} // namespace
} // namespace kinelux::kernel
