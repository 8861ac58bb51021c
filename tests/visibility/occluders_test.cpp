// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/occluders.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/sequence.h"
#include "visibility/shapes.h"

namespace kinelux::visibility {
namespace {

using test::level_square;
using test::parallelogram;

geometry::Pose shifted(const Vec3& by) { return {Quat(1.0, 0.0, 0.0, 0.0), by}; }

/// Segments between two heights that leave the vertices and edges of the scenes here aside.
std::vector<Segment> random_segments(std::size_t count, double reach, double low, double high,
                                     std::uint64_t seed) {
    core::Random random(seed);
    std::vector<Segment> segments;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2 a = reach * (2.0 * random.next_2d() - 1.0), b = reach * (2.0 * random.next_2d() - 1.0);
        segments.push_back({Vec3(a, low), Vec3(b, high)});
    }
    return segments;
}

TEST(Occluders, a_square_blocks_exactly_the_segments_that_cross_it) {
    const Occluders occluders({level_square(1.0, 0.0), level_square(4.0, -1.0), level_square(4.0, 1.0)});
    for (const Segment& s : random_segments(20000, 3.0, -1.0, 1.0, 7)) {
        const Vec3 middle = 0.5 * (s.from + s.to);
        const double clearance = 1.0 - std::max(std::abs(middle.x), std::abs(middle.y));
        if (std::abs(clearance) > 1e-5) {
            EXPECT_EQ(occluders.occluded(s.from, s.to), clearance > 0.0) << middle.x << " " << middle.y;
        }
    }
}

TEST(Occluders, both_sides_of_a_face_block) {
    const Occluders occluders({level_square(1.0, 0.0)});
    EXPECT_TRUE(occluders.occluded({0.1, 0.2, 1.0}, {0.1, 0.2, -1.0}));
    EXPECT_TRUE(occluders.occluded({0.1, 0.2, -1.0}, {0.1, 0.2, 1.0}));
}

TEST(Occluders, the_faces_that_segments_end_on_do_not_block) {
    const Occluders occluders({level_square(2.0, 0.0), level_square(2.0, 1.0)});
    for (const Segment& s : random_segments(20000, 1.99, 0.0, 1.0, 11))
        EXPECT_FALSE(occluders.occluded(s.from, s.to));
}

TEST(Occluders, coplanar_faces_do_not_block) {
    // The receiver lies on a large square; a second square lies in the same plane, a third in the source's plane.
    const Occluders occluders(
        {level_square(2.0, 0.0), level_square(0.5, 0.0), level_square(2.0, 1.0), level_square(0.7, 1.0)});
    for (const Segment& s : random_segments(20000, 1.99, 0.0, 1.0, 13))
        EXPECT_FALSE(occluders.occluded(s.from, s.to));
}

TEST(Occluders, grazing_segments_off_a_face_are_free) {
    const Occluders occluders({parallelogram({-5.0, -5.0, 0.1}, {10.0, 0.0, 0.3}, {0.0, 10.0, -0.7})});
    const Vec3 normal = glm::normalize(glm::cross(Vec3(10.0, 0.0, 0.3), Vec3(0.0, 10.0, -0.7)));
    core::Random random(3);
    int blocked = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec2 a = random.next_2d(), b = random.next_2d();
        const Vec3 from = Vec3(-5.0, -5.0, 0.1) + a.x * Vec3(10.0, 0.0, 0.3) + a.y * Vec3(0.0, 10.0, -0.7);
        const Vec3 over = Vec3(-5.0, -5.0, 0.1) + b.x * Vec3(10.0, 0.0, 0.3) + b.y * Vec3(0.0, 10.0, -0.7);
        const double slope = 1e-2; // about half a degree
        blocked += occluders.occluded(from, over + slope * glm::distance(from, over) * normal) ? 1 : 0;
    }
    EXPECT_EQ(blocked, 0);
}

TEST(Occluders, a_segment_shorter_than_its_end_offsets_is_free) {
    const Occluders occluders({level_square(1.0, 0.0)});
    const double d = 0.9 * occluders.end_offset();
    EXPECT_FALSE(occluders.occluded({0.1, 0.2, -d}, {0.1, 0.2, d}));
    EXPECT_TRUE(occluders.occluded({0.1, 0.2, -3.0 * d}, {0.1, 0.2, 3.0 * d}));
}

TEST(Occluders, a_moved_body_blocks_where_it_is_and_not_where_it_was) {
    Occluders occluders({level_square(4.0, -1.0), level_square(0.5, 0.0, true)});
    const Segment at_rest{{0.1, 0.0, -1.0}, {0.1, 0.0, 1.0}}, beside{{2.1, 0.0, -1.0}, {2.1, 0.0, 1.0}};
    EXPECT_TRUE(occluders.occluded(at_rest.from, at_rest.to));
    EXPECT_FALSE(occluders.occluded(beside.from, beside.to));

    const std::vector<geometry::Pose> poses{{}, shifted({2.0, 0.0, 0.3})};
    occluders.set_poses(poses);
    EXPECT_FALSE(occluders.occluded(at_rest.from, at_rest.to));
    EXPECT_TRUE(occluders.occluded(beside.from, beside.to));
    EXPECT_TRUE(occluders.occluded(beside.from, beside.to, Among::Moving));
    EXPECT_FALSE(occluders.occluded(beside.from, beside.to, Among::Resting));
}

