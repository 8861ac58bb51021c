// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/log.h"
#include "core/parallel.h"
#include "core/sequence.h"
#include "kernel/polygon_irradiance.h"
#include "reference/scenes.h"

namespace kinelux::reference {
namespace {

using model::Sides;
using test::level_square;
using test::SceneBuilder;

SensorPoint sensor(const Vec3& x, const Vec3& normal) { return {ObjectId(0), 0, x, normal}; }

/// A unit lamp with M = 3 at height 1, facing down, over a black floor of side 4.
model::Scene lamp_over_floor(double floor_reflectance = 0.0) {
    SceneBuilder builder;
    builder.object({level_square(4.0, 0.0, true)}, builder.material({floor_reflectance}, {0.0}));
    builder.object({level_square(1.0, 1.0, false)}, builder.material({0.0}, {3.0}));
    return builder.scene;
}

double lamp_irradiance(const Vec3& x, const Vec3& normal) {
    const std::array<Vec3, 4> lamp{Vec3(-0.5, -0.5, 1), Vec3(-0.5, 0.5, 1), Vec3(0.5, 0.5, 1),
                                   Vec3(0.5, -0.5, 1)};
    return 3.0 * kernel::point_to_polygon(x, normal, lamp);
}

std::vector<SensorPoint> floor_points(int count, std::uint64_t seed) {
    std::vector<SensorPoint> points;
    for (int i = 0; i < count; ++i) {
        const Vec2 s = core::sobol_2d(static_cast<std::uint32_t>(i), seed);
        points.push_back(sensor({3.0 * s.x - 1.5, 3.0 * s.y - 1.5, 0.0}, {0, 0, 1}));
    }
    return points;
}

TEST(Reference, a_furnace_has_the_irradiance_of_its_closed_form) {
    // Closed, M and rho uniform: B = M / (1 - rho), and E = B everywhere.
    SceneBuilder builder({"a", "b"});
    builder.object(support::box({0, 0, 0}, {1, 2, 0.7}, support::Facing::Inwards),
                   builder.material({0.5, 0.2}, {1.0, 2.0}));
    std::vector<SensorPoint> points;
    for (std::uint32_t i = 0; i < 24; ++i) {
        const Vec2 s = core::sobol_2d(i, 5);
        points.push_back(sensor({s.x, 2.0 * s.y, 0.0}, {0, 0, 1}));
        points.push_back(sensor({1.0, 2.0 * s.y, 0.7 * s.x}, {-1, 0, 0}));
    }
    const auto readings = trace_irradiance(builder.scene, 0.0, points, {.paths = 1024, .seed = 3});
    for (const auto& [channel, truth] : {std::pair(0u, 2.0), std::pair(1u, 2.5)}) {
        double mean = 0.0, variance = 0.0;
        for (const SensorReading& reading : readings) {
            EXPECT_NEAR(reading.irradiance[channel], truth, 5.0 * reading.standard_error[channel]);
            EXPECT_LT(reading.standard_error[channel], 0.03 * truth);
            mean += reading.irradiance[channel] / static_cast<double>(readings.size());
            variance += reading.standard_error[channel] * reading.standard_error[channel];
        }
        EXPECT_NEAR(mean, truth, 3.0 * std::sqrt(variance) / static_cast<double>(readings.size()));
    }
}

TEST(Reference, a_lamp_gives_the_closed_form_of_direct_light_and_honest_errors) {
    const std::vector<SensorPoint> points = floor_points(1000, 9);
    const auto readings = trace_irradiance(lamp_over_floor(), 0.0, points, {.paths = 1024, .seed = 1});
    int within = 0;
    double relative = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double truth = lamp_irradiance(points[i].position, points[i].normal);
        within += std::abs(readings[i].irradiance[0] - truth) < 2.0 * readings[i].standard_error[0] ? 1 : 0;
        relative += readings[i].standard_error[0] / truth / 1000.0;
    }
    // Student's t with 15 degrees of freedom: 93.6 % lie within two standard errors.
    EXPECT_GT(within, 900);
    EXPECT_LT(within, 970);
    EXPECT_LT(relative, 0.01);
}

TEST(Reference, errors_are_honest_with_interreflection_and_a_shadow) {
    SceneBuilder builder;
    builder.object(support::box({-2, -2, 0}, {2, 2, 3}, support::Facing::Inwards),
                   builder.material({0.7}, {0.0}));
    builder.object({level_square(1.0, 2.9, false)}, builder.material({0.0}, {10.0}));
    builder.object({level_square(1.2, 1.5, true)}, builder.material({0.4}, {0.0}, Sides::Both));
    const std::vector<SensorPoint> point{sensor({0.4, 0.3, 0.0}, {0, 0, 1})};
    const SensorReading truth = trace_irradiance(builder.scene, 0.0, point, {.paths = 200000, .seed = 77})[0];
    const std::vector<SensorPoint> copies(400, point[0]); // each with samples of its own
    const auto readings = trace_irradiance(builder.scene, 0.0, copies, {.paths = 512, .seed = 1});
    int within = 0;
    for (const SensorReading& reading : readings)
        within +=
            std::abs(reading.irradiance[0] - truth.irradiance[0]) < 2.0 * reading.standard_error[0] ? 1 : 0;
    EXPECT_GT(within, 360);
    EXPECT_LT(within, 396);
}

TEST(Reference, a_point_next_to_a_lamp_has_a_small_error) {
    for (const double gap : {1e-1, 1e-2, 1e-3}) {
        const std::vector<SensorPoint> point{sensor({0.1, 0.2, 1.0 - gap}, {0, 0, 1})};
        const SensorReading reading =
            trace_irradiance(lamp_over_floor(), 0.0, point, {.paths = 256, .seed = 2})[0];
        EXPECT_NEAR(reading.irradiance[0], lamp_irradiance(point[0].position, {0, 0, 1}),
                    4.0 * reading.standard_error[0] + 1e-3);
        EXPECT_LT(reading.standard_error[0], 0.1);
    }
}

TEST(Reference, backs_of_one_sided_faces_are_black) {
    SceneBuilder builder;
    builder.object({level_square(2.0, 0.0, true)}, builder.material({0.0}, {0.0}));
    builder.object({level_square(1.0, 1.0, true)}, builder.material({0.0}, {1.0})); // looks away
    const std::vector<SensorPoint> point{sensor({0.1, 0.2, 0.0}, {0, 0, 1})};
    EXPECT_EQ(trace_irradiance(builder.scene, 0.0, point, {.paths = 64})[0].irradiance[0], 0.0);

    builder.scene.objects[1].mesh.two_sided = {1, 1};
    const SensorReading reading = trace_irradiance(builder.scene, 0.0, point, {.paths = 256})[0];
    EXPECT_NEAR(reading.irradiance[0], lamp_irradiance(point[0].position, {0, 0, 1}) / 3.0,
                4.0 * reading.standard_error[0]);
}

TEST(Reference, a_moved_lamp_shines_where_it_is) {
    model::Scene scene = lamp_over_floor();
    scene.motions.push_back({"slide",
                             model::Interpolation::Linear,
                             Vec3(0.0),
                             {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)}, {2.0, Vec3(2, 0, 0), Quat(1, 0, 0, 0)}}});
    scene.objects[1].motion = MotionId(0);
    const std::vector<SensorPoint> point{sensor({0.1, 0.2, 0.0}, {0, 0, 1})};
    const SensorReading reading = trace_irradiance(scene, 1.0, point, {.paths = 1024})[0];
    EXPECT_NEAR(reading.irradiance[0], lamp_irradiance({-0.9, 0.2, 0.0}, {0, 0, 1}),
                4.0 * reading.standard_error[0]);
}

