// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/scene.h"

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
