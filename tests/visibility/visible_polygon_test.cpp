// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/visible_polygon.h"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "visibility/polygons.h"

namespace kinelux::visibility {
namespace {

using test::normal_of;
using test::Polygon;
using test::square;

const Vec3 up(0.0, 0.0, 1.0);

PlanarBlocker blocker_of(const Polygon& polygon) {
    PlanarBlocker blocker;
    blocker.loops.add(polygon);
    blocker.plane.normal = normal_of(polygon);
    blocker.plane.offset = glm::dot(blocker.plane.normal, polygon[0]);
    return blocker;
}

/// A ring between two convex polygons of one plane whose corners correspond.
PlanarBlocker ring(const Polygon& outer, const Polygon& inner) {
    PlanarBlocker blocker = blocker_of(outer);
    blocker.convex = false;
    blocker.loops.add(test::reversed(inner));
    for (std::size_t i = 0; i < outer.size(); ++i) {
        const std::size_t j = (i + 1) % outer.size();
        blocker.pieces.add(Polygon{outer[i], outer[j], inner[j], inner[i]});
    }
    return blocker;
}

Loops3 loops_of(const Polygon& polygon) {
    Loops3 loops;
    loops.add(polygon);
    return loops;
}

double area(const Loops3& loops, const Vec3& normal) {
    double sum = 0.0;
    for (std::size_t l = 0; l < loops.size(); ++l) sum += 0.5 * glm::dot(normal, twice_vector_area(loops[l]));
    return sum;
}

double visible_area(const Vec3& x, const Polygon& target, const std::vector<PlanarBlocker>& blockers) {
    VisiblePolygon visible;
    const Vec3 normal = normal_of(target);
    return area(visible.from(x, loops_of(target), normal, blockers), normal);
}

// The target is the square of area 4 at z = 0, seen from (0, 0, 2); a blocker at z = 1 hides four times its area.
struct Seen {
    const char* name;
    std::vector<PlanarBlocker> blockers;
    double area;
};

std::vector<Seen> closed_forms() {
    const auto at = [](double half, double x, double y) { return blocker_of(square(half, 1.0, x, y)); };
    const Polygon sheet = test::rectangle({0.0, -3.0, 0.5}, {0.0, 6.0, 0.0}, {0.0, 0.0, 1.0});
    return {
        {"nothing", {}, 4.0},
        {"one inside", {at(0.25, 0.0, 0.0)}, 3.0},
        {"one from behind", {blocker_of(test::reversed(square(0.25, 1.0)))}, 3.0},
        {"one over an edge", {at(0.25, 0.5, 0.0)}, 3.5},
        {"one over a corner", {at(0.25, 0.5, 0.5)}, 3.75},
        {"one that ends on an edge", {at(0.25, 0.75, 0.0)}, 4.0},
        {"one beside", {at(0.25, 1.0, 0.0)}, 4.0},
        {"all", {at(0.5, 0.0, 0.0)}, 0.0},
        {"more than all", {at(5.0, 1.0, 2.0)}, 0.0},
        {"one twice", {at(0.25, 0.0, 0.0), at(0.25, 0.0, 0.0)}, 3.0},
        {"one in another", {at(0.25, 0.0, 0.0), at(0.1, 0.1, 0.0), at(0.4, 0.0, 0.0)}, 4.0 - 2.56},
        {"two apart", {at(0.1, 0.2, 0.0), at(0.1, -0.2, 0.0)}, 4.0 - 0.32},
        {"two that share an edge", {at(0.25, 0.25, 0.0), at(0.25, -0.25, 0.0)}, 2.0},
        {"two that overlap", {at(0.25, 0.1, 0.0), at(0.25, -0.1, 0.0)}, 4.0 - 4.0 * 0.7 * 0.5},
        {"three that overlap",
         {at(0.2, 0.1, 0.0), at(0.2, -0.1, 0.0), at(0.2, 0.0, 0.1)},
         4.0 - 4.0 * (0.6 * 0.4 + 0.4 * 0.1)},
        {"four quarters",
         {at(0.25, 0.25, 0.25), at(0.25, -0.25, 0.25), at(0.25, 0.25, -0.25), at(0.25, -0.25, -0.25)},
         0.0},
        {"a sheet edge-on", {blocker_of(sheet)}, 4.0},
        {"one in the target's plane", {blocker_of(square(0.5, 0.0))}, 4.0},
        {"one behind the target", {blocker_of(square(0.5, -0.5))}, 4.0},
        {"one behind the eye", {blocker_of(square(0.5, 2.5))}, 4.0},
        {"one through the eye's level",
         {blocker_of(test::rectangle({0.5, -9, -1}, {0, 18, 0}, {0, 0, 9}))},
         4.0 - 1.0},
        {"one that stands on the target",
         {blocker_of(test::rectangle({0.5, -9, 0}, {0, 18, 0}, {0, 0, 1}))},
         4.0 - 1.0},
        {"a slope through the target",
         {blocker_of(test::rectangle({-0.25, -9, -0.5}, {0, 18, 0}, {0.75, 0, 1.5}))},
         2.0 * (2.0 - 1.0)},
        {"a ring", {ring(square(0.4, 1.0), square(0.2, 1.0))}, 4.0 - 4.0 * (0.64 - 0.16)},
        {"a ring around all", {ring(square(2.0, 1.0), square(0.3, 1.0))}, 4.0 * 0.36},
        {"a window that shows all", {ring(square(2.0, 1.0), square(0.5, 1.0))}, 4.0},
        {"two rings",
         {ring(square(2.0, 1.0), square(0.3, 1.0)), ring(square(2.0, 1.0, 0.1), square(0.3, 1.0, 0.1))},
         4.0 * 0.6 * 0.5},
        {"a shutter in a window",
         {at(0.2, 0.2, 0.0), ring(square(2.0, 1.0), square(0.3, 1.0))},
         4.0 * (0.36 - 0.3 * 0.4)},
    };
}

TEST(VisiblePolygon, areas_are_those_of_closed_forms_wherever_and_however_large) {
    const Polygon target = square(1.0, 0.0);
    const Vec3 eye(0.0, 0.0, 2.0);
    std::vector<test::Similarity> moves = test::similarities();
    moves.push_back({});
    for (const test::Similarity& move : moves)
        for (const Seen& seen : closed_forms()) {
            std::vector<PlanarBlocker> moved = seen.blockers;
            for (PlanarBlocker& blocker : moved) {
                for (Vec3& p : blocker.loops.points) p = move(p);
                for (Vec3& p : blocker.pieces.points) p = move(p);
                blocker.plane.normal = move.pose.direction(blocker.plane.normal);
                blocker.plane.offset = glm::dot(blocker.plane.normal, blocker.loops.points[0]);
            }
            const double unit = move.scale * move.scale;
            EXPECT_NEAR(visible_area(move(eye), move(target), moved), seen.area * unit, 1e-9 * unit)
                << seen.name << ", scale " << move.scale;
        }
}

TEST(VisiblePolygon, targets_with_holes_and_notches_are_seen_past_everything) {
    // An L of area 3 and the frame of area 3; the eye is above the middle.
    const Polygon ell{{-1, -1, 0}, {1, -1, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}};
    Loops3 frame = loops_of(square(1.0, 0.0));
    frame.add(test::reversed(square(0.5, 0.0)));
    const Vec3 eye(0.0, 0.0, 2.0);
    VisiblePolygon visible;
    const PlanarBlocker half = blocker_of(test::rectangle({0.0, -2.0, 1.0}, {2, 0, 0}, {0, 4, 0}));
    const PlanarBlocker hoop = ring(square(2.0, 1.0), square(0.25, 1.0));
    EXPECT_NEAR(area(visible.from(eye, loops_of(ell), up, std::span(&half, 1)), up), 2.0, 1e-14);
    EXPECT_NEAR(area(visible.from(eye, frame, up, std::span(&half, 1)), up), 1.5, 1e-14);
    EXPECT_NEAR(area(visible.from(eye, loops_of(ell), up, std::span(&hoop, 1)), up), 0.75, 1e-14);
    EXPECT_TRUE(visible.from(eye, frame, up, std::span(&hoop, 1)).empty());
    const std::vector<PlanarBlocker> both{half, hoop};
    EXPECT_NEAR(area(visible.from(eye, loops_of(ell), up, both), up), 0.5, 1e-14);
}

TEST(VisiblePolygon, what_nothing_hides_is_the_target_itself) {
    const Loops3 target = loops_of(square(1.0, 0.0));
    const PlanarBlocker beside = blocker_of(square(0.25, 1.0, 3.0));
    VisiblePolygon visible;
    EXPECT_EQ(&visible.from({0, 0, 2}, target, up, std::span(&beside, 1)), &target);
    EXPECT_TRUE(visible.from({0, 0, -2}, target, up, {}).empty());
    EXPECT_TRUE(visible.from({0, 0, 0}, target, up, {}).empty());
    EXPECT_TRUE(visible.from({0, 0, 1}, {}, up, {}).empty());
}

TEST(VisiblePolygon, a_wall_close_to_the_eye_hides_its_exact_share) {
    // The eye is at a small distance d over the floor and before a wall of height 4 d, over whose top it sees at slope 3.
    const Polygon lamp = test::reversed(square(1.0, 2.0));
    for (const double d : {1e-1, 1e-4, 1e-7}) {
        const Polygon wall = test::rectangle({0.0, -9.0, 0.0}, {0.0, 18.0, 0.0}, {0.0, 0.0, 4.0 * d});
        EXPECT_NEAR(visible_area({-d, 0.0, d}, lamp, {blocker_of(wall)}), 2.0 * (1.0 - d + (2.0 - d) / 3.0),
                    1e-14 / d); // rounding of the wall's width, seen from d
    }
}

/// A convex polygon, with a smaller copy of itself as a hole where `hollow`.
struct Screen {
    Polygon outer;
    bool hollow = false;