TEST(Reference, a_dimmed_lamp_shines_as_bright_as_it_is_at_the_time) {
    model::Scene scene = lamp_over_floor();
    scene.dimmings = {{"evening", model::Interpolation::Linear, {{0.0, 1.0}, {2.0, 0.0}}}};
    scene.materials[scene.objects[1].mesh.materials[0].value].dimming = DimmingId(0);
    const std::vector<SensorPoint> point{sensor({0.1, 0.2, 0.0}, {0, 0, 1})};
    const SensorReading reading = trace_irradiance(scene, 0.5, point, {.paths = 1024})[0];
    EXPECT_NEAR(reading.irradiance[0], 0.75 * lamp_irradiance({0.1, 0.2, 0.0}, {0, 0, 1}),
                4.0 * reading.standard_error[0]);
    EXPECT_EQ(trace_irradiance(scene, 2.0, point, {.paths = 64})[0].irradiance[0], 0.0);
}

TEST(Reference, the_bytes_do_not_depend_on_the_number_of_threads) {
    const model::Scene scene = lamp_over_floor(0.5);
    const std::vector<SensorPoint> points = floor_points(100, 3);
    core::set_thread_count(1);
    const auto one = trace_irradiance(scene, 0.0, points, {.paths = 1024, .noise = 0.005});
    core::set_thread_count(2);
    const auto two = trace_irradiance(scene, 0.0, points, {.paths = 1024, .noise = 0.005});
    core::set_thread_count(0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(one[i].irradiance, two[i].irradiance);
        EXPECT_EQ(one[i].standard_error, two[i].standard_error);
    }
}

TEST(Reference, a_noise_asked_for_is_reached_without_bias) {
    const auto points = floor_points(50, 4);
    const auto truth = trace_irradiance(lamp_over_floor(), 0.0, points, {.paths = 65536, .seed = 7});
    for (const double noise : {0.02, 0.002}) {
        const auto readings =
            trace_irradiance(lamp_over_floor(), 0.0, points, {.paths = 1'000'000, .noise = noise});
        EXPECT_LE(noise_of(readings), noise);
        EXPECT_GT(noise_of(readings), 0.01 * noise);
        double difference = 0.0, sum = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            difference += readings[i].irradiance[0] - truth[i].irradiance[0];
            sum += truth[i].irradiance[0];
        }
        EXPECT_LT(std::abs(difference), 0.5 * noise * sum);
    }
    const auto few = trace_irradiance(lamp_over_floor(), 0.0, points, {.paths = 64, .noise = 1e-9});
    const auto all = trace_irradiance(lamp_over_floor(), 0.0, points, {.paths = 64});
    EXPECT_EQ(few[0].irradiance, all[0].irradiance); // paths are the most
}

TEST(Reference, a_scene_without_light_is_dark) {
    SceneBuilder builder;
    builder.object({level_square(2.0, 0.0, true)}, builder.material({0.5}, {0.0}));
    const auto readings = trace_irradiance(builder.scene, 0.0, floor_points(3, 4), {.paths = 16});
    for (const SensorReading& reading : readings) EXPECT_EQ(reading.irradiance, std::vector<double>{0.0});
}

} // namespace
} // namespace kinelux::reference
