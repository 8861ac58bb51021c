// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/staircase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kinelux::motion {
namespace {

TEST(Staircase, axes_are_the_26_directions_of_a_cube_in_pairs) {
    const auto& axes = predefined_axes();
    for (std::size_t a = 0; a < axes.size(); ++a) {
        EXPECT_NEAR(glm::length(axes[a]), 1.0, 1e-15);
        for (std::size_t b = 0; b < a; ++b)
            EXPECT_LT(std::abs(glm::dot(axes[a], axes[b])), std::cos(0.6)) << a << " " << b;
    }
}

TEST(Staircase, stays_within_a_step_of_a_bent_path_and_sums_its_steps) {
    Staircase stairs;
    Vec3 path(0.0), before(0.0);
    for (int frame = 1; frame <= 200; ++frame) {
        const double s = 0.03 * frame;
        path = Vec3(std::sin(s), 1.0 - std::cos(s), 0.3 * s);
        stairs.follow(path, 1, 1e-12);
        EXPECT_LT(glm::distance(path, stairs.position()), glm::distance(path, before)) << frame;
        before = path;
    }
    Vec3 sum(0.0);
    for (std::size_t a = 0; a < axis_count; ++a) sum += stairs.steps()[a] * predefined_axes()[a];
    EXPECT_LT(glm::distance(sum, stairs.position()), 1e-12);
    EXPECT_GE(stairs.length(), glm::length(stairs.position()));
}

TEST(Staircase, a_path_along_an_axis_is_followed_exactly_by_one_move) {
    Staircase stairs;
    stairs.follow(Vec3(-0.3, 0.3, 0.0), 1, 1e-12);
    EXPECT_LT(glm::distance(stairs.position(), Vec3(-0.3, 0.3, 0.0)), 1e-15);
    EXPECT_NEAR(stairs.length(), 0.3 * std::numbers::sqrt2, 1e-15);
}

} // namespace
} // namespace kinelux::motion
