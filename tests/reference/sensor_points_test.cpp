// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "reference/reference.h"
#include "reference/scenes.h"

namespace kinelux::reference {
namespace {

using test::level_square;
using test::SceneBuilder;

TEST(SensorPoints, counts_follow_the_area_and_emitters_get_none) {
    SceneBuilder builder;
    const MaterialId grey = builder.material({0.5}, {0.0});
    builder.object({level_square(1.0, 0.0, true)}, grey);
    builder.object({level_square(3.0, 1.0, true)}, grey);
    builder.object({level_square(5.0, 2.0, true)}, builder.material({0.5}, {1.0}));
    std::map<std::uint32_t, int> count;
    for (const SensorPoint& point : sensor_points(builder.scene, 0.0, 1000, 3)) ++count[point.object.value];
    EXPECT_EQ(count[0] + count[1], 1000);
    EXPECT_NEAR(count[0], 100, 1);
    EXPECT_EQ(count[2], 0);
}

TEST(SensorPoints, points_lie_strictly_inside_their_triangle) {
    SceneBuilder builder;
    builder.object({level_square(2.0, 0.5, true)}, builder.material({0.5}, {0.0}));
    const model::Mesh& mesh = builder.scene.objects[0].mesh;
    Vec2 mean(0.0);
    for (const SensorPoint& point : sensor_points(builder.scene, 0.0, 4096, 5)) {
        const model::Triangle& t = mesh.triangles[point.triangle];
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3 a = mesh.points[t[c]], b = mesh.points[t[(c + 1) % 3]];
            EXPECT_GT(glm::cross(b - a, point.position - a).z, 1e-5);
        }
        EXPECT_EQ(point.position.z, 0.5);
        EXPECT_EQ(point.normal, Vec3(0, 0, 1));
        mean += Vec2(point.position) / 4096.0;
    }
    EXPECT_NEAR(mean.x, 0.0, 5e-3);
    EXPECT_NEAR(mean.y, 0.0, 5e-3);
}

TEST(SensorPoints, both_sides_of_sheets_are_judged) {
    SceneBuilder builder;
    builder.object({level_square(2.0, 0.5, true)}, builder.material({0.5}, {0.0}, model::Sides::Both));
    int up = 0;
    for (const SensorPoint& point : sensor_points(builder.scene, 0.0, 1000, 5))
        up += point.normal.z > 0.0 ? 1 : 0;
    EXPECT_NEAR(up, 500, 60);
}

TEST(SensorPoints, none_lie_below_a_face_of_another_object_in_the_same_plane) {
    SceneBuilder builder;
    const MaterialId grey = builder.material({0.5}, {0.0}, model::Sides::Front);
    builder.object({level_square(2.0, 0.5, true)}, grey);
    builder.object({level_square(1.0, 0.5, true)}, builder.material({0.5}, {1.0}, model::Sides::Front));
    builder.object({level_square(1.5, 0.5, false)}, grey); // looks the other way
    const auto points = sensor_points(builder.scene, 0.0, 4096, 5);
    std::map<std::uint32_t, int> count;
    for (const SensorPoint& point : points) {
        ++count[point.object.value];
        if (point.object.value == 0) {
            EXPECT_GT(std::max(std::abs(point.position.x), std::abs(point.position.y)), 0.5);
        }
    }
    EXPECT_NEAR(count[0], 4096 * 3.0 / 6.25, 80);
    EXPECT_NEAR(count[2], 4096 * 2.25 / 6.25, 80);
}

TEST(SensorPoints, a_scene_of_lamps_has_none) {
    SceneBuilder builder;
    builder.object({level_square(2.0, 0.5, true)}, builder.material({0.5}, {1.0}));
    EXPECT_TRUE(sensor_points(builder.scene, 0.0, 10, 5).empty());
}

} // namespace
} // namespace kinelux::reference
