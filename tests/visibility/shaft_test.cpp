// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/shaft.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "visibility/polygons.h"

namespace kinelux::visibility {
namespace {

using test::normal_of;
using test::point_in;
using test::Polygon;
using test::rectangle;
using test::square;

ShaftEnd end_of(const Polygon& polygon) { return shaft_end(polygon, normal_of(polygon)); }

Shaft shaft_between(const Polygon& a, const Polygon& b) { return {end_of(a), end_of(b)}; }

bool misses(const Shaft& shaft, const Polygon& polygon) {
    const Vec3 normal = normal_of(polygon);
    return shaft.misses(polygon, {normal, glm::dot(normal, polygon[0])});
}

bool misses_box_of(const Shaft& shaft, const Polygon& polygon) {
    const ShaftEnd end = end_of(polygon);
    return shaft.misses(end.box_low, end.box_high);
}

/// A small triangle about a point, in a random plane.
Polygon speck(const Vec3& at, core::Random& random, double size) {
    Polygon polygon;
    for (int i = 0; i < 3; ++i)
        polygon.push_back(at + size * (Vec3(random.next(), random.next(), random.next()) - 0.5));
    return polygon;
}

TEST(Separation, is_a_lower_bound_of_the_distance_and_sharp_across_gaps) {
    core::Random random(7);
    for (int n = 0; n < 200; ++n) {
        const Polygon a = speck(Vec3(0.0), random, 1.0);
        const Polygon b = speck(Vec3(2.0 * random.next(), random.next(), random.next()), random, 1.0);
        double nearest = 1e9;
        for (int k = 0; k < 300; ++k)
            nearest = std::min(nearest, glm::distance(point_in(a, random), point_in(b, random)));
        EXPECT_LE(separation(end_of(a), end_of(b)), nearest);
        EXPECT_NEAR(separation(end_of(a), end_of(b)), separation(end_of(b), end_of(a)), 1e-14);
    }
    for (const double gap : {1e-6, 0.1, 3.0}) {
        const glm::dquat turn = glm::angleAxis(0.7, glm::normalize(Vec3(1, 2, 3)));
        Polygon below, above;
        for (const Vec3& at : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}) {
            below.push_back(turn * at);
            above.push_back(turn * (at + Vec3(0.3, 0.2, gap)));
        }
        EXPECT_NEAR(separation(end_of(below), end_of(above)), gap, 1e-12);
    }
}

TEST(Shaft, nothing_that_crosses_a_segment_between_two_fronts_is_missed) {
    core::Random random(5);
    int segments = 0;
    for (int pair = 0; pair < 2000; ++pair) {
        const Polygon a = test::random_polygon(random, 0.5), b = test::random_polygon(random, 0.5);
        const Shaft shaft = shaft_between(a, b);
        const ShaftEnd end_a = end_of(a), end_b = end_of(b);
        const Shaft boxes(shaft_end(end_a.box_low, end_a.box_high), shaft_end(end_b.box_low, end_b.box_high));
        const Shaft mixed(end_a, shaft_end(end_b.box_low, end_b.box_high));
        for (int i = 0; i < 20; ++i) {
            const Vec3 x = point_in(a, random), y = point_in(b, random);
            const bool in_front = glm::dot(normal_of(a), y - x) > 1e-6;
            const Vec3 at = x + (0.01 + 0.98 * random.next()) * (y - x);
            const Polygon there = speck(at, random, 1e-3);
            EXPECT_FALSE(boxes.misses(at - 1e-4, at + 1e-4));
            if (in_front) {
                EXPECT_FALSE(mixed.misses(at - 1e-4, at + 1e-4));
            }
            if (!in_front || glm::dot(normal_of(b), x - y) < 1e-6) continue;
            ++segments;
            EXPECT_FALSE(shaft.empty());
            EXPECT_FALSE(shaft.misses(at - 1e-4, at + 1e-4));
            EXPECT_FALSE(misses_box_of(shaft, there));
            for (const HalfSpace& half_space : shaft.half_spaces())
                EXPECT_GE(half_space.distance(at), -shaft.touching());
        }
    }
    EXPECT_GT(segments, 5000);
}

TEST(Shaft, between_facing_squares_is_the_prism_of_their_hull) {
    const Shaft shaft = shaft_between(square(1.0, 0.0), test::reversed(square(0.5, 2.0)));
    EXPECT_EQ(shaft.half_spaces().size(), 10u); // each of the four sides twice
    core::Random random(9);
    for (int i = 0; i < 20000; ++i) {
        const Vec3 at(2.4 * random.next() - 1.2, 2.4 * random.next() - 1.2, 2.4 * random.next() - 0.2);
        const double side = 1.0 - 0.25 * at.z - std::max(std::abs(at.x), std::abs(at.y));
        const double depth = std::min({side, at.z, 2.0 - at.z});
        if (std::abs(depth) > 2e-3) {
            EXPECT_EQ(shaft.misses(at - 1e-3, at + 1e-3), depth < 0.0);
        }
    }
}

TEST(Shaft, ends_that_face_away_leave_nothing_between) {
    EXPECT_TRUE(shaft_between(square(1.0, 0.0), square(1.0, 2.0)).empty());
    EXPECT_TRUE(shaft_between(test::reversed(square(1.0, 0.0)), test::reversed(square(1.0, 2.0))).empty());
    EXPECT_TRUE(shaft_between(square(1.0, 0.0), square(1.0, 0.0, 5.0)).empty());
    EXPECT_TRUE(shaft_between(square(1.0, 0.0), square(1.0, 2.0)).misses(Vec3(-1.0), Vec3(3.0)));
}

TEST(Shaft, only_the_parts_in_front_of_each_other_count) {
    // The wall goes down to -3 below the floor; what is below the floor is not between.
    const Polygon floor = square(1.0, 0.0);
    const Polygon wall = rectangle({2.0, 1.0, -3.0}, {0.0, -2.0, 0.0}, {0.0, 0.0, 6.0});
    ASSERT_LT(normal_of(wall).x, -0.9);
    const Shaft shaft = shaft_between(floor, wall);
    EXPECT_FALSE(shaft.empty());
    EXPECT_TRUE(shaft.misses({1.2, -0.5, -1.0}, {1.8, 0.5, -0.1}));
    EXPECT_FALSE(shaft.misses({1.2, -0.5, -1.0}, {1.8, 0.5, 0.1}));
    EXPECT_TRUE(shaft.misses({2.0, -0.5, 0.5}, {2.5, 0.5, 1.0}));
}

TEST(Shaft, what_only_touches_is_missed_wherever_and_however_large) {
    const Polygon floor = square(1.0, 0.0), ceiling = test::reversed(square(1.0, 2.0));
    const std::vector<std::tuple<const char*, Polygon, bool>> others{
        {"the floor's own plane", square(5.0, 0.0), true},
        {"a tile beside", square(1.0, 0.0, 2.0), true},
        {"under the floor", square(1.0, -0.1), true},
        {"a wall on the floor's edge", rectangle({1.0, -5.0, -3.0}, {0.0, 10.0, 0.0}, {0.0, 0.0, 9.0}), true},
        {"a wall behind it", rectangle({1.3, -5.0, -3.0}, {0.0, 10.0, 0.0}, {0.0, 0.0, 9.0}), true},
        {"a leaning neighbour", rectangle({1.0, -1.0, 0.0}, {0.0, 2.0, 0.0}, {0.5, 0.0, 2.0}), true},
        {"a wall on a corner", rectangle({1.0, 1.0, 0.0}, {1.0, -1.0, 0.0}, {0.0, 0.0, 2.0}), true},
        {"a wide wall past a corner", rectangle({4.0, -2.0, 0.0}, {-6.0, 6.0, 0.0}, {0.0, 0.0, 2.0}), true},
        {"a wide wall across a corner", rectangle({3.9, -2.0, 0.0}, {-6.0, 6.0, 0.0}, {0.0, 0.0, 2.0}),
         false},
        {"a shelf", square(0.3, 1.0), false},
        {"a wall across", rectangle({0.2, -5.0, 0.0}, {0.0, 10.0, 0.0}, {0.0, 0.0, 2.0}), false},
        {"a leaning wall from the edge", rectangle({1.0, -1.0, 0.0}, {0.0, 2.0, 0.0}, {-0.5, 0.0, 2.0}),
         false}};
    for (const test::Similarity& move : test::similarities()) {
        const Shaft shaft = shaft_between(move(floor), move(ceiling));
        for (const auto& [name, polygon, missed] : others)
            EXPECT_EQ(misses(shaft, move(polygon)), missed) << name << ", scale " << move.scale;
    }
}

TEST(Shaft, what_only_touches_a_shaft_of_boxes_is_missed_far_from_the_origin) {
    const Vec3 far(1e4 / 3.0, -1e4 / 7.0, 1e4 / 11.0);
    const auto box = [&](const Vec3& low) { return shaft_end(low + far, low + Vec3(0.3) + far); };
    const Shaft shaft(box(Vec3(0.0)), box({0.0, 0.0, 1.1}));
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 low(0.0), high(0.3, 0.3, 1.4);
        low[axis] = high[axis];
        high[axis] += 0.1;
        EXPECT_TRUE(shaft.misses(low + far, high + far)) << axis;
        low[axis] -= 1e-6;
        EXPECT_FALSE(shaft.misses(low + far, high + far)) << axis;
    }
}

