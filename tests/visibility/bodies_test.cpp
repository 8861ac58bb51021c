// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "visibility/occluders.h"

namespace kinelux::visibility {
namespace {

double area_of(const Body& body) {
    double sum = 0.0;
    for (const model::Triangle& t : body.triangles)
        sum += 0.5 * glm::length(glm::cross(body.points[t[1]] - body.points[t[0]],
                                            body.points[t[2]] - body.points[t[0]]));
    return sum;
}

model::Scene scene_of(std::size_t objects) {
    model::Scene scene;
    scene.objects.resize(objects);
    return scene;
}

/// A hollow or full cylinder of radius 1 and height 1 in eight panels.
model::Patch cylinder(double orientation) {
    model::Patch patch;
    patch.surface.type = model::SurfaceType::Cylinder;
    patch.surface.radius = 1.0;
    patch.surface.orientation = orientation;
    for (std::uint32_t i = 0; i <= 8; ++i)
        for (const double v : {0.0, 1.0}) patch.points.push_back({i * std::numbers::pi / 4.0, v});
    for (std::uint32_t i = 0; i < 8; ++i) {
        patch.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 3});
        patch.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 1});
    }
    return patch;
}

TEST(BodiesOf, a_planar_patch_keeps_its_triangles_and_their_front) {
    model::PatchSet patches;
    model::Patch patch;
    patch.object = ObjectId(1);
    patch.surface.origin = {1.0, 2.0, 3.0};
    patch.points = {{0.0, 0.0}, {2.0, 0.0}, {0.0, 1.0}};
    patch.triangles = {{0, 1, 2}};
    patches.patches = {patch};
    patches.small.points = {{0, 0, 0}, {9, 9, 9}, {1, 0, 0}, {0, 1, 0}};
    patches.small.triangles = {{0, 2, 3}};
    patches.small.objects = {ObjectId(0)};
    const std::vector<Body> bodies = bodies_of(patches, scene_of(3));
    ASSERT_EQ(bodies.size(), 3u);
    EXPECT_EQ(bodies[0].points.size(), 3u);
    EXPECT_DOUBLE_EQ(area_of(bodies[0]), 0.5);
    EXPECT_DOUBLE_EQ(area_of(bodies[1]), 1.0);
    EXPECT_EQ(bodies[1].points[1], Vec3(3.0, 2.0, 3.0));
    EXPECT_TRUE(bodies[2].triangles.empty());
}

TEST(BodiesOf, a_curved_patch_has_48_chords_a_turn) {
    model::PatchSet patches;
    patches.patches = {cylinder(1.0)};
    EXPECT_NEAR(area_of(bodies_of(patches, scene_of(1))[0]), 96.0 * std::sin(std::numbers::pi / 48.0), 1e-12);
}

TEST(BodiesOf, fronts_of_curved_patches_follow_their_orientation) {
    for (const double orientation : {1.0, -1.0}) {
        model::PatchSet patches;
        patches.patches = {cylinder(orientation)};
        const Occluders occluders(bodies_of(patches, scene_of(1)));
        const auto hit = occluders.first_hit({0.01, 0.02, 0.5}, {1.0, 0.3, 0.1});
        ASSERT_TRUE(hit);
        EXPECT_GT(orientation * glm::dot(hit->normal, Vec3(1.0, 0.3, 0.0)), 0.0);
    }
}

TEST(BodiesOf, meshes_keep_the_numbers_of_their_triangles) {
    model::Scene scene = scene_of(2);
    scene.objects[1].mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.objects[1].mesh.triangles = {{0, 1, 1}, {0, 1, 2}};
    scene.objects[1].motion = MotionId(0);
    const std::vector<Body> bodies = bodies_of(scene);
    EXPECT_FALSE(bodies[0].moves);
    EXPECT_TRUE(bodies[1].moves);
    const auto hit = Occluders(bodies).first_hit({0.2, 0.2, 1.0}, {0.0, 0.0, -1.0});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->body, 1u);
    EXPECT_EQ(hit->triangle, 1u);
}

} // namespace
} // namespace kinelux::visibility
