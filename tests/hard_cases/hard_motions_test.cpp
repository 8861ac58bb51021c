// SPDX-License-Identifier: GPL-3.0-or-later
// Motions that are hard: bodies that nearly touch walls, touch them and pass through them, a lamp that enters a closed
// box, a lamp that is switched off on its way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "support/moving_rooms.h"

namespace kinelux {
namespace {

using support::MovingRoom;
using support::Played;
using support::PreparedRoom;

/// Everything shines alike, lamps on their backs too, so that the radiosity of a closed room is the same everywhere,
/// whatever moves in it.
MovingRoom furnace(MovingRoom room) {
    for (std::size_t p = 0, n = room.set.patches.size(); p < n; ++p) {
        const model::Patch& front = room.set.patches[p];
        if (front.material != MaterialId(1)) continue;
        const auto edge = [&](const Vec2& to) {
            return to.x * front.surface.axis_u + to.y * front.surface.axis_v;
        };
        room.set.patches.push_back(support::rectangle(front.surface.origin, edge(front.points[3]),
                                                      edge(front.points[1]), front.object, front.material));
    }
    for (model::Material& material : room.scene.materials) {
        material.reflectance = {0.5};
        material.exitance = {1.0};
    }
    return room;
}
constexpr double furnace_radiosity = 2.0;

/// The largest of the relative differences of an element's radiosity from the furnace's, over all frames.
double largest_furnace_error(const PreparedRoom& room, const Played& played) {
    double largest = 0.0;
    for (const auto& light : played.light)
        for (std::size_t e = 0; e < room.shapes.size(); ++e) {
            const double expected = furnace_radiosity * std::sqrt(room.areas[e]);
            double off = 0.0;
            for (std::size_t u = room.coefficients.layout.offsets[e];
                 u < room.coefficients.layout.offsets[e + 1]; ++u) {
                const double d = light[u] - (u == room.coefficients.layout.offsets[e] ? expected : 0.0);
                off += d * d;
            }
            largest = std::max(largest, std::sqrt(off) / expected);
        }
    return largest;
}

/// A panel that slides along the floor.
MovingRoom along_the_floor(double height_m) {
    MovingRoom room = support::sliding_lamp(9);
    const ObjectId panel = room.body("panel");
    room.panel(panel, Vec3(0.15, 0.6, height_m), Vec3(0.6, 0, 0), Vec3(0, 0.7, 0));
    room.slide(panel, Vec3(1.0, 0.2, 0.0));
    return room;
}

/// A shelf, and a panel that slides somewhere through it.
MovingRoom with_a_shelf(double shelf_length, const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v,
                        const Vec3& by) {
    MovingRoom room = support::sliding_lamp(9);
    const ObjectId shelf = room.body("shelf"), panel = room.body("panel");
    room.panel(shelf, Vec3(0.3, 0.3, 0.8), Vec3(shelf_length, 0, 0), Vec3(0, 1.4, 0));
    room.panel(panel, corner, edge_u, edge_v);
    room.slide(panel, by);
    return room;
}

/// A panel that sinks from above a shelf to below it, a micrometre above it at the middle frame.
MovingRoom through_a_shelf() {
    return with_a_shelf(1.4, {0.7, 0.6, 1.2}, {0.6, 0, 0}, {0, 0.7, 0}, {0.0, 0.0, -0.8 + 2e-6});
}

/// A panel on edge that cuts through a shelf as it slides.
MovingRoom across_a_shelf() {
    return with_a_shelf(0.7, {1.6, 0.6, 0.4}, {0, 0.7, 0}, {0, 0, 0.9}, {-1.3, 0.0, 0.0});
}

/// A small lamp under a shutter in two leaves, which are one body, so that no single polygon hides it: dark for half of the
/// frames, then uncovered within two of them.
MovingRoom behind_a_shutter() {
    MovingRoom room(36);
    const ObjectId lamp = room.body("lamp"), shutter = room.body("shutter");
    room.side(lamp, Vec3(0.95, 0.95, 1.7), Vec3(0, 0.1, 0), Vec3(0.1, 0, 0), true);
    room.panel(shutter, Vec3(0.0, 0.2, 1.69), Vec3(1.6, 0, 0), Vec3(0, 0.8, 0));
    room.panel(shutter, Vec3(0.0, 1.0, 1.69), Vec3(1.6, 0, 0), Vec3(0, 0.8, 0));
    room.slide(shutter, Vec3(-1.4, 0.0, 0.0));
    return room;
}

/// A lamp that passes through a side of a box without openings.
MovingRoom into_a_box(std::uint32_t frames) {
    MovingRoom room(frames);
    const ObjectId lamp = room.body("lamp"), box = room.body("box");
    room.side(lamp, Vec3(0.1, 0.9, 0.9), Vec3(0, 0.2, 0), Vec3(0.2, 0, 0), true);
    const Vec3 low(0.8, 0.6, 0.5), x(0.8, 0, 0), y(0, 0.8, 0), z(0, 0, 0.8);
    room.panel(box, low, x, y);
    room.panel(box, low + z, x, y);
    room.panel(box, low, y, z);
    room.panel(box, low + x, y, z);
    room.panel(box, low, z, x);
    room.panel(box, low + y, z, x);
    room.slide(lamp, Vec3(1.0, 0.0, 0.0));
    return room;
}

double expect_engines_agree(PreparedRoom& room, double tolerance) {
    const auto frames = room.all_frames();
    const Played exact = play(room, *room.exact(), frames);
    const double offline = largest_difference(room, play(room, *room.offline(tolerance), frames), exact);
    const double online = largest_difference(room, play(room, *room.online(tolerance), frames), exact);
    EXPECT_LE(offline, tolerance) << "offline";
    EXPECT_LE(online, tolerance) << "online";
    return std::max(offline, online);
}

TEST(HardMotions, panel_slides_above_the_floor) {
    for (const double height_m : {1e-1, 1e-2, 1e-3, 1e-6}) {
        SCOPED_TRACE(height_m);
        PreparedRoom hot(furnace(along_the_floor(height_m)));
        const double off = largest_furnace_error(hot, play(hot, *hot.exact(), hot.all_frames()));
        std::printf("    height %.0e m: furnace off by %.1e", height_m, off);
        EXPECT_LE(off, 3e-3);
        PreparedRoom room(along_the_floor(height_m));
        std::printf(", engines by %.1e\n", expect_engines_agree(room, 1e-2));
    }
}

TEST(HardMotions, panel_passes_through_a_shelf) {
    for (const bool across : {false, true}) {
        SCOPED_TRACE(across ? "across" : "flat");
        const MovingRoom made = across ? across_a_shelf() : through_a_shelf();
        PreparedRoom hot(furnace(made));
        const double off = largest_furnace_error(hot, play(hot, *hot.exact(), hot.all_frames()));
        std::printf("    %s: furnace off by %.1e", across ? "across" : "flat", off);
        EXPECT_LE(off, 3e-3);
        PreparedRoom room(made);
        std::printf(", engines by %.1e\n", expect_engines_agree(room, 1e-2));
    }
}

TEST(HardMotions, light_that_nothing_foretold_is_seen_at_once) {
    PreparedRoom room(behind_a_shutter());
    const auto frames = room.all_frames();
    const Played exact = play(room, *room.exact(), frames);
    const Played online = play(room, *room.online(1e-2), frames);
    // Frames in the dark have no light of their own to be measured by: the last one's is taken.
    double largest = 0.0;
    for (std::size_t f = 0; f < frames.size(); ++f) {
        std::vector<double> found = exact.light.back();
        for (std::size_t u = 0; u < found.size(); ++u) found[u] += online.light[f][u] - exact.light[f][u];
        largest = std::max(largest, room.difference(found, exact.light.back()));
    }
    std::printf("    off by %.1e of the full light, %llu of %llu blocks integrated\n", largest,
                static_cast<unsigned long long>(online.integrated),
                static_cast<unsigned long long>(exact.integrated));
    EXPECT_LE(largest, 1e-2);
    EXPECT_LT(online.integrated, exact.integrated);
}

TEST(HardMotions, lamp_enters_a_closed_box_and_leaves_the_room_dark) {
    PreparedRoom room(into_a_box(11));
    expect_engines_agree(room, 1e-2);
    const auto offline = room.offline(1e-2);
    const auto light = play(room, *offline, {0, 10}).light;
    double outside_first = 0.0, outside_last = 0.0, inside_last = 0.0;
    for (std::size_t e = 0; e < room.shapes.size(); ++e) {
        const std::size_t constant = room.coefficients.layout.offsets[e];
        const bool wall = room.shapes[e].object == ObjectId(0);
        if (wall) {
            outside_first = std::max(outside_first, std::abs(light[0][constant]));
            outside_last = std::max(outside_last, std::abs(light[1][constant]));
        } else if (!room.room.scene.materials[room.shapes[e].material.value].emits())
            inside_last = std::max(inside_last, light[1][constant]);
    }
    EXPECT_GT(outside_first, 0.01);
    EXPECT_GT(inside_last, 0.01);
    EXPECT_LE(outside_last, 1e-9 * inside_last);
}

TEST(HardMotions, lamp_switched_off_on_its_way_leaves_the_room_dark_and_comes_back_right) {
    MovingRoom made = support::sliding_lamp(9);
    made.scene.dimmings = {{"switch", model::Interpolation::Step, {{0.0, 1.0}, {0.5, 0.0}, {0.75, 1.0}}}};
    made.scene.materials[1].dimming = DimmingId(0);
    PreparedRoom room(std::move(made));
    const auto frames = room.all_frames();
    const auto solve = [&](motion::Engine& engine) {
        return solve::solve_animation(room.animation(), engine, frames, {.tolerance = 1e-6},
                                      [](const auto&) {})
            .frames;
    };
    const auto exact = solve(*room.exact());
    MovingRoom steady = room.room;
    steady.scene.materials[1].dimming = {};
    PreparedRoom lit(std::move(steady));
    const Played expected = play(lit, *lit.exact(), frames);
    for (const auto& found : {solve(*room.offline(1e-2)), solve(*room.online(1e-2)), exact})
        for (std::size_t f = 0; f < frames.size(); ++f) {
            const bool off = f == 4 || f == 5;
            if (off)
                EXPECT_EQ(std::ranges::count(found[f].radiosity, 0.0),
                          static_cast<std::ptrdiff_t>(found[f].radiosity.size()))
                    << "frame " << f;
            else
                EXPECT_LE(lit.difference(found[f].radiosity, expected.light[f]), 1e-2) << "frame " << f;
        }
}

} // namespace
} // namespace kinelux
