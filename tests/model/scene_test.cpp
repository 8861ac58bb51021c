// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/scene.h"

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"

namespace kinelux::model {
namespace {

Scene small_scene() {
    Scene scene;
    scene.channels = {"grey"};
    scene.materials.push_back({"white", {0.7}, {0.0}, Sides::Auto});
    scene.motions.push_back(
        {"slide", Interpolation::Linear, Vec3(0.0), {{0.0, {}, {1, 0, 0, 0}}, {1.0, {}, {1, 0, 0, 0}}}});
    Object object;
    object.name = "floor";
    object.mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    object.mesh.triangles = {{0, 1, 2}};
    object.mesh.materials = {MaterialId(0)};
    object.motion = MotionId(0);
    scene.objects.push_back(object);
    return scene;
}

TEST(SceneTest, units_follow_the_quantity) {
    EXPECT_EQ(radiosity_unit(Quantity::Radiometric), "W/m2");
    EXPECT_EQ(irradiance_unit(Quantity::Radiometric), "W/m2");
    EXPECT_EQ(flux_unit(Quantity::Radiometric), "W");
    EXPECT_EQ(radiosity_unit(Quantity::Photometric), "lm/m2");
    EXPECT_EQ(irradiance_unit(Quantity::Photometric), "lx");
    EXPECT_EQ(flux_unit(Quantity::Photometric), "lm");
}

TEST(SceneTest, a_material_emits_if_one_channel_does) {
    EXPECT_FALSE((Material{"a", {0.5, 0.5}, {0.0, 0.0}, Sides::Auto}.emits()));
    EXPECT_TRUE((Material{"a", {0.5, 0.5}, {0.0, 2.0}, Sides::Auto}.emits()));
}

TEST(SceneTest, frames_span_the_time_axis_with_both_ends) {
    const TimeAxis time{1.0, 2.0, 11};
    EXPECT_EQ(time.time_of_frame(0), 1.0);
    EXPECT_NEAR(time.time_of_frame(3), 1.3, 1e-15);
    EXPECT_EQ(time.time_of_frame(10), 2.0);
    EXPECT_EQ((TimeAxis{5.0, 5.0, 1}.time_of_frame(0)), 5.0);
}

TEST(SceneTest, a_dimming_holds_its_ends_and_is_a_line_or_steps_between) {
    Dimming dimming{"evening", Interpolation::Linear, {{1.0, 1.0}, {3.0, 0.2}, {4.0, 0.0}}};
    EXPECT_EQ(dimming.factor_at(-1.0), 1.0);
    EXPECT_NEAR(dimming.factor_at(2.0), 0.6, 1e-15);
    EXPECT_EQ(dimming.factor_at(4.0), 0.0);
    EXPECT_EQ(dimming.factor_at(9.0), 0.0);
    dimming.interpolation = Interpolation::Step;
    EXPECT_EQ(dimming.factor_at(2.999), 1.0);
    EXPECT_EQ(dimming.factor_at(3.0), 0.2);
}

TEST(SceneTest, exitance_is_dimmed_per_material_and_changes_if_the_frames_see_it) {
    Scene scene = small_scene();
    scene.materials.push_back({"lamp", {0.0}, {8.0}, Sides::Auto});
    scene.materials.push_back({"other lamp", {0.0}, {2.0}, Sides::Auto});
    scene.time = {0.0, 2.0, 3};
    EXPECT_FALSE(exitance_changes(scene));
    scene.dimmings = {{"evening", Interpolation::Linear, {{0.0, 1.0}, {2.0, 0.5}}}};
    scene.materials[1].dimming = DimmingId(0);
    EXPECT_NO_THROW(check(scene));
    EXPECT_TRUE(exitance_changes(scene));
    EXPECT_EQ(exitances_at(scene, 1.0), (std::vector<std::vector<double>>{{0.0}, {6.0}, {2.0}}));
    scene.time = {5.0, 6.0, 3};
    EXPECT_FALSE(exitance_changes(scene)) << "it is over before the first frame";
}

TEST(SceneTest, check_accepts_a_whole_scene) { EXPECT_NO_THROW(check(small_scene())); }

TEST(SceneTest, check_refuses_each_broken_setting) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::function<void(Scene&)>> faults = {
        [](Scene& s) { s.channels.clear(); },
        [](Scene& s) { s.materials[0].reflectance = {1.0}; },
        [](Scene& s) { s.materials[0].reflectance = {-0.1}; },
        [=](Scene& s) { s.materials[0].reflectance = {nan}; },
        [](Scene& s) { s.materials[0].exitance = {-1.0}; },
        [](Scene& s) {
            s.materials[0].exitance = {1.0, 2.0};
        },
        [](Scene& s) { s.objects[0].motion = MotionId(1); },
        [](Scene& s) { s.motions[0].keyframes.clear(); },
        [](Scene& s) { s.motions[0].keyframes[1].time_s = 0.0; },
        [=](Scene& s) { s.motions[0].keyframes[1].translation.x = nan; },
        [](Scene& s) { s.motions[0].keyframes[1].rotation = Quat(2, 0, 0, 0); },
        [](Scene& s) {
            s.time = {0.0, 0.0, 0};
        },
        [](Scene& s) {
            s.time = {1.0, 0.0, 2};
        },
        [](Scene& s) { s.accuracy.target = 1.0; },
        [](Scene& s) { s.accuracy.degree = 4; },
        [](Scene& s) { s.accuracy.element_size = 0.0; },
        [](Scene& s) { s.exported.cell_size = -1.0; },
        [](Scene& s) { s.exported.frames = {1}; },
        [](Scene& s) {
            s.meters.push_back({"flat", {}, {1, 0, 0}, {2, 0, 0}, 1, 1});
        },
        [](Scene& s) {
            s.meters.push_back({"none", {}, {1, 0, 0}, {0, 1, 0}, 0, 1});
        },
        [](Scene& s) { s.up = Vec3(0.0); },
    };
    for (std::size_t i = 0; i < faults.size(); ++i) {
        Scene scene = small_scene();
        faults[i](scene);
        EXPECT_THROW(check(scene), core::OptionError) << "fault " << i;
    }
}

TEST(SceneTest, check_refuses_motions_and_dimmings_that_cannot_be) {
    const std::vector<std::function<void(Scene&)>> faults = {
        [](Scene& s) { s.motions[0].keyframes[1].turn = Vec3(0, 0, HUGE_VAL); },
        [](Scene& s) { s.motions[0].keyframes[1].tangents.emplace(); },
        [](Scene& s) { s.motions[0].rotation_interpolation = Interpolation::Cubic; },
        [](Scene& s) { s.motions[0].parent = MotionId(1); },
        [](Scene& s) { s.motions[0].parent = MotionId(0); },
        [](Scene& s) { s.materials[0].dimming = DimmingId(0); },
        [](Scene& s) {
            s.dimmings = {{"d", Interpolation::Linear, {}}};
        },
        [](Scene& s) {
            s.dimmings = {{"d", Interpolation::Cubic, {{0.0, 1.0}}}};
        },
        [](Scene& s) {
            s.dimmings = {{"d", Interpolation::Linear, {{0.0, -1.0}}}};
        },
        [](Scene& s) {
            s.dimmings = {{"d", Interpolation::Linear, {{0.0, 1.0}, {0.0, 2.0}}}};
        },
    };
    for (std::size_t i = 0; i < faults.size(); ++i) {
        Scene scene = small_scene();
        faults[i](scene);
        EXPECT_THROW(check(scene), core::OptionError) << "fault " << i;
    }
}

TEST(SceneTest, check_refuses_broken_geometry) {
    Scene scene = small_scene();
    scene.objects[0].mesh.materials[0] = MaterialId(1);
    EXPECT_THROW(check(scene), core::GeometryError);
    scene = small_scene();
    scene.objects[0].mesh = {};
    EXPECT_THROW(check(scene), core::GeometryError);
    scene = small_scene();
    scene.objects.clear();
    EXPECT_THROW(check(scene), core::GeometryError);
}

} // namespace
} // namespace kinelux::model
