// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "kernel/polygon_irradiance.h"
#include "sample/frames.h"
#include "sample/sampler.h"
#include "support/shapes.h"

namespace kinelux::sample {
namespace {

std::optional<model::MeterReading> find(const std::vector<model::MeterReading>& readings,
                                        const std::string& meter, const std::string& quantity) {
    for (const model::MeterReading& reading : readings)
        if (reading.meter == meter && reading.quantity == quantity) return reading;
    return std::nullopt;
}

std::vector<model::MeterReading> read(const model::PatchSet& set, const model::Scene& scene, int n,
                                      double direct, double indirect, double time_s = 0.0) {
    const auto shapes = support::shapes_of(set, n, 1);
    const auto occluders = support::occluders_of(set, scene);
    const std::vector<geometry::Pose> poses(scene.objects.size());
    model::FrameSolution frame = test::uniform_frame(shapes, scene, direct, indirect);
    frame.time_s = time_s;
    return meter_readings(shapes, scene, test::layout_of(shapes), frame, poses, occluders, {});
}

TEST(Meters, object_readings_are_means_and_integrals_over_the_area) {
    model::Scene scene = support::plain_scene(1, 0.5, 2.0);
    scene.quantity = model::Quantity::Photometric;
    const model::PatchSet set{support::box({0, 0, 0}, {1, 2, 3}, support::Facing::Inwards), {}};
    const auto readings = read(set, scene, 2, 1.0, 3.0);
    const double area = 22.0;
    for (const auto& [quantity, value, unit, error] :
         {std::tuple("radiosity", 4.0, "lm/m2", 0.125), std::tuple("irradiance", 4.0, "lx", 0.25),
          std::tuple("flux", 4.0 * area, "lm", 0.125 * area),
          std::tuple("emitted flux", 2.0 * area, "lm", 0.0)}) {
        const auto reading = find(readings, "object0", quantity);
        ASSERT_TRUE(reading) << quantity;
        EXPECT_NEAR(reading->value, value, 1e-12 * area);
        EXPECT_EQ(reading->unit, unit);
        EXPECT_EQ(reading->channel, "grey");
        EXPECT_NEAR(reading->error_estimate, error, 1e-6);
    }
}

TEST(Meters, a_sensor_amid_uniform_walls_reads_their_radiosity) {
    // Whatever the sensor's place and direction, the walls fill its view: E = B.
    model::Scene scene = support::plain_scene(1, 0.5, 0.0);
    const model::PatchSet set{support::box({0, 0, 0}, {1, 2, 3}, support::Facing::Inwards), {}};
    scene.meters = {{"up", {0.1, 0.1, 0.7}, {0.8, 0, 0}, {0, 1.8, 0}, 3, 4},
                    {"skew", {0.3, 0.5, 1.0}, {0.3, 0.1, 0.2}, {-0.1, 0.4, 0.3}, 2, 2},
                    {"near a wall", {0.1, 0.1, 0.02}, {0, 0.5, 0}, {0.5, 0, 0}, 2, 2}};
    const auto readings = read(set, scene, 3, 0.0, 4.0);
    for (const std::string meter : {"up", "skew", "near a wall"})
        for (const std::string quantity : {"mean irradiance", "least irradiance", "greatest irradiance"}) {
            const auto reading = find(readings, meter, quantity);
            ASSERT_TRUE(reading);
            EXPECT_NEAR(reading->value, 2.0, 0.02) << meter << " " << quantity;
            EXPECT_NEAR(reading->error_estimate, 0.125, 0.002);
        }
    EXPECT_TRUE(find(readings, "up[2,3]", "irradiance"));
    EXPECT_FALSE(find(readings, "up[3,3]", "irradiance"));
}

TEST(Meters, a_sensor_reads_lamps_in_closed_form_and_not_what_they_emit_twice) {
    model::Scene scene = support::plain_scene(1, 0.5, 0.0);
    scene.materials.push_back({"lamp", {0.0}, {5.0}, model::Sides::Front});
    const model::PatchSet set{
        {support::rectangle({-0.5, -0.5, 1}, {0, 1, 0}, {1, 0, 0}, ObjectId(0), MaterialId(1))}, {}};
    scene.meters = {{"point", {-0.1, -0.1, 0}, {0.2, 0, 0}, {0, 0.2, 0}, 1, 1}};
    const std::array<Vec3, 4> lamp{Vec3(-0.5, -0.5, 1), Vec3(-0.5, 0.5, 1), Vec3(0.5, 0.5, 1),
                                   Vec3(0.5, -0.5, 1)};
    const auto reading = find(read(set, scene, 2, 0.0, 4.0), "point[0,0]", "irradiance");
    ASSERT_TRUE(reading);
    EXPECT_NEAR(reading->value, 5.0 * kernel::point_to_polygon({0, 0, 0}, {0, 0, 1}, lamp), 1e-12);
}

TEST(Meters, grids_have_the_uniformities_of_their_points) {
    model::Scene scene = support::plain_scene(1, 0.5, 0.0);
    scene.materials.push_back({"lamp", {0.0}, {5.0}, model::Sides::Front});
    const model::PatchSet set{
        {support::rectangle({-0.5, -0.5, 1}, {0, 1, 0}, {1, 0, 0}, ObjectId(0), MaterialId(1))}, {}};
    scene.meters = {{"desk", {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4}};
    const auto readings = read(set, scene, 2, 0.0, 4.0);
    double least = 1e9, greatest = 0.0, sum = 0.0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            const auto one =
                find(readings, "desk[" + std::to_string(i) + "," + std::to_string(j) + "]", "irradiance");
            ASSERT_TRUE(one);
            least = std::min(least, one->value);
            greatest = std::max(greatest, one->value);
            sum += one->value / 16.0;
        }
    const auto u0 = find(readings, "desk", "uniformity U0"), u1 = find(readings, "desk", "uniformity U1");
    ASSERT_TRUE(u0 && u1);
    EXPECT_DOUBLE_EQ(u0->value, least / sum);
    EXPECT_DOUBLE_EQ(u1->value, least / greatest);
    EXPECT_EQ(u0->unit, "1");
    EXPECT_LT(u1->value, u0->value);
    EXPECT_EQ(u0->error_estimate, 0.0); // direct light alone, in closed form
}

TEST(Meters, a_grid_that_follows_a_motion_is_read_where_it_is_and_faces_as_it_is_turned) {
    model::Scene scene = support::plain_scene(1, 0.5, 0.0);
    scene.materials.push_back({"lamp", {0.0}, {5.0}, model::Sides::Front});
    const model::PatchSet set{
        {support::rectangle({-0.5, -0.5, 1}, {0, 1, 0}, {1, 0, 0}, ObjectId(0), MaterialId(1))}, {}};
    // A carriage along x that carries a joint which tilts the sensor towards y.
    model::Motion carriage, joint;
    carriage.keyframes = {{0.0, Vec3(0), Quat(1, 0, 0, 0)}, {1.0, Vec3(0.6, 0, 0), Quat(1, 0, 0, 0)}};
    joint.keyframes = {{0.0, Vec3(0), Quat(1, 0, 0, 0)}, {1.0, Vec3(0), glm::angleAxis(-0.5, Vec3(1, 0, 0))}};
    joint.parent = MotionId(0);
    scene.motions = {carriage, joint};
    scene.meters = {{"point", {-0.1, -0.1, 0}, {0.2, 0, 0}, {0, 0.2, 0}, 1, 1, MotionId(1)}};
    const std::array<Vec3, 4> lamp{Vec3(-0.5, -0.5, 1), Vec3(-0.5, 0.5, 1), Vec3(0.5, 0.5, 1),
                                   Vec3(0.5, -0.5, 1)};
    for (const double t : {0.0, 0.5, 1.0}) {
        const auto reading = find(read(set, scene, 2, 0.0, 4.0, t), "point[0,0]", "irradiance");
        ASSERT_TRUE(reading);
        const Vec3 normal(0.0, std::sin(0.5 * t), std::cos(0.5 * t));
        EXPECT_NEAR(reading->value, 5.0 * kernel::point_to_polygon({0.6 * t, 0, 0}, normal, lamp), 1e-12);
    }
}

TEST(Meters, emitted_flux_is_what_the_dimmed_lamp_emits) {
    model::Scene scene = support::plain_scene(1, 0.5, 2.0);
    scene.dimmings = {{"d", model::Interpolation::Linear, {{0.0, 1.0}, {1.0, 0.5}}}};
    scene.materials[0].dimming = DimmingId(0);
    const model::PatchSet set{support::box({0, 0, 0}, {1, 1, 1}, support::Facing::Inwards), {}};
    for (const double t : {0.0, 0.5, 1.0})
        EXPECT_NEAR(find(read(set, scene, 1, 1.0, 1.0, t), "object0", "emitted flux")->value,
                    12.0 * (1.0 - 0.5 * t), 1e-12);
}

TEST(Meters, a_screen_between_wall_and_sensor_hides_the_wall) {
    model::Scene scene = support::plain_scene(2, 0.5, 0.0);
    scene.materials.push_back({"black", {0.0}, {0.0}, model::Sides::Front});
    model::PatchSet set{{support::rectangle({-1, -1, 2}, {0, 2, 0}, {2, 0, 0})}, {}};
    scene.meters = {{"point", {-0.1, -0.1, 0}, {0.2, 0, 0}, {0, 0.2, 0}, 1, 1}};
    EXPECT_GT(find(read(set, scene, 2, 0.0, 4.0), "point[0,0]", "irradiance")->value, 0.1);
    set.patches.push_back(support::rectangle({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, ObjectId(1), MaterialId(1)));
    EXPECT_EQ(find(read(set, scene, 2, 0.0, 4.0), "point[0,0]", "irradiance")->value, 0.0);
}

} // namespace
} // namespace kinelux::sample
