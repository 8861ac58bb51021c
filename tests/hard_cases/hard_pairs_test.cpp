// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hard_pairs.h"
#include "kernel/polygon_irradiance.h"
#include "kernel/transport.h"
#include "support/closed_forms.h"
#include "support/placements.h"
#include "support/planar_patches.h"
#include "support/shapes.h"

namespace kinelux::kernel {
namespace {

using hard_cases::HardPair;

// How far a pair's form factor is off in one place: relative, or itself where 0 is expected.
double deviation(const HardPair& pair, const support::Placement& place, int degree) {
    const model::PatchSet set = support::placed(pair.set, place);
    const auto shapes = geometry::element_shapes(set, support::whole_patch_elements(set), degree, 0);
    const auto occluders = support::occluders_of(set, support::plain_scene(1));
    const auto block = transport(shapes[0], shapes[1], occluders, {.tolerance = 1e-3});
    const std::string where = fmt::format("{}, {}, degree {}", pair.name, place.name, degree);
    for (const double value : block.values) EXPECT_TRUE(std::isfinite(value)) << where;
    EXPECT_TRUE(std::isfinite(block.error) && block.error >= 0.0) << where;
    const double factor =
        block.values.empty() ? 0.0 : block.values[0] * std::sqrt(shapes[1].area / shapes[0].area);
    EXPECT_GE(factor, 0.0) << where;
    const double deviation = pair.expected > 0.0 ? std::abs(factor / pair.expected - 1.0) : std::abs(factor);
    EXPECT_LE(deviation, pair.bound) << where << ": " << factor << " instead of " << pair.expected;
    return deviation;
}

TEST(HardPairs, have_their_form_factors_in_every_place_and_degree) {
    fmt::print("| case | F | deviation | bound |\n|---|---|---|---|\n");
    for (const HardPair& pair : hard_cases::hard_pairs()) {
        double worst = 0.0;
        for (const support::Placement& place : support::placements())
            for (const int degree : {0, 2, 6}) worst = std::max(worst, deviation(pair, place, degree));
        fmt::print("| {} | {:.8g} | {:.1e} | {:.0e} |\n", pair.name, pair.expected, worst, pair.bound);
        RecordProperty(pair.name, fmt::format("{:.1e}", worst));
    }
}

TEST(PointOnTheHorizon, receives_what_the_closed_form_says) {
    const std::vector<Vec3> ceiling{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}};
    for (const Vec3& in_its_plane : {Vec3(0.5, 0.5, 1), Vec3(0, 0.5, 1), Vec3(0, 0, 1), Vec3(2, 2, 1)})
        for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0)})
            EXPECT_EQ(point_to_polygon(in_its_plane, normal, ceiling), 0.0);
    EXPECT_NEAR(point_to_polygon({0.5, 0.5, 1 - 1e-12}, {0, 0, 1}, ceiling), 1.0, 1e-9)
        << "all but in contact";
    // Its lower edge lies on the point's horizon; then the whole polygon does.
    const std::vector<Vec3> standing{{1, 0, 0}, {1, 0, 1}, {1, 2, 1}, {1, 2, 0}};
    EXPECT_NEAR(point_to_polygon({0, 0, 0}, {0, 0, 1}, standing),
                support::element_to_perpendicular_rectangle(2, 1, 1), 1e-15);
    EXPECT_EQ(point_to_polygon({0, 0, 1}, {0, 0, 1}, standing), 0.0) << "below the horizon up to an edge";
    EXPECT_EQ(point_to_polygon({0.5, 0.5, 0}, {0, 0, -1}, ceiling), 0.0);
}

} // namespace
} // namespace kinelux::kernel
