// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/settle.h"

#include <numbers>

#include <gtest/gtest.h>

#include "geometry/pose.h"

namespace kinelux::geometry {
namespace {

const Quat no_turn(1, 0, 0, 0);

Quat about_z(double angle) { return glm::angleAxis(angle, Vec3(0, 0, 1)); }

model::Motion path(std::vector<model::Keyframe> keyframes) {
    model::Motion motion;
    motion.name = "path";
    motion.keyframes = std::move(keyframes);
    return motion;
}

// Triangles that follow the motions given; a room of four corners around them. Five frames in [0, 2] s.
model::Scene scene_with(std::vector<model::Motion> motions, const std::vector<int>& followed) {
    model::Scene scene;
    scene.channels = {"grey"};
    scene.materials = {{"grey", {0.5}, {0.0}, model::Sides::Front}};
    scene.time = {0.0, 2.0, 5};
    scene.motions = std::move(motions);
    model::Object room;
    room.mesh.points = {{-5, -5, -5}, {5, -5, -5}, {5, 5, 5}};
    room.mesh.triangles = {{0, 1, 2}};
    room.mesh.materials = {MaterialId(0)};
    scene.objects = {room};
    for (const int motion : followed) {
        model::Object body = room;
        body.mesh.points = {{1, 0, 0}, {2, 0, 0}, {1, 1, 0}};
        if (motion >= 0) body.motion = MotionId(motion);
        scene.objects.push_back(body);
    }
    return scene;
}

// Where the corners of all bodies are in all frames.
std::vector<Vec3> places(const model::Scene& scene) {
    std::vector<Vec3> result;
    for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame) {
        const auto poses = object_poses(scene, scene.time.time_of_frame(frame));
        for (std::size_t o = 0; o < scene.objects.size(); ++o)
            for (const Vec3& point : scene.objects[o].mesh.points) result.push_back(poses[o].point(point));
    }
    return result;
}

std::vector<Settled> settle_in_place(model::Scene& scene) {
    const std::vector<Vec3> before = places(scene);
    std::vector<Settled> settled = settle_motions(scene);
    const std::vector<Vec3> after = places(scene);
    for (std::size_t p = 0; p < before.size(); ++p) EXPECT_LT(glm::distance(before[p], after[p]), 1e-12);
    return settled;
}

const model::Motion glide = path({{0.0, Vec3(0), no_turn}, {2.0, Vec3(1, 0, 0), no_turn}});

TEST(Settle, a_body_that_stays_where_its_motion_puts_it_rests_there) {
    model::Scene scene = scene_with({path({{0.5, Vec3(1, 2, 3), about_z(0.5)}})}, {0});
    EXPECT_FALSE(changes_pose(scene, MotionId(0)));
    EXPECT_EQ(settle_in_place(scene).at(1), Settled::AtRest);
    EXPECT_FALSE(scene.objects.at(1).motion);
    EXPECT_GT(scene.objects[1].mesh.points[0].z, 2.9);
}

TEST(Settle, a_motion_that_is_over_before_the_first_frame_or_seen_in_one_frame_only_is_none) {
    model::Scene late = scene_with({glide}, {0});
    late.time = {5.0, 6.0, 4};
    EXPECT_EQ(settle_in_place(late).at(1), Settled::AtRest);
    EXPECT_NEAR(late.objects.at(1).mesh.points[0].x, 2.0, 1e-15);
    model::Scene once = scene_with({glide}, {0});
    once.time = {1.0, 1.0, 1};
    EXPECT_EQ(settle_in_place(once).at(1), Settled::AtRest);
    EXPECT_NEAR(once.objects.at(1).mesh.points[0].x, 1.5, 1e-15);
}

TEST(Settle, bodies_on_different_motions_with_one_path_are_moved_as_one) {
    model::Scene scene = scene_with({glide, glide}, {0, 1});
    const auto settled = settle_in_place(scene);
    EXPECT_EQ(settled.at(1), Settled::AsItWas);
    EXPECT_EQ(settled.at(2), Settled::WithOthers);
    EXPECT_EQ(scene.objects.at(1).motion, scene.objects.at(2).motion);
}

TEST(Settle, a_child_that_keeps_still_on_its_moving_parent_is_moved_as_one_with_it) {
    model::Motion arm = path({{0.0, Vec3(0), no_turn}, {2.0, Vec3(0), about_z(1.5)}});
    model::Motion held = path({{0.0, Vec3(0, 0, 1), about_z(0.3)}});
    held.parent = MotionId(0);
    model::Scene scene = scene_with({arm, held}, {0, 1});
    EXPECT_EQ(settle_in_place(scene).at(2), Settled::WithOthers);
    EXPECT_EQ(scene.objects.at(2).motion, MotionId(0));
}

TEST(Settle, a_child_that_moves_on_its_parent_keeps_its_own_motion) {
    model::Motion child = path({{0.0, Vec3(0), no_turn}, {2.0, Vec3(0), about_z(1.0)}});
    child.parent = MotionId(0);
    model::Scene scene = scene_with({glide, child}, {0, 1});
    EXPECT_EQ(settle_in_place(scene).at(2), Settled::AsItWas);
    EXPECT_EQ(scene.objects.at(2).motion, MotionId(1));
}

TEST(Settle, a_child_that_undoes_its_parents_motion_rests) {
    model::Motion back = path({{0.0, Vec3(0), no_turn}, {2.0, Vec3(-1, 0, 0), no_turn}});
    back.parent = MotionId(0);
    model::Scene scene = scene_with({glide, back}, {1});
    EXPECT_EQ(settle_in_place(scene).at(1), Settled::AtRest);
}

TEST(Settle, equal_shifts_from_different_places_are_one_and_equal_turns_about_different_pivots_are_not) {
    model::Motion elsewhere = glide;
    for (model::Keyframe& key : elsewhere.keyframes) key.translation += Vec3(0, 3, 1);
    model::Scene shifted = scene_with({glide, elsewhere}, {0, 1});
    EXPECT_EQ(settle_in_place(shifted).at(2), Settled::WithOthers);

    const model::Motion turn = path({{0.0, Vec3(0), no_turn}, {2.0, Vec3(0), about_z(1.0)}});
    model::Motion other_pivot = turn;
    other_pivot.pivot = Vec3(1, 0, 0);
    model::Scene turned = scene_with({turn, other_pivot}, {0, 1});
    EXPECT_EQ(settle_in_place(turned).at(2), Settled::AsItWas);
}

TEST(Settle, a_full_turn_between_frames_is_no_change_of_pose) {
    // Four turns a second and two frames a second: it is where it was in each of them.
    model::Motion fan = path({{0.0, Vec3(0), no_turn}, {2.0, Vec3(0), no_turn}});
    fan.keyframes[1].turn = Vec3(0, 0, 16.0 * std::numbers::pi);
    const model::Scene scene = scene_with({fan}, {0});
    EXPECT_FALSE(changes_pose(scene, MotionId(0)));
}

} // namespace
} // namespace kinelux::geometry
