// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan/plan.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace kinelux::plan {
namespace {

const model::Effect& effect(const model::Plan& plan, const std::string& name) {
    for (const auto& e : plan.effects)
        if (e.name == name) return e;
    throw std::runtime_error("no effect " + name);
}

struct Room {
    model::PatchSet set;
    model::Scene scene = support::plain_scene(2, 0.5, 1.0);
    Room() { set.patches = support::box(Vec3(0), Vec3(1), support::Facing::Inwards); }
    model::Plan plan() const { return plan_effects(scene, set, support::uniform_elements(set, 1)); }
};

TEST(Plan, an_empty_room_needs_no_rays_and_a_furnished_one_does) {
    Room room;
    EXPECT_FALSE(room.plan().static_occlusion);
    for (const auto& patch : support::box(Vec3(0.3), Vec3(0.6), support::Facing::Outwards))
        room.set.patches.push_back(patch);
    EXPECT_TRUE(room.plan().static_occlusion);
}

TEST(Plan, grey_scenes_are_computed_in_one_channel) {
    Room room;
    room.scene.channels = {"red", "green"};
    room.scene.materials[0].reflectance = {0.5, 0.5};
    room.scene.materials[0].exitance = {1.0, 2.0};
    EXPECT_TRUE(room.plan().single_channel);
    room.scene.materials[0].reflectance = {0.5, 0.4};
    EXPECT_FALSE(room.plan().single_channel);
}

TEST(Plan, a_motion_that_goes_nowhere_is_no_motion) {
    Room room;
    room.scene.time = {0.0, 1.0, 10};
    room.scene.motions = {{"m",
                           model::Interpolation::Linear,
                           Vec3(0),
                           {{0.0, Vec3(1), Quat(1, 0, 0, 0)}, {1.0, Vec3(1), Quat(1, 0, 0, 0)}}}};
    room.scene.objects[1].motion = MotionId(0);
    EXPECT_TRUE(room.plan().moving_objects.empty());
    room.scene.motions[0].keyframes[1].translation = Vec3(2);
    EXPECT_EQ(room.plan().moving_objects.size(), 1u);
}

TEST(Plan, a_child_that_rests_on_a_moving_parent_moves_and_one_that_undoes_it_does_not) {
    Room room;
    const Quat none(1, 0, 0, 0);
    room.scene.time = {0.0, 1.0, 3};
    room.scene.motions = {
        {"arm", model::Interpolation::Linear, Vec3(0), {{0.0, Vec3(0), none}, {1.0, Vec3(1), none}}},
        {"lamp", model::Interpolation::Linear, Vec3(0), {{0.0, Vec3(0), none}}}};
    room.scene.motions[1].parent = MotionId(0);
    room.scene.objects[1].motion = MotionId(1);
    EXPECT_EQ(room.plan().moving_objects, (std::vector<ObjectId>{ObjectId(1)}));
    room.scene.motions[1].keyframes = {{0.0, Vec3(0), none}, {1.0, Vec3(-1), none}};
    EXPECT_TRUE(room.plan().moving_objects.empty());
    EXPECT_FALSE(effect(room.plan(), "motion").simulated);
    EXPECT_FALSE(effect(room.plan(), "moving occlusion").simulated);
}

TEST(Plan, names_the_dimmings_that_change_over_the_frames_and_no_others) {
    Room room;
    room.scene.time = {0.0, 1.0, 3};
    EXPECT_FALSE(effect(room.plan(), "dimming").simulated);
    EXPECT_NE(effect(room.plan(), "dimming").reason.find("one solve serves all frames"), std::string::npos);
    room.scene.dimmings = {{"evening", model::Interpolation::Linear, {{0.0, 1.0}, {1.0, 0.25}}},
                           {"later", model::Interpolation::Linear, {{5.0, 1.0}, {6.0, 0.0}}}};
    const auto plan = room.plan();
    EXPECT_TRUE(effect(plan, "dimming").simulated);
    EXPECT_NE(effect(plan, "dimming").reason.find("evening (0.25 to 1)"), std::string::npos);
    EXPECT_EQ(effect(plan, "dimming").reason.find("later"), std::string::npos);
    EXPECT_TRUE(plan.moving_objects.empty()) << "dimming moves nothing";
    EXPECT_FALSE(plan.moving_occlusion);
}

TEST(Plan, the_scene_may_overrule_it_and_is_told_what_it_risks) {
    Room room;
    EXPECT_GT(room.plan().bounces, 0u);
    room.scene.effects.interreflection = false;
    const auto plan = room.plan();
    EXPECT_EQ(plan.bounces, 0u);
    EXPECT_TRUE(effect(plan, "interreflection").overridden);
    EXPECT_NEAR(effect(plan, "interreflection").risked_error, 0.5, 1e-12);
}

} // namespace
} // namespace kinelux::plan