    Polygon inner() const {
        const Vec3 centre = (outer[0] + outer[1] + outer[2]) / 3.0;
        Polygon polygon = outer;
        for (Vec3& p : polygon) p = 0.5 * (p + centre);
        return polygon;
    }
    PlanarBlocker blocker() const { return hollow ? ring(outer, inner()) : blocker_of(outer); }
};

bool crosses(const Polygon& polygon, const Vec3& x, const Vec3& y) {
    const Vec3 normal = normal_of(polygon);
    const double hx = glm::dot(normal, x - polygon[0]), hy = glm::dot(normal, y - polygon[0]);
    if (hx * hy >= 0.0) return false;
    const Vec3 p = x + hx / (hx - hy) * (y - x);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 edge = polygon[(i + 1) % polygon.size()] - polygon[i];
        if (glm::dot(normal, glm::cross(edge, p - polygon[i])) < 0.0) return false;
    }
    return true;
}

bool crosses(const Screen& screen, const Vec3& x, const Vec3& y) {
    return crosses(screen.outer, x, y) && !(screen.hollow && crosses(screen.inner(), x, y));
}

double sampled_share(const Vec3& x, const Polygon& target, const std::vector<Screen>& screens, int samples,
                     std::uint64_t seed) {
    int free = 0;
    for (int i = 0; i < samples; ++i) {
        const Vec2 s = core::sobol_2d(static_cast<std::uint32_t>(i), seed);
        const Vec3 y = target[0] + s.x * (target[1] - target[0]) + s.y * (target[3] - target[0]);
        free += std::none_of(screens.begin(), screens.end(),
                             [&](const Screen& screen) { return crosses(screen, x, y); })
                    ? 1
                    : 0;
    }
    return free / static_cast<double>(samples);
}

TEST(VisiblePolygon, random_blockers_leave_what_samples_see) {
    constexpr int samples = 100000;
    core::Random random(2024);
    int partial = 0;
    for (int scene = 0; scene < 60; ++scene) {
        const Polygon target = test::rectangle({-1, -1, -1}, {2.0, 0.3, 0.0}, {-0.3, 2.0, 0.4});
        const Vec3 x(random.next() - 0.5, random.next() - 0.5, 1.0 + random.next());
        std::vector<Screen> screens;
        std::vector<PlanarBlocker> blockers;
        for (int b = 0; b < 1 + scene % 6; ++b) {
            screens.push_back(
                {test::random_polygon(random, 0.2 + 0.6 * random.next()), (scene + b) % 3 == 0});
            blockers.push_back(screens.back().blocker());
        }
        const double whole = glm::length(glm::cross(target[1] - target[0], target[3] - target[0]));
        const double share = visible_area(x, target, blockers) / whole;
        const double deviation = std::sqrt(std::max(share * (1.0 - share), 1e-5) / samples);
        EXPECT_NEAR(share, sampled_share(x, target, screens, samples, 11), 4.0 * deviation) << scene;
        partial += share > 0.01 && share < 0.99 ? 1 : 0;
    }
    EXPECT_GT(partial, 30);
}

TEST(VisiblePolygon, the_order_of_blockers_changes_nothing) {
    core::Random random(800);
    const Polygon target = test::rectangle({-1, -1, -1}, {2.0, 0.3, 0.0}, {-0.3, 2.0, 0.4});
    for (int scene = 0; scene < 20000; ++scene) {
        const Vec3 x(random.next() - 0.5, random.next() - 0.5, 1.0 + random.next());
        std::vector<PlanarBlocker> blockers;
        for (int b = 0; b < 8; ++b)
            blockers.push_back(blocker_of(test::random_polygon(random, 0.2 + 0.6 * random.next())));
        const double area = visible_area(x, target, blockers);
        std::reverse(blockers.begin(), blockers.end());
        EXPECT_NEAR(visible_area(x, target, blockers), area, 1e-10) << scene;
    }
}

TEST(VisiblePolygon, slivers_copies_and_shared_sides_leave_exact_areas) {
    // Rectangles on a grid of quarters at half height: the covered cells can be counted.
    core::Random random(31);
    const Polygon target = square(1.0, 0.0);
    for (int scene = 0; scene < 2000; ++scene) {
        std::vector<PlanarBlocker> blockers;
        std::array<bool, 64> covered{};
        for (int b = 0; b < 6; ++b) {
            const auto column = static_cast<int>(8.0 * random.next()),
                       row = static_cast<int>(8.0 * random.next());
            const auto width = static_cast<int>(4.0 * random.next()),
                       depth = 1 + static_cast<int>(3.0 * random.next());
            const double sliver = width == 0 ? 1e-9 * random.next() : 0.0; // too thin to cover a cell
            blockers.push_back(
                blocker_of(test::rectangle({0.125 * column - 0.5, 0.125 * row - 0.5, 1.0},
                                           {0.125 * width + sliver, 0, 0}, {0, 0.125 * depth, 0})));
            for (int i = column; i < std::min(8, column + width); ++i)
                for (int j = row; j < std::min(8, row + depth); ++j)
                    covered[static_cast<std::size_t>(8 * i + j)] = true;
        }
        const auto free = std::count(covered.begin(), covered.end(), false);
        EXPECT_NEAR(visible_area({0.0, 0.0, 2.0}, target, blockers), static_cast<double>(free) / 16.0, 1e-7)
            << scene;
    }
}

TEST(CoversAll, only_what_fills_the_whole_shaft) {
    const Polygon floor = square(1.0, 0.0), ceiling = test::reversed(square(0.5, 2.0));
    const Shaft shaft(shaft_end(floor, normal_of(floor)), shaft_end(ceiling, normal_of(ceiling)));
    EXPECT_TRUE(covers_all(blocker_of(square(0.75, 1.0)), shaft));
    EXPECT_FALSE(covers_all(blocker_of(square(0.749, 1.0)), shaft));
    EXPECT_FALSE(covers_all(blocker_of(square(5.0, -0.1)), shaft));
    EXPECT_FALSE(covers_all(blocker_of(test::rectangle({0, -9, -9}, {0, 18, 0}, {0, 0, 18})), shaft));
    EXPECT_FALSE(covers_all(ring(square(3.0, 1.0), square(0.01, 1.0)), shaft));
    EXPECT_TRUE(covers_all(blocker_of(test::rectangle({-9, -9, 0.1}, {18, 0, 1.0}, {0, 18, 0})), shaft));
}

} // namespace
} // namespace kinelux::visibility
