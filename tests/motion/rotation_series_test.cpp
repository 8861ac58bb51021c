// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/rotation_series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "geometry/pose.h"
#include "kernel/transport.h"
#include "motion/translation_series.h"
#include "support/curved.h"
#include "support/shapes.h"

namespace kinelux::motion {
namespace {

using geometry::ElementShape;
using geometry::Pose;

// A turn about an axis through a point.
Pose turn_about(const Vec3& pivot, const Vec3& axis, double angle) {
    const Quat rotation = glm::angleAxis(angle, glm::normalize(axis));
    return {rotation, pivot - rotation * pivot};
}

// Unit squares that face each other across a gap, tilted so that no symmetry helps.
std::vector<ElementShape> facing_squares(double gap, int degree, double scale = 1.0) {
    model::PatchSet set;
    set.patches = {
        support::rectangle(Vec3(0), scale * Vec3(1, 0, 0), scale * Vec3(0, 1, 0)),
        support::rectangle(scale * Vec3(0.2, 0.1, gap), scale * Vec3(0, 1, 0), scale * Vec3(1, 0, 0))};
    auto shapes = support::shapes_of(set, 1, degree);
    shapes[1] = geometry::moved(shapes[1], turn_about(shapes[1].centre, Vec3(1, 0.5, 0), 0.2));
    return shapes;
}

double norm(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

double difference(std::span<const double> a, std::span<const double> b) {
    std::vector<double> d(a.begin(), a.end());
    for (std::size_t v = 0; v < d.size(); ++v) d[v] -= b[v];
    return norm(d);
}

std::vector<double> exact_block(const ElementShape& a, const ElementShape& b) {
    const visibility::Occluders none({});
    return kernel::transport(a, b, none, {.tolerance = 1e-8, .occlusion = false}).values;
}

// The block after a turn of b, by the expansion from before it.
std::vector<double> expanded(const ElementShape& a, const ElementShape& b, const Pose& turn) {
    const PairNodes nodes(a, b, 1e-8);
    std::vector<double> block = exact_block(a, b);
    add_rotation(rotation_blocks(nodes, Turning::Second, b.planar), glm::mat3_cast(turn.rotation),
                 b.mean_normal, 1.0, block);
    return block;
}

double relative_error(const ElementShape& a, const ElementShape& b, const Pose& turn) {
    const auto exact = exact_block(a, geometry::moved(b, turn));
    return difference(expanded(a, b, turn), exact) / norm(exact);
}

// Angle up to which the error of the block stays below a tolerance [deg].
double reach_deg(const ElementShape& a, const ElementShape& b, const Vec3& pivot, const Vec3& axis,
                 double tolerance) {
    double low = 1e-4, high = 40.0;
    while (high / low > 1.02) {
        const double middle = std::sqrt(low * high);
        const bool good = relative_error(a, b, turn_about(pivot, axis, glm::radians(middle))) <= tolerance;
        (good ? low : high) = middle;
    }
    return low;
}

TEST(RotationSeries, is_exact_where_only_the_normal_turns) {
    std::mt19937 generator(5);
    std::normal_distribution<double> normal;
    const auto direction = [&] {
        return glm::normalize(Vec3(normal(generator), normal(generator), normal(generator)));
    };
    for (int trial = 0; trial < 1000; ++trial) {
        const Vec3 r = 2.0 * direction(), n_i = direction(), n_j = direction(), turned = direction();
        const auto value = [&](const Vec3& a, const Vec3& b) {
            return -glm::dot(a, r) * glm::dot(b, r) / (std::numbers::pi * 16.0);
        };
        const double second = glm::dot(turned - n_j, turning_vector(r, n_i, n_j, Turning::Second));
        EXPECT_NEAR(second, value(n_i, turned) - value(n_i, n_j), 1e-15);
        const double first = glm::dot(turned - n_i, turning_vector(r, n_i, n_j, Turning::First));
        EXPECT_NEAR(first, value(turned, n_j) - value(n_i, n_j), 1e-15);
    }
}

TEST(RotationSeries, nine_coefficients_of_a_planar_surface_say_what_three_do) {
    const auto shapes = facing_squares(3.0, 2);
    const PairNodes nodes(shapes[0], shapes[1], 1e-4);
    const Mat3 R = glm::mat3_cast(glm::angleAxis(0.3, glm::normalize(Vec3(1, 2, 3))));
    for (const Turning end : {Turning::First, Turning::Second}) {
        std::vector<double> three(nodes.block_size()), nine(three.size());
        const Vec3 normal = shapes[end == Turning::First ? 0 : 1].mean_normal;
        add_rotation(rotation_blocks(nodes, end, true), R, normal, 1.0, three);
        add_rotation(rotation_blocks(nodes, end, false), R, normal, 1.0, nine);
        EXPECT_LT(difference(three, nine), 1e-12 * norm(three));
    }
}

TEST(RotationSeries, nine_coefficients_are_exact_for_normals_of_a_curved_surface) {
    // A piece of a sphere turns in place: with r' = r the change is that of the kernel with turned normals.
    model::PatchSet set;
    set.patches = {support::rectangle(Vec3(-0.5, -0.5, -3), Vec3(1, 0, 0), Vec3(0, 1, 0)),
                   support::surface_patch(support::tilted_surface(model::SurfaceType::Sphere),
                                          Vec2(0.2, -0.3), Vec2(0.9, 0.4))};
    const auto shapes = support::shapes_of(set, 1, 1);
    const ElementShape& a = shapes[0];
    const ElementShape& b = shapes[1];
    ASSERT_FALSE(b.planar);
    const PairNodes nodes(a, b, 1e-6);
    const Mat3 R = glm::mat3_cast(glm::angleAxis(0.2, glm::normalize(Vec3(1, 2, 0.5))));
    const auto turned = nodes.project(
        1, [&](const geometry::SurfaceNode& x, geometry::SurfaceNode y, std::span<double> value) {
            value[0] = -facing_kernel(x, y);
            y.normal = R * y.normal;
            value[0] += facing_kernel(x, y);
        });
    std::vector<double> change(nodes.block_size());
    add_rotation(rotation_blocks(nodes, Turning::Second, false), R, b.mean_normal, 1.0, change);
    ASSERT_GT(norm(turned), 0.0);
    EXPECT_LT(difference(change, turned), 1e-12 * norm(turned));
}

TEST(RotationSeries, error_is_of_first_order_in_the_angle) {
    const auto shapes = facing_squares(1.5, 1);
    const Vec3 pivot = shapes[1].centre, axis(1, 0.3, 0.2);
    const double at_1 = relative_error(shapes[0], shapes[1], turn_about(pivot, axis, 1e-2));
    const double at_half = relative_error(shapes[0], shapes[1], turn_about(pivot, axis, 5e-3));
    EXPECT_NEAR(at_1 / at_half, 2.0, 0.1) << "a rule right to first order would give 4";
}

TEST(RotationSeries, reaches_about_as_far_as_the_table_in_mathematics_says) {
    // Spin about the own centre: 1 % up to about 3 degrees across a gap of 1.5 at degree 1; about a pivot two sizes away
    // 0.3 to 0.4 degrees, which is what keeping the block altogether gives.
    const auto shapes = facing_squares(1.5, 1);
    const double spin = reach_deg(shapes[0], shapes[1], shapes[1].centre, Vec3(1, 0.3, 0.2), 1e-2);
    const double finer = reach_deg(shapes[0], shapes[1], shapes[1].centre, Vec3(1, 0.3, 0.2), 1e-3);
    const double orbit =
        reach_deg(shapes[0], shapes[1], shapes[1].centre + Vec3(0, 2, 0), Vec3(1, 0.3, 0.2), 1e-2);
    printf("1 %% reach: spin %.2f deg, orbit %.2f deg; 0.1 %%: spin %.2f deg\n", spin, orbit, finer);
    EXPECT_GT(spin, 1.0);
    EXPECT_LT(spin, 9.0);
    EXPECT_NEAR(finer / spin, 0.1, 0.03) << "the reach is proportional to the tolerance";
    EXPECT_GT(orbit, 0.1);
    EXPECT_LT(orbit, 0.8);
}

TEST(RotationSeries, condition_20_as_printed_depends_on_the_unit_of_length) {
    // r = 2, a = 0.5, S = 0.01, the same scene in other units.
    const auto largest_sine = [](const auto& condition, double scale) {
        double low = 0.0, high = 0.5;
        while (high - low > 1e-9) {
            const double middle = 0.5 * (low + high);
            (condition(2.0 * scale, 0.5 * scale, std::asin(middle), 0.01) ? low : high) = middle;
        }
        return low;
    };
    for (const double scale : {0.1, 1.0, 10.0, 100.0}) {
        const double printed = largest_sine(rotation_condition_printed, scale);
        EXPECT_NEAR(printed, scale <= 1.0 ? 0.01 : 0.01 / scale, 1e-8) << scale;
        EXPECT_NEAR(largest_sine(rotation_condition_scale_free, scale), 0.02, 1e-5) << scale;
    }
}

TEST(RotationSeries, scale_free_condition_bounds_the_error_of_the_kernel_at_points) {
    std::mt19937 generator(6);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto direction = [&] {
        return glm::normalize(Vec3(normal(generator), normal(generator), normal(generator)));
    };
    constexpr double S = 0.1;
    int admitted = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const Vec3 x(0.0), y = direction(), pivot = y + 0.3 * direction(), n_i = direction(),
                           n_j = direction();
        const Pose turn = turn_about(pivot, direction(), 0.3 * uniform(generator));
        const double angle = glm::angle(turn.rotation);
        if (!rotation_condition_scale_free(1.0, glm::distance(y, pivot), angle, S)) continue;
        ++admitted;
        const auto value = [&](const Vec3& r, const Vec3& n) {
            const double r2 = glm::dot(r, r);
            return -glm::dot(n_i, r) * glm::dot(n, r) / (r2 * r2); // in units of 1/pi
        };
        const Vec3 turned = turn.direction(n_j);
        const double error = std::abs(value(turn.point(y) - x, turned) - value(y - x, turned));
        const double way = glm::distance(turn.point(y), y);
        EXPECT_LE(way, S / 2.0 + 1e-12);
        EXPECT_LE(error, series_tail(way, 0) + 1e-12);
    }
    EXPECT_GT(admitted, 1000);
    EXPECT_LT(series_tail(S / 2.0, 0), 1.1 * S) << "S is the error to first order";
}

} // namespace
} // namespace kinelux::motion
