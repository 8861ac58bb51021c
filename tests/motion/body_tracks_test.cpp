// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/body_tracks.h"

#include <gtest/gtest.h>

#include "support/moving_rooms.h"

namespace kinelux::motion {
namespace {

struct Tracked {
    support::MovingRoom room = support::sliding_lamp(2, 1);
    std::vector<geometry::ElementShape> shapes = support::shapes_of(room.set, 1, 0);
    BodyTracks tracks{shapes, room.plan};
    std::uint64_t frame = 0;

    // Whether the lamp is where it was expected.
    bool jumps(double time_s, const geometry::Pose& pose) {
        tracks.follow(++frame, time_s, std::vector<geometry::Pose>{{}, pose});
        return tracks.jumped(ObjectId(1));
    }
};

geometry::Pose at(double x) { return {.translation = Vec3(x, 0, 0)}; }

TEST(BodyTracks, expect_smooth_paths_to_go_on) {
    Tracked slides, turns;
    for (int k = 0; k < 20; ++k) {
        const double t = 0.1 * k;
        const bool slid = slides.jumps(t, at(t * t));
        const bool turned = turns.jumps(t, {.rotation = glm::angleAxis(0.1 * k, Vec3(0, 0, 1))});
        if (k > 3) {
            EXPECT_FALSE(slid) << k;
            EXPECT_FALSE(turned) << k;
        }
    }
}

TEST(BodyTracks, see_a_start_a_corner_a_stop_and_a_teleport) {
    Tracked body;
    const std::vector<double> places{0, 0, 0, 0, 1, 2, 3, 4, 3, 2, 1, 0, 0, 0, 0, 9, 9, 9, 9};
    std::vector<std::size_t> jumps;
    for (std::size_t k = 0; k < places.size(); ++k)
        if (body.jumps(static_cast<double>(k), at(places[k]))) jumps.push_back(k);
    for (const std::size_t k : {4u, 8u, 12u, 15u})
        EXPECT_NE(std::find(jumps.begin(), jumps.end(), k), jumps.end()) << k;
    for (const std::size_t k : {2u, 3u, 7u, 11u, 18u})
        EXPECT_EQ(std::find(jumps.begin(), jumps.end(), k), jumps.end()) << k;
}

TEST(BodyTracks, tell_rest_from_a_billionth) {
    Tracked body;
    body.jumps(0.0, at(0.0));
    body.jumps(1.0, at(0.0));
    EXPECT_EQ(body.tracks.moved_at(ObjectId(1)), 1u);
    body.jumps(2.0, at(1e-9));
    EXPECT_EQ(body.tracks.moved_at(ObjectId(1)), 3u);
    // The same place by another quaternion.
    body.jumps(3.0, {.rotation = Quat(-1, 0, 0, 0), .translation = Vec3(1e-9, 0, 0)});
    EXPECT_EQ(body.tracks.moved_at(ObjectId(1)), 3u);
    EXPECT_EQ(body.tracks.moved_at(ObjectId(0)), 0u);
}

TEST(BodyTracks, expect_nothing_after_forgetting) {
    Tracked body;
    for (int k = 0; k < 4; ++k) body.jumps(k, at(k));
    body.tracks.forget();
    EXPECT_FALSE(body.jumps(1.5, at(20.0)));
    EXPECT_EQ(body.tracks.moved_at(ObjectId(1)), 5u);
}

} // namespace
} // namespace kinelux::motion
