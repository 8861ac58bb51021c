// SPDX-License-Identifier: GPL-3.0-or-later
// The engines that spread errors against the exact one, by the light of every frame.
#include <gtest/gtest.h>

#include "support/moving_rooms.h"

namespace kinelux::motion {
namespace {

using support::MovingRoom;
using support::Played;
using support::PreparedRoom;

// Errors are within the tolerance in every frame; returns what was integrated at the last one.
struct Counts {
    std::uint64_t exact = 0, online = 0, offline = 0;
};
Counts expect_within(PreparedRoom& room, std::initializer_list<double> tolerances) {
    const auto frames = room.all_frames();
    const Played exact = play(room, *room.exact(), frames);
    Counts counts{.exact = exact.integrated};
    for (const double tolerance : tolerances) {
        const Played offline = play(room, *room.offline(tolerance), frames);
        EXPECT_LE(largest_difference(room, offline, exact), tolerance) << "offline";
        const Played online = play(room, *room.online(tolerance), frames);
        EXPECT_LE(largest_difference(room, online, exact), tolerance) << "online";
        counts.online = online.integrated;
        counts.offline = offline.integrated;
    }
    return counts;
}

TEST(Engines, of_a_sliding_lamp_keep_the_tolerance_with_less_than_a_third_of_the_blocks) {
    PreparedRoom room(support::sliding_lamp(60));
    const Counts counts = expect_within(room, {1e-3, 1e-2});
    EXPECT_LT(3 * counts.offline, counts.exact);
    EXPECT_LT(2 * counts.online, counts.exact);
}

TEST(Engines, of_a_lamp_that_spins_in_steps_of_six_degrees_keep_the_tolerance) {
    PreparedRoom room(support::turning_lamp(60, false, 360.0));
    expect_within(room, {1e-2, 1e-3});
}

TEST(Engines, of_a_lamp_on_an_orbit_keep_the_tolerance) {
    PreparedRoom room(support::turning_lamp(60, true, 360.0));
    expect_within(room, {1e-2, 1e-3});
}

TEST(Engines, of_a_full_turn_in_steps_of_one_degree_integrate_few_blocks) {
    PreparedRoom room(support::turning_lamp(361, true, 360.0, 1));
    const Counts counts = expect_within(room, {1e-2});
    EXPECT_LT(6 * counts.offline, counts.exact);
    EXPECT_LT(2 * counts.online, counts.exact);
}

TEST(Engines, take_a_full_turn_in_one_step_for_no_motion) {
    PreparedRoom room(support::turning_lamp(2, true, 360.0));
    const auto exact = play(room, *room.exact(), {0, 1});
    EXPECT_LE(room.difference(exact.light[1], exact.light[0]), 1e-9);
    const auto online = room.online(1e-2);
    EXPECT_GT(online->advance(room.time(0), room.poses(0)).computed, 0u);
    EXPECT_EQ(online->advance(room.time(1), room.poses(1)).computed, 0u);
    EXPECT_LE(largest_difference(room, play(room, *room.offline(1e-2), {0, 1}), exact), 1e-6);
}

TEST(Engines, of_a_panel_that_shades_keep_the_tolerance) {
    PreparedRoom room(support::sliding_panel(30));
    expect_within(room, {1e-2, 1e-3});
}

TEST(Engines, of_two_movers_that_cross_above_a_shelf_keep_the_tolerance) {
    PreparedRoom room(support::crossing_movers(30));
    expect_within(room, {1e-2});
}

TEST(Engines, of_a_mover_that_comes_out_from_behind_a_screen_keep_the_tolerance) {
    MovingRoom made(20);
    const ObjectId lamp = made.body("lamp"), screen = made.body("screen");
    made.side(lamp, Vec3(0.1, 0.9, 1.2), Vec3(0, 0.2, 0), Vec3(0.2, 0, 0), true);
    made.panel(screen, Vec3(0.6, 0.2, 0.2), Vec3(0, 1.6, 0), Vec3(0, 0, 1.7));
    // Behind the screen for half of the time, on its other side from one frame to the next.
    made.move({lamp}, {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)},
                       {0.5, Vec3(0.2, 0.0, 0.0), Quat(1, 0, 0, 0)},
                       {0.52, Vec3(0.7, 0.0, 0.0), Quat(1, 0, 0, 0)},
                       {1.0, Vec3(1.6, 0.0, 0.0), Quat(1, 0, 0, 0)}});
    PreparedRoom room(std::move(made));
    expect_within(room, {1e-2});
}

TEST(Engines, follow_a_teleport_at_once) {
    MovingRoom made(24);
    const ObjectId lamp = made.body("lamp");
    made.side(lamp, Vec3(0.2, 0.8, 1.7), Vec3(0, 0.4, 0), Vec3(0.4, 0, 0), true);
    made.move({lamp}, {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)},
                       {0.5, Vec3(0.3, 0.0, 0.0), Quat(1, 0, 0, 0)},
                       {0.501, Vec3(1.2, 0.6, -1.0), Quat(1, 0, 0, 0)},
                       {1.0, Vec3(0.9, 0.6, -1.0), Quat(1, 0, 0, 0)}});
    PreparedRoom room(std::move(made));
    expect_within(room, {1e-2, 1e-3});
}