TEST(Shaft, many_cornered_and_hollow_outlines_are_held_by_their_ends) {
    core::Random random(3);
    Polygon star;
    for (int i = 0; i < 60; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 60.0, radius = i % 2 == 0 ? 1.0 : 0.4;
        star.push_back({radius * std::cos(angle), radius * std::sin(angle), 1.0});
    }
    const ShaftEnd end = shaft_end(star, {0.0, 0.0, 1.0});
    ASSERT_LE(end.count, ShaftEnd::most_points);
    for (std::size_t i = 0; i < end.count; ++i) {
        const Vec3 edge = end.points[(i + 1) % end.count] - end.points[i];
        for (const Vec3& p : star) EXPECT_GE(glm::cross(edge, p - end.points[i]).z, -1e-12);
    }
}

TEST(Shaft, the_order_of_points_in_a_plane_does_not_matter) {
    core::Random random(6);
    for (int i = 0; i < 300; ++i) {
        const Polygon polygon = test::random_polygon(random, 0.5);
        const ShaftEnd outline = end_of(polygon);
        Polygon shuffled = polygon;
        shuffled.push_back(point_in(polygon, random));
        for (std::size_t k = shuffled.size() - 1; k > 0; --k)
            std::swap(shuffled[k],
                      shuffled[static_cast<std::size_t>(random.next() * static_cast<double>(k + 1))]);
        const ShaftEnd hull = shaft_end(shuffled, normal_of(polygon));
        ASSERT_EQ(hull.count, outline.count);
        for (std::size_t k = 0; k < hull.count; ++k)
            EXPECT_TRUE(std::any_of(polygon.begin(), polygon.end(),
                                    [&](const Vec3& p) { return glm::distance(p, hull.points[k]) < 1e-12; }));
        EXPECT_EQ(hull.box_low, outline.box_low);
    }
}

TEST(Shaft, an_element_off_its_plane_is_a_box) {
    geometry::ElementShape element;
    element.planar = false;
    element.box_low = Vec3(-1.0);
    element.box_high = Vec3(1.0, 2.0, 3.0);
    const ShaftEnd end = shaft_end(element);
    EXPECT_FALSE(end.planar());
    EXPECT_EQ(end.box_high, Vec3(1.0, 2.0, 3.0));
}

TEST(Shaft, a_planar_element_is_the_hull_of_its_outline) {
    geometry::ElementShape element;
    element.facets.resize(1);
    element.facets[0].normal = {0.0, 0.0, 1.0};
    element.outline = {square(1.0, 0.5), test::reversed(square(0.5, 0.5))};
    EXPECT_EQ(shaft_end(element).count, 4u);
    EXPECT_EQ(shaft_end(element).box_low, Vec3(-1.0, -1.0, 0.5));
    element.outline = {square(1.0, 0.5, -1.0), square(1.0, 0.5, 3.0)};
    EXPECT_EQ(shaft_end(element).box_high, Vec3(4.0, 1.0, 0.5));
    EXPECT_EQ(shaft_end(element).count, 4u);
}

} // namespace
} // namespace kinelux::visibility
