// SPDX-License-Identifier: GPL-3.0-or-later
#include "hard_rooms.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coefficients/coefficients.h"
#include "support/placements.h"
#include "support/shapes.h"

namespace kinelux::coefficients {
namespace {

using hard_cases::HardRoom;

// The largest deviation of a row sum in one place.
double deviation(const HardRoom& room, const support::Placement& place) {
    const model::PatchSet set = support::placed(room.set, place);
    const auto elements = geometry::element_shapes(set, support::placed(room.tree, place), room.degree, 0);
    const auto scene = support::plain_scene(1);
    const auto blocks =
        compute_coefficients(elements, scene, {.degree = room.degree}, support::occluders_of(set, scene),
                             {.tolerance = 1e-3, .sight_tolerance = 2e-3}, 1e6);
    for (const float value : blocks.static_blocks.values) EXPECT_TRUE(std::isfinite(value)) << room.name;
    for (const model::BlockEntry& entry : blocks.static_blocks.entries) {
        EXPECT_GE(blocks.static_blocks.values[entry.offset], 0.0f)
            << room.name << ", " << entry.i << " to " << entry.j;
        EXPECT_TRUE(std::isfinite(entry.error)) << room.name;
    }
    const std::vector<double> sums = element_row_sums(blocks, elements);
    double worst = 0.0;
    for (std::size_t e = 0; e < sums.size(); ++e) {
        EXPECT_NEAR(sums[e], room.row_sums[e], room.bound)
            << room.name << ", " << place.name << ", element " << e;
        worst = std::max(worst, std::abs(sums[e] - room.row_sums[e]));
    }
    return worst;
}

TEST(HardRooms, rows_of_form_factors_sum_to_what_they_must) {
    fmt::print("| room | largest deviation of a row sum | bound |\n|---|---|---|\n");
    for (const HardRoom& room : hard_cases::hard_rooms()) {
        double worst = 0.0;
        for (const support::Placement& place : support::placements())
            worst = std::max(worst, deviation(room, place));
        fmt::print("| {} | {:.1e} | {:.0e} |\n", room.name, worst, room.bound);
        RecordProperty(room.name, fmt::format("{:.1e}", worst));
    }
}

} // namespace
} // namespace kinelux::coefficients
