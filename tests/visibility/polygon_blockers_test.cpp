// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/polygon_blockers.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "core/error.h"
#include "visibility/polygons.h"
#include "visibility/shapes.h"

namespace kinelux::visibility {
namespace {

using test::normal_of;
using test::Polygon;
using test::square;

constexpr std::size_t no_limit = 1000000;

/// A convex polygon as a body of one outline and a fan of triangles.
Body body_of(const Polygon& polygon, bool moves = false) {
    Body body;
    body.points = polygon;
    Outline& outline = body.outlines.emplace_back();
    outline.loops.emplace_back(polygon.size());
    std::iota(outline.loops[0].begin(), outline.loops[0].end(), 0u);
    for (std::uint32_t i = 2; i < polygon.size(); ++i) body.triangles.push_back({0, i - 1, i});
    outline.triangle_count = static_cast<std::uint32_t>(body.triangles.size());
    body.moves = moves;
    return body;
}

/// The square of half width 3 at z = 1 without the square of half width 1.
model::PatchSet frame() {
    model::PatchSet set;
    model::Patch patch;
    patch.surface.origin = {0.0, 0.0, 1.0};
    for (const double half : {3.0, 1.0})
        for (const Vec2& p : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)})
            patch.points.push_back(half * p);
    patch.triangles = {{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5},
                       {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    patch.loops = {{0, 1, 2, 3}, {7, 6, 5, 4}};
    set.patches = {patch};
    return set;
}

model::Patch behind(model::Patch patch) {
    std::swap(patch.surface.axis_u, patch.surface.axis_v);
    patch.surface.axis_w = -patch.surface.axis_w;
    for (Vec2& p : patch.points) std::swap(p.x, p.y);
    for (model::Triangle& t : patch.triangles) std::swap(t[1], t[2]);
    for (auto& loop : patch.loops) std::reverse(loop.begin(), loop.end());
    return patch;
}

model::Scene scene_of(std::size_t objects) {
    model::Scene scene;
    scene.objects.resize(objects);
    return scene;
}

Shaft shaft_between(const Polygon& a, const Polygon& b) {
    return {shaft_end(a, normal_of(a)), shaft_end(b, normal_of(b))};
}

std::vector<std::uint32_t> found_by(const PolygonBlockers& blockers, const Shaft& shaft,
                                    Among among = Among::All, std::size_t most = no_limit) {
    std::vector<std::uint32_t> found;
    blockers.find(shaft, among, most, found);
    std::sort(found.begin(), found.end());
    return found;
}

TEST(PolygonBlockers, a_wall_with_a_window_is_one_polygon) {
    const PolygonBlockers blockers(bodies_of(frame(), scene_of(1)));
    ASSERT_EQ(blockers.size(), 1u);
    EXPECT_NEAR(blockers[0].area, 32.0, 1e-12);
    EXPECT_EQ(blockers[0].loop_count, 2u);
    EXPECT_FALSE(blockers[0].convex);
    EXPECT_FALSE(blockers[0].fine);
    EXPECT_EQ(blockers[0].piece_count, 4u);
    EXPECT_EQ(blockers.loop_of(0, 0).size(), 4u);
    EXPECT_NEAR(glm::distance(blockers[0].plane.normal, Vec3(0, 0, 1)), 0.0, 1e-15);
    EXPECT_NEAR(blockers[0].plane.offset, 1.0, 1e-15);
}

TEST(PolygonBlockers, both_sides_of_a_sheet_are_one_polygon) {
    model::PatchSet set = frame();
    set.patches[0].surface.origin = {0.1, 0.7, 1.0 / 3.0};
    const double angle = 0.3;
    set.patches[0].surface.axis_u = {std::cos(angle), std::sin(angle), 0.0};
    set.patches[0].surface.axis_v = {-std::sin(angle), std::cos(angle), 0.0};
    set.patches.push_back(behind(set.patches[0]));
    set.patches.push_back(set.patches[0]); // the same at another place, facing the same way: two polygons
    set.patches[2].surface.origin.z += 1e-3;
    set.small.points = {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    set.small.triangles = {{0, 1, 2}, {0, 2, 1}};
    set.small.objects.resize(2);
    EXPECT_EQ(PolygonBlockers(bodies_of(set, scene_of(1))).size(), 3u);
}

TEST(PolygonBlockers, triangles_without_outline_are_fine_polygons) {
    model::PatchSet set = frame();
    set.small.points = {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    set.small.triangles = {{0, 1, 2}};
    set.small.objects.resize(1);
    const PolygonBlockers blockers(bodies_of(set, scene_of(1)));
    ASSERT_EQ(blockers.size(), 2u);
    EXPECT_TRUE(blockers[1].fine);
    EXPECT_TRUE(blockers[1].convex);
}

TEST(PolygonBlockers, loops_around_other_areas_than_the_triangles_are_not_believed) {
    model::PatchSet set = frame();
    set.patches[0].loops.pop_back();
    const PolygonBlockers blockers(bodies_of(set, scene_of(1)));
    EXPECT_EQ(blockers.size(), 8u);
    EXPECT_TRUE(blockers[7].fine);
}

TEST(PolygonBlockers, the_tree_finds_what_a_look_at_all_polygons_finds) {
    core::Random random(21);
    std::vector<Body> bodies;
    for (int i = 0; i < 500; ++i) {
        const double size = i % 50 == 0 ? 0.8 : 0.05;
        bodies.push_back(body_of(test::random_polygon(random, size), i % 5 == 0));
    }
    const PolygonBlockers blockers(bodies);
    ASSERT_EQ(blockers.size(), 500u);
    std::size_t total = 0;
    for (int pair = 0; pair < 300; ++pair) {
        const Shaft shaft =
            shaft_between(test::random_polygon(random, 0.2), test::random_polygon(random, 0.2));
        std::vector<std::uint32_t> all, resting;
        for (std::uint32_t i = 0; i < blockers.size(); ++i)
            if (!shaft.misses(blockers[i].box_low, blockers[i].box_high) &&
                !shaft.misses(blockers.loop_of(i, 0), blockers[i].plane)) {
                all.push_back(i);
                if (!bodies[blockers[i].body].moves) resting.push_back(i);
            }
        EXPECT_EQ(found_by(blockers, shaft), all);
        EXPECT_EQ(found_by(blockers, shaft, Among::Resting), resting);
        EXPECT_EQ(found_by(blockers, shaft, Among::Moving).size(), all.size() - resting.size());
        EXPECT_EQ(found_by(blockers, shaft, Among::All, 2).size(), std::min<std::size_t>(all.size(), 3));
        total += all.size();
    }
    EXPECT_GT(total, 500u);
}

TEST(PolygonBlockers, moved_polygons_are_found_where_they_are) {
    const Shaft shaft = shaft_between(square(1.0, 0.0), test::reversed(square(1.0, 2.0)));
    PolygonBlockers blockers(
        std::vector<Body>{body_of(square(9.0, -1.0)), body_of(square(0.5, 1.0, 4.0), true)});
    EXPECT_TRUE(found_by(blockers, shaft).empty());
    blockers.set_poses(std::vector<geometry::Pose>{{}, {Quat(1, 0, 0, 0), {-4.0, 0.0, 0.2}}});
    EXPECT_EQ(found_by(blockers, shaft), std::vector<std::uint32_t>{1});
    EXPECT_NEAR(blockers[1].plane.offset, 1.2, 1e-14);
    EXPECT_NEAR(blockers.loop_of(1, 0)[0].x, -0.5, 1e-14);
    blockers.set_poses(std::vector<geometry::Pose>(2));
    EXPECT_TRUE(found_by(blockers, shaft).empty());
}

TEST(PolygonBlockers, those_of_occluders_follow_their_poses) {
    Occluders occluders({test::level_square(9.0, -1.0), test::level_square(0.5, 5.0, true)});
    const Shaft shaft = shaft_between(square(1.0, 0.0), test::reversed(square(1.0, 2.0)));
    const std::vector<geometry::Pose> down{{}, {Quat(1, 0, 0, 0), {0.0, 0.0, -4.0}}};
    occluders.set_poses(down);
    EXPECT_EQ(found_by(occluders.polygons(), shaft).size(), 2u); // two triangles
    occluders.set_poses(std::vector<geometry::Pose>(2));
    EXPECT_EQ(found_by(occluders.polygons(), shaft).size(), 0u);
}

TEST(PolygonBlockers, nothing_and_degenerate_triangles_block_nothing) {
    const Shaft shaft = shaft_between(square(1.0, 0.0), test::reversed(square(1.0, 2.0)));
    EXPECT_TRUE(found_by(PolygonBlockers({}), shaft).empty());
    Body body;
    body.points = {{0, 0, 1}, {1, 0, 1}};
    body.triangles = {{0, 1, 1}, {0, 0, 0}};
    EXPECT_EQ(PolygonBlockers(std::vector<Body>{body}).size(), 0u);
}

TEST(PolygonBlockers, outlines_out_of_range_and_pose_counts_are_refused) {
    Body body = body_of(square(1.0, 0.0));
    body.outlines[0].loops[0][1] = 9;
    EXPECT_THROW(PolygonBlockers(std::vector<Body>{body}), core::GeometryError);
    body = body_of(square(1.0, 0.0));
    body.outlines[0].triangle_count = 3;
    EXPECT_THROW(PolygonBlockers(std::vector<Body>{body}), core::GeometryError);
    PolygonBlockers one(std::vector<Body>{body_of(square(1.0, 0.0))});
    EXPECT_THROW(one.set_poses({}), core::GeometryError);
}

} // namespace
} // namespace kinelux::visibility
