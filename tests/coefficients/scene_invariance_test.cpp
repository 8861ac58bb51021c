// SPDX-License-Identifier: GPL-3.0-or-later
// Form factors of a scene with much standing between do not depend on where it is, how it is turned, and its unit.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coefficients/whole_patch_factors.h"
#include "support/placements.h"
#include "support/planar_patches.h"
#include "support/shapes.h"

namespace kinelux::coefficients {
namespace {

constexpr double tolerance = 1e-3;

// A room with a table on four legs, a cupboard on the floor and a screen; every patch a group of its own.
model::PatchSet furnished_room() {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(4, 5, 2.7), support::Facing::Inwards);
    const auto add = [&](const Vec3& low, const Vec3& high) {
        const auto faces = support::box(low, high, support::Facing::Outwards);
        set.patches.insert(set.patches.end(), faces.begin(), faces.end());
    };
    add({1, 1, 0.7}, {2.2, 1.8, 0.75});
    for (const Vec2& leg : {Vec2(1.05, 1.05), Vec2(2.1, 1.05), Vec2(1.05, 1.7), Vec2(2.1, 1.7)})
        add({leg, 0.0}, {leg + Vec2(0.05), 0.7});
    add({0.1, 2, 0}, {0.7, 3, 2});
    set.patches.push_back(support::rectangle({2.5, 2, 0.5}, {1, 0.4, 0}, {0, 0, 1.5}));
    return set;
}

struct Factors {
    std::vector<FormFactor> whole; ///< as kinelux form-factors has them
    std::vector<double> rows;      ///< sums of the coefficients' rows
};

Factors factors_in(const support::Placement& place) {
    const model::PatchSet set = support::placed(furnished_room(), place);
    const auto elements = geometry::element_shapes(set, support::whole_patch_elements(set), 0, 0);
    const auto scene = support::plain_scene(1);
    const auto occluders = support::occluders_of(set, scene);
    std::vector<std::uint32_t> group_of;
    for (std::uint32_t e = 0; e < elements.size(); ++e) group_of.push_back(e);
    const kernel::TransportOptions options{
        .tolerance = tolerance, .sight_tolerance = tolerance, .most_blockers = 100};
    return {whole_patch_factors(elements, occluders, options, group_of,
                                static_cast<std::uint32_t>(elements.size())),
            element_row_sums(compute_coefficients(elements, scene, {.degree = 0}, occluders, options, 1e6),
                             elements)};
}

TEST(FormFactors, of_occluded_scenes_are_the_same_in_every_place_turn_and_unit) {
    const auto places = support::placements();
    const Factors expected = factors_in(places.front());
    fmt::print("| place | form factors differ by | row sums differ by |\n|---|---|---|\n");
    for (std::size_t p = 1; p < places.size(); ++p) {
        const Factors found = factors_in(places[p]);
        double factor = 0.0, row = 0.0;
        for (std::size_t k = 0; k < found.whole.size(); ++k)
            factor = std::max(factor, std::abs(found.whole[k].value - expected.whole[k].value));
        for (std::size_t e = 0; e < found.rows.size(); ++e)
            row = std::max(row, std::abs(found.rows[e] - expected.rows[e]));
        fmt::print("| {} | {:.1e} | {:.1e} |\n", places[p].name, factor, row);
        EXPECT_LE(factor, tolerance) << places[p].name;
        EXPECT_LE(row, 3.0 * tolerance) << places[p].name;
    }
}

} // namespace
} // namespace kinelux::coefficients
