// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/pose.h"

#include <numbers>

#include <gtest/gtest.h>

#include "geometry/element_shape.h"
#include "support/shapes.h"

namespace kinelux::geometry {
namespace {

model::Motion slide(model::Interpolation interpolation) {
    model::Motion motion;
    motion.name = "slide";
    motion.interpolation = interpolation;
    for (const double t : {0.0, 1.0, 3.0})
        motion.keyframes.push_back({t, Vec3(2.0 * t, 0.0, 0.0), Quat(1, 0, 0, 0)});
    return motion;
}

TEST(Pose, rests_before_the_first_and_after_the_last_keyframe) {
    const auto motion = slide(model::Interpolation::Linear);
    EXPECT_EQ(pose_at(motion, -5.0), pose_at(motion, 0.0));
    EXPECT_EQ(pose_at(motion, 99.0).translation, Vec3(6.0, 0.0, 0.0));
}

TEST(Pose, straight_uniform_motion_is_met_by_linear_and_cubic) {
    for (const auto interpolation : {model::Interpolation::Linear, model::Interpolation::Cubic})
        for (double t = 0.0; t <= 3.0; t += 0.125)
            EXPECT_NEAR(pose_at(slide(interpolation), t).translation.x, 2.0 * t, 1e-12);
    EXPECT_EQ(pose_at(slide(model::Interpolation::Step), 0.99).translation.x, 0.0);
}

TEST(Pose, rotation_keeps_the_pivot_and_halves_the_angle_half_way) {
    model::Motion motion;
    motion.pivot = Vec3(1.0, 2.0, 3.0);
    motion.keyframes = {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)},
                        {1.0, Vec3(0.0), glm::angleAxis(std::numbers::pi / 2, Vec3(0, 0, 1))}};
    const Pose half = pose_at(motion, 0.5);
    EXPECT_LT(glm::distance(half.point(motion.pivot), motion.pivot), 1e-14);
    const Vec3 turned = half.direction(Vec3(1, 0, 0));
    EXPECT_NEAR(std::atan2(turned.y, turned.x), std::numbers::pi / 4, 1e-14);
    EXPECT_LT(glm::distance(half.rest_point(half.point(Vec3(7, 8, 9))), Vec3(7, 8, 9)), 1e-13);
}

TEST(ElementShape, moved_keeps_area_basis_and_turns_normals) {
    model::PatchSet set;
    set.patches = {support::rectangle(Vec3(1, 1, 1), Vec3(2, 0, 0), Vec3(0, 1, 0))};
    const auto shape = support::shapes_of(set, 1, 2).front();
    EXPECT_NEAR(shape.area, 2.0, 1e-14);
    EXPECT_TRUE(shape.planar);
    const Pose pose{glm::angleAxis(std::numbers::pi / 2, Vec3(1, 0, 0)), Vec3(0, 0, 5)};
    const auto turned = moved(shape, pose);
    EXPECT_LT(glm::distance(turned.mean_normal, Vec3(0, -1, 0)), 1e-14);
    EXPECT_LT(glm::distance(turned.rules[0].nodes[0].position, pose.point(shape.rules[0].nodes[0].position)),
              1e-14);
    EXPECT_EQ(turned.rules[0].basis, shape.rules[0].basis);
}

} // namespace
} // namespace kinelux::geometry