TEST(Engines, of_a_body_that_rests_for_a_while_integrate_nothing_meanwhile) {
    MovingRoom made(40);
    const ObjectId lamp = made.body("lamp");
    made.side(lamp, Vec3(0.2, 0.8, 1.7), Vec3(0, 0.4, 0), Vec3(0.4, 0, 0), true);
    made.move({lamp}, {{0.2, Vec3(0.0), Quat(1, 0, 0, 0)}, {0.4, Vec3(0.3, 0.0, 0.0), Quat(1, 0, 0, 0)}});
    PreparedRoom room(std::move(made));
    expect_within(room, {1e-2});
    const auto online = room.online(1e-3);
    for (std::uint32_t frame = 0; frame < 40; ++frame) {
        const auto blocks = online->advance(room.time(frame), room.poses(frame));
        const bool rests = (frame > 0 && frame < 8) || frame > 16;
        if (rests) {
            EXPECT_EQ(blocks.computed, 0u) << frame;
        }
    }
}

TEST(Engines, of_a_lamp_that_moves_by_a_billionth_per_frame_integrate_hardly_anything) {
    MovingRoom made(40);
    const ObjectId lamp = made.body("lamp");
    made.side(lamp, Vec3(0.2, 0.8, 1.7), Vec3(0, 0.4, 0), Vec3(0.4, 0, 0), true);
    made.slide(lamp, Vec3(39e-9, 0.0, 0.0));
    PreparedRoom room(std::move(made));
    const Counts counts = expect_within(room, {1e-3});
    EXPECT_LT(5 * counts.offline, counts.exact);
    EXPECT_LT(3 * counts.online, counts.exact);
}

TEST(Engines, give_the_same_light_in_rooms_of_kilometres_and_millimetres) {
    const MovingRoom made = support::sliding_panel(12);
    PreparedRoom metres(made);
    // Powers of two: in others roundings differ, and quadratures are planned by thresholds.
    for (const double factor : {1.0 / 1024.0, 1024.0}) {
        PreparedRoom scaled(made.scaled(factor));
        for (const bool offline : {true, false}) {
            const auto frames = metres.all_frames();
            const auto a = offline ? metres.offline(1e-2) : metres.online(1e-2);
            const auto b = offline ? scaled.offline(1e-2) : scaled.online(1e-2);
            const Played expected = play(metres, *a, frames), found = play(scaled, *b, frames);
            EXPECT_EQ(found.integrated, expected.integrated);
            for (std::size_t f = 0; f < frames.size(); ++f) {
                // Coefficients grow with the root of the area.
                std::vector<double> same = found.light[f];
                for (double& value : same) value /= factor;
                EXPECT_LE(metres.difference(same, expected.light[f]), 1e-9) << factor << " frame " << f;
            }
        }
    }
}

TEST(Engines, answer_frames_in_any_order) {
    PreparedRoom room(support::crossing_movers(16));
    const std::vector<std::uint32_t> frames{15, 3, 4, 5, 6, 7, 0, 12, 9, 9, 14, 1};
    const Played exact = play(room, *room.exact(), frames);
    EXPECT_LE(largest_difference(room, play(room, *room.offline(1e-2), frames), exact), 1e-2);
    EXPECT_LE(largest_difference(room, play(room, *room.online(1e-2), frames), exact), 1e-2);
}

TEST(Engines, expand_between_frames_what_lies_between_them) {
    PreparedRoom room(support::sliding_lamp(31));
    const auto offline = room.offline(1e-3);
    const auto exact = room.exact();
    for (const double frame : {0.5, 7.25, 29.9}) {
        const double time_s = room.room.scene.time.end_s * frame / 30.0;
        const auto poses = geometry::object_poses(room.room.scene, time_s);
        EXPECT_LE(room.difference(room.light(offline->advance(time_s, poses)),
                                  room.light(exact->advance(time_s, poses))),
                  2e-3)
            << frame;
    }
}

TEST(Engines, say_the_errors_that_they_make) {
    PreparedRoom room(support::sliding_lamp(30));
    const auto offline = room.offline(1e-2);
    const auto exact = room.exact();
    const auto& layout = room.coefficients.layout;
    std::size_t blocks = 0, beyond = 0;
    for (const std::uint32_t frame : room.all_frames()) {
        const auto found = offline->advance(room.time(frame), room.poses(frame));
        const auto expected = exact->advance(room.time(frame), room.poses(frame));
        for (const model::BlockEntry& entry : found.blocks.entries) {
            const auto same = std::find_if(expected.blocks.entries.begin(), expected.blocks.entries.end(),
                                           [&](const auto& e) { return e.i == entry.i && e.j == entry.j; });
            if (same == expected.blocks.entries.end()) continue;
            double off = 0.0;
            for (std::size_t v = 0; v < layout.count(entry.i) * layout.count(entry.j); ++v) {
                const double d = static_cast<double>(found.blocks.values[entry.offset + v]) -
                                 static_cast<double>(expected.blocks.values[same->offset + v]);
                off += d * d;
            }
            ++blocks;
            beyond += std::sqrt(off) > static_cast<double>(entry.error) ? 1 : 0;
        }
    }
    EXPECT_GT(blocks, 1000u);
    EXPECT_LT(static_cast<double>(beyond), 0.05 * static_cast<double>(blocks));
}

} // namespace
} // namespace kinelux::motion
