// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/pair_screen.h"

#include <array>

#include <gtest/gtest.h>

#include "kernel/far_pair.h"
#include "kernel/transport.h"
#include "support/shapes.h"

namespace kinelux::coefficients {
namespace {

/// A room with a tilted pane and a box in it.
struct Room {
    Room() {
        set.patches = support::box(Vec3(0), Vec3(3, 4, 2.5), support::Facing::Inwards);
        for (const auto& patch :
             support::box(Vec3(1, 1, 0.3), Vec3(1.6, 2.2, 1.1), support::Facing::Outwards))
            set.patches.push_back(patch);
        set.patches.push_back(support::rectangle({0.4, 2.6, 1.2}, {0.9, 0.3, 0.2}, {-0.3, 0.9, 0.0}));
        shapes = support::shapes_of(set, 4, 0);
    }
    model::PatchSet set;
    std::vector<geometry::ElementShape> shapes;
};

// Of the segments between nodes that face each other: how many there are, and how many are blocked.
std::array<int, 2> rays_between(const geometry::ElementShape& a, const geometry::ElementShape& b,
                                const visibility::Occluders& occluders) {
    std::array<int, 2> counts{};
    for (const auto& x : a.rules[1].nodes)
        for (const auto& y : b.rules[1].nodes) {
            if (!(kernel::kernel_value(x, y) > 1e-12)) continue; // not along one plane
            ++counts[0];
            counts[1] += occluders.occluded(x.position, y.position) ? 1 : 0;
        }
    return counts;
}

TEST(PairScreen, what_it_is_certain_of_rays_confirm) {
    const Room room;
    const auto occluders = support::occluders_of(room.set, support::plain_scene(1));
    const PairScreen screen(room.shapes, &occluders.polygons());
    std::array<int, 4> seen{};
    for (std::size_t i = 0; i < room.shapes.size(); ++i)
        for (std::size_t j = i; j < room.shapes.size(); ++j) {
            const Screened screened = screen.look(i, j);
            ++seen[static_cast<std::size_t>(screened)];
            const auto [cast, blocked] = rays_between(room.shapes[i], room.shapes[j], occluders);
            if (screened == Screened::Apart) {
                EXPECT_EQ(cast, 0) << i << ' ' << j;
            }
            if (screened == Screened::Clear) {
                EXPECT_EQ(blocked, 0) << i << ' ' << j;
            }
            if (screened == Screened::Hidden) {
                EXPECT_EQ(blocked, cast) << i << ' ' << j;
            }
            EXPECT_EQ(screen.may_exchange(i, j), kernel::may_exchange(room.shapes[i], room.shapes[j]));
        }
    // It is of use: most pairs are decided.
    for (const Screened each : {Screened::Apart, Screened::Clear, Screened::Hidden})
        EXPECT_GT(seen[static_cast<std::size_t>(each)], 10);
    EXPECT_LT(5 * seen[static_cast<std::size_t>(Screened::Undecided)], seen[0] + seen[1] + seen[2]);
}

TEST(PairScreen, nothing_stands_between_the_walls_of_an_empty_room) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(3, 4, 2.5), support::Facing::Inwards);
    const auto shapes = support::shapes_of(set, 3, 0);
    const auto occluders = support::occluders_of(set, support::plain_scene(1));
    const PairScreen screen(shapes, &occluders.polygons());
    for (std::size_t i = 0; i < shapes.size(); ++i)
        for (std::size_t j = 0; j < shapes.size(); ++j)
            EXPECT_EQ(screen.look(i, j), i / 9 == j / 9 ? Screened::Apart : Screened::Clear);
}

TEST(PairScreen, sheets_back_to_back_are_not_one_plane) {
    model::PatchSet set;
    set.patches = {support::rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                   support::rectangle({0, 0, 1e-9}, {0, 1, 0}, {1, 0, 0})};
    const auto shapes = support::shapes_of(set, 1, 0);
    EXPECT_EQ(PairScreen(shapes, nullptr).look(0, 1), Screened::Clear);
}

} // namespace
} // namespace kinelux::coefficients