TEST(Occluders, a_turned_body_blocks_as_its_turned_triangles_do) {
    const Quat turn = glm::angleAxis(0.7, glm::normalize(Vec3(1.0, 2.0, 0.5)));
    const geometry::Pose pose{turn, {0.2, -0.1, 0.1}};
    Body body = level_square(0.8, 0.05, true), copy = body;
    for (Vec3& x : copy.points) x = pose.point(x);
    copy.moves = false;
    Occluders moved({level_square(4.0, -2.0), body});
    const Occluders still({level_square(4.0, -2.0), copy});
    moved.set_poses(std::vector<geometry::Pose>{{}, pose});
    int differ = 0, blocked = 0;
    for (const Segment& s : random_segments(20000, 2.0, -1.0, 1.0, 17)) {
        const bool one = moved.occluded(s.from, s.to);
        differ += one != still.occluded(s.from, s.to) ? 1 : 0;
        blocked += one ? 1 : 0;
    }
    EXPECT_GT(blocked, 1000);
    EXPECT_LE(differ, 2); // rays within a float's rounding of the outline
}

TEST(Occluders, a_batch_gives_what_single_queries_give) {
    std::vector<Body> bodies{level_square(1.0, 0.0), level_square(0.4, 0.4, true), level_square(0.6, -0.5)};
    for (int i = 0; i < 60; ++i)
        bodies.push_back(
            parallelogram({0.1 * i - 3.0, -2.0, 0.7}, {0.05, 0.0, 0.02}, {0.01, 4.0, 0.0}, i % 7 == 0));
    Occluders occluders(bodies);
    std::vector<geometry::Pose> poses(bodies.size());
    poses[1] = shifted({0.3, 0.2, -0.1});
    occluders.set_poses(poses);
    const std::vector<Segment> segments = random_segments(5003, 3.0, -1.0, 1.0, 23);
    std::vector<std::uint8_t> blocked(segments.size());
    for (const Among among : {Among::All, Among::Resting, Among::Moving}) {
        occluders.occluded(segments, blocked, among);
        std::size_t some = 0;
        for (std::size_t i = 0; i < segments.size(); ++i) {
            EXPECT_EQ(blocked[i] != 0, occluders.occluded(segments[i].from, segments[i].to, among)) << i;
            some += blocked[i];
        }
        EXPECT_GT(some, 100u);
        EXPECT_LT(some, segments.size() - 100);
    }
}

TEST(Occluders, the_first_hit_is_the_nearest_face_with_its_front_normal) {
    Occluders occluders({level_square(1.0, 0.0), level_square(1.0, 0.5, true)});
    const auto hit = occluders.first_hit({0.3, 0.2, 2.0}, {0.0, 0.0, -2.0});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->body, 1u);
    EXPECT_NEAR(hit->distance, 0.75, 1e-12);
    EXPECT_NEAR(glm::distance(hit->position, Vec3(0.3, 0.2, 0.5)), 0.0, 1e-6);
    EXPECT_NEAR(hit->normal.z, 1.0, 1e-15);

    occluders.set_poses(std::vector<geometry::Pose>{{}, shifted({0.0, 0.0, -1.0})});
    const auto other = occluders.first_hit({0.3, 0.2, 2.0}, {0.0, 0.0, -1.0});
    ASSERT_TRUE(other);
    EXPECT_EQ(other->body, 0u);
    EXPECT_EQ(other->position.z, 0.0);
    const auto from_below = occluders.first_hit({0.3, 0.2, -2.0}, {0.0, 0.0, 1.0});
    ASSERT_TRUE(from_below);
    EXPECT_EQ(from_below->body, 1u);
    EXPECT_NEAR(from_below->position.z, -0.5, 1e-15);
    EXPECT_FALSE(occluders.first_hit({3.0, 0.2, 2.0}, {0.0, 0.0, -1.0}));
}

TEST(Occluders, scale_and_distance_from_the_origin_do_not_matter) {
    for (const double scale : {1e-6, 1.0, 1e6}) {
        const Vec3 far = Vec3(3e4, -7e4, 1e4) * scale;
        std::vector<Body> bodies{level_square(1.0, 0.0), level_square(4.0, -1.0, true)};
        for (Body& body : bodies)
            for (Vec3& x : body.points) x = scale * x + far;
        const Occluders occluders(bodies);
        for (const Segment& s : random_segments(2000, 3.0, -1.0, 1.0, 29)) {
            const Vec3 middle = 0.5 * (s.from + s.to);
            const double clearance = 1.0 - std::max(std::abs(middle.x), std::abs(middle.y));
            if (std::abs(clearance) > 1e-5) {
                EXPECT_EQ(occluders.occluded(scale * s.from + far, scale * s.to + far), clearance > 0.0);
            }
        }
    }
}

TEST(Occluders, a_scene_of_nothing_blocks_nothing) {
    Occluders none({});
    EXPECT_TRUE(none.empty());
    EXPECT_FALSE(none.occluded({0, 0, 0}, {1, 0, 0}));
    EXPECT_FALSE(none.first_hit({0, 0, 0}, {1, 0, 0}));
    Occluders hollow(std::vector<Body>(2));
    hollow.set_poses(std::vector<geometry::Pose>(2));
    std::vector<std::uint8_t> blocked(1, 1);
    hollow.occluded(std::vector<Segment>{{{0, 0, 0}, {1, 0, 0}}}, blocked);
    EXPECT_EQ(blocked[0], 0);
    EXPECT_FALSE(hollow.any_moving());
}

TEST(Occluders, broken_bodies_and_pose_counts_are_refused) {
    Body body = level_square(1.0, 0.0);
    body.triangles.push_back({0, 1, 9});
    EXPECT_THROW(Occluders({body}), core::GeometryError);
    body = level_square(1.0, 0.0);
    body.points[2].y = std::nan("");
    EXPECT_THROW(Occluders({body}), core::GeometryError);
    Occluders one({level_square(1.0, 0.0)});
    EXPECT_THROW(one.set_poses({}), core::GeometryError);
}

} // namespace
} // namespace kinelux::visibility
