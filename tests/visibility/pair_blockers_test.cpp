// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/pair_blockers.h"

#include <array>

#include <gtest/gtest.h>

#include "visibility/polygons.h"
#include "visibility/shapes.h"

namespace kinelux::visibility {
namespace {

using test::normal_of;
using test::Polygon;
using test::square;

constexpr std::size_t few = 4;

Body body_of(const std::vector<Polygon>& polygons) {
    Body body;
    for (const Polygon& polygon : polygons) {
        Outline& outline = body.outlines.emplace_back();
        const auto first = static_cast<std::uint32_t>(body.points.size());
        outline.first_triangle = static_cast<std::uint32_t>(body.triangles.size());
        outline.loops.emplace_back();
        for (std::uint32_t i = 0; i < polygon.size(); ++i) {
            body.points.push_back(polygon[i]);
            outline.loops[0].push_back(first + i);
            if (i >= 2) body.triangles.push_back({first, first + i - 1, first + i});
        }
        outline.triangle_count = static_cast<std::uint32_t>(body.triangles.size()) - outline.first_triangle;
    }
    return body;
}

/// The square of half width `outer` at z = 1 with a square hole at its middle.
Body frame(double outer, double inner) {
    Body body;
    for (const double half : {outer, inner})
        for (const Vec2& p : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)})
            body.points.push_back({half * p, 1.0});
    body.triangles = {{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    body.outlines = {{{{0, 1, 2, 3}, {7, 6, 5, 4}}, 0, 8}};
    return body;
}

ShaftEnd end_of(const Polygon& polygon) { return shaft_end(polygon, normal_of(polygon)); }

Sight sight(PairBlockers& pair, const Polygon& a, const Polygon& b, const Body& body) {
    return pair.between(end_of(a), end_of(b), PolygonBlockers(std::vector<Body>{body}), Among::All, few);
}

TEST(PairBlockers, sight_is_as_the_polygons_between_say) {
    const Polygon floor = square(1.0, 0.0), ceiling = test::reversed(square(1.0, 2.0));
    PairBlockers pair;
    EXPECT_EQ(sight(pair, floor, ceiling, body_of({floor, ceiling, square(1.0, 1.0, 2.1)})), Sight::Clear);
    EXPECT_EQ(sight(pair, floor, ceiling, body_of({square(0.9, 1.0)})), Sight::Few);
    ASSERT_EQ(pair.blockers().size(), 1u);
    EXPECT_TRUE(pair.blockers()[0].convex);
    EXPECT_EQ(sight(pair, floor, ceiling, body_of({square(1.0, 1.0)})), Sight::Hidden);
    EXPECT_EQ(sight(pair, ceiling, floor, body_of({test::reversed(square(1.0, 1.0))})), Sight::Hidden);
    std::vector<Polygon> specks;
    specks.reserve(10);
    for (int i = 0; i < 9; ++i) specks.push_back(square(0.05, 1.0, 0.2 * i - 0.8));
    EXPECT_EQ(sight(pair, floor, ceiling, body_of(specks)), Sight::Many);
    specks.push_back(square(3.0, 1.0)); // one large polygon among many small ones hides all
    EXPECT_EQ(sight(pair, floor, ceiling, body_of(specks)), Sight::Hidden);
}

TEST(PairBlockers, light_passes_a_frame_and_not_the_wall_beside_its_window) {
    PairBlockers pair;
    const auto between = [&](double half, double x) {
        return sight(pair, square(half, 0.0, x), test::reversed(square(half, 2.0, x)), frame(3.0, 1.0));
    };
    EXPECT_EQ(between(1.0, 0.0), Sight::Clear);
    EXPECT_EQ(between(0.5, 2.0), Sight::Hidden);
    EXPECT_EQ(between(1.5, 0.0), Sight::Few);
    EXPECT_FALSE(pair.blockers()[0].convex);
    EXPECT_EQ(between(0.5, 1.0), Sight::Few); // of the frame, only one convex part is near
    EXPECT_TRUE(pair.blockers()[0].convex);
}

TEST(PairBlockers, a_wall_that_stands_on_one_element_hides_what_is_behind_it) {
    // A wall on the floor's right edge; the ceiling behind the wall sees the floor through it only.
    const Polygon floor = square(1.0, 0.0), ceiling = test::reversed(square(1.0, 2.0, 3.0));
    const Polygon wall = test::rectangle({1.0, -4.0, 0.0}, {0.0, 8.0, 0.0}, {0.0, 0.0, 3.0});
    PairBlockers pair;
    for (const test::Similarity& move : test::similarities()) {
        EXPECT_EQ(sight(pair, move(floor), move(ceiling), body_of({move(wall)})), Sight::Hidden);
        const Polygon low = test::rectangle({1.0, -4.0, 0.0}, {0.0, 8.0, 0.0}, {0.0, 0.0, 0.5});
        EXPECT_EQ(sight(pair, move(floor), move(ceiling), body_of({move(low)})), Sight::Few);
        EXPECT_EQ(sight(pair, move(floor), test::reversed(move(square(1.0, 2.0))), body_of({move(wall)})),
                  Sight::Clear);
    }
}

TEST(PairBlockers, clear_and_hidden_pairs_are_so_for_rays) {
    core::Random random(77);
    std::array<int, 4> seen{};
    for (int scene = 0; scene < 40; ++scene) {
        std::vector<Polygon> polygons;
        polygons.reserve(6);
        for (int i = 0; i < 6; ++i)
            polygons.push_back(test::random_polygon(random, 0.1 + 0.9 * random.next()));
        const Body body = body_of(polygons);
        const Occluders occluders({body});
        PairBlockers pair;
        for (int p = 0; p < 50; ++p) {
            const Polygon a = test::random_polygon(random, 0.15), b = test::random_polygon(random, 0.15);
            const bool boxes = p % 3 == 0;
            const ShaftEnd end_a = end_of(a), end_b = end_of(b);
            const Sight found = pair.between(boxes ? shaft_end(end_a.box_low, end_a.box_high) : end_a,
                                             boxes ? shaft_end(end_b.box_low, end_b.box_high) : end_b,
                                             occluders.polygons(), Among::All, few);
            ++seen[static_cast<std::size_t>(found)];
            if (found != Sight::Clear && found != Sight::Hidden) continue;
            for (int ray = 0; ray < 30; ++ray) {
                const Vec3 x = test::point_in(a, random), y = test::point_in(b, random);
                if (glm::dot(normal_of(a), y - x) < 1e-3 || glm::dot(normal_of(b), x - y) < 1e-3) continue;
                EXPECT_EQ(occluders.occluded(x, y), found == Sight::Hidden);
            }
        }
    }
    for (const Sight sight : {Sight::Clear, Sight::Hidden, Sight::Few})
        EXPECT_GT(seen[static_cast<std::size_t>(sight)], 20) << static_cast<int>(sight);
}

} // namespace
} // namespace kinelux::visibility
