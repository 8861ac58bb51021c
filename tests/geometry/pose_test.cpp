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

TEST(Pose, a_turn_beyond_180_degrees_goes_the_long_way_and_several_times_round) {
    const double turns = 2.75, whole = 2.0 * std::numbers::pi;
    model::Motion motion;
    motion.pivot = Vec3(1.0, 0.0, 0.0);
    const Vec3 axis(0, 0, 1);
    motion.keyframes = {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)},
                        {1.0, Vec3(0.0), glm::angleAxis(turns * whole, axis), turns * whole * axis}};
    for (const double t : {0.125, 0.3, 0.5, 0.9, 1.0}) {
        const Vec3 turned = pose_at(motion, t).direction(Vec3(1, 0, 0));
        EXPECT_NEAR(turned.x, std::cos(t * turns * whole), 1e-13) << t;
        EXPECT_NEAR(turned.y, std::sin(t * turns * whole), 1e-13) << t;
    }
}

TEST(Pose, a_cubic_with_tangents_has_their_slopes_at_the_keyframes) {
    model::Motion motion;
    motion.interpolation = model::Interpolation::Cubic;
    motion.keyframes = {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)}, {2.0, Vec3(1, 0, 0), Quat(1, 0, 0, 0)}};
    motion.keyframes[0].tangents.emplace().translation_out = Vec3(0, 3, 0);
    motion.keyframes[1].tangents.emplace().translation_in = Vec3(-1, 0, 0);
    constexpr double h = 1e-6;
    const Vec3 start = pose_at(motion, h).translation / h;
    const Vec3 end = (pose_at(motion, 2.0).translation - pose_at(motion, 2.0 - h).translation) / h;
    EXPECT_LT(glm::distance(start, Vec3(0, 3, 0)), 1e-5);
    EXPECT_LT(glm::distance(end, Vec3(-1, 0, 0)), 1e-5);
}

TEST(Pose, a_child_is_moved_first_by_itself_and_then_by_its_parents) {
    model::Scene scene;
    const Quat quarter = glm::angleAxis(std::numbers::pi / 2, Vec3(0, 0, 1));
    for (int level = 0; level < 3; ++level) {
        model::Motion motion;
        motion.pivot = Vec3(level, 0, 0); // joints of an arm stretched along x at rest
        motion.keyframes = {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)}, {1.0, Vec3(0.0), quarter}};
        if (level > 0) motion.parent = MotionId(level - 1);
        scene.motions.push_back(motion);
    }
    // Each joint a quarter turn: along y, then back along -x, then down along -y.
    EXPECT_LT(glm::distance(pose_at(scene, MotionId(0), 1.0).point(Vec3(1, 0, 0)), Vec3(0, 1, 0)), 1e-15);
    EXPECT_LT(glm::distance(pose_at(scene, MotionId(1), 1.0).point(Vec3(2, 0, 0)), Vec3(-1, 1, 0)), 1e-15);
    EXPECT_LT(glm::distance(pose_at(scene, MotionId(2), 1.0).point(Vec3(3, 0, 0)), Vec3(-1, 0, 0)), 1e-15);
    model::Object hand;
    hand.motion = MotionId(2);
    scene.objects = {hand};
    EXPECT_EQ(object_poses(scene, 0.4).at(0), pose_at(scene, MotionId(2), 0.4));
    EXPECT_EQ(key_times(scene, MotionId(2)), (std::vector<double>{0.0, 1.0}));
}

TEST(Pose, after_and_inverse_undo_each_other) {
    const Pose a{glm::angleAxis(0.7, glm::normalize(Vec3(1, 2, 3))), Vec3(1, -2, 0.5)};
    const Pose b{glm::angleAxis(-1.9, glm::normalize(Vec3(0, 1, -1))), Vec3(0, 4, 1)};
    const Vec3 x(0.3, 0.7, -2.0);
    EXPECT_LT(glm::distance(a.after(b).point(x), a.point(b.point(x))), 1e-15);
    EXPECT_LT(glm::distance(a.after(a.inverse()).point(x), x), 1e-15);
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
