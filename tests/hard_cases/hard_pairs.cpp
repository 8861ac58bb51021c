// SPDX-License-Identifier: GPL-3.0-or-later
#include "hard_pairs.h"

#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "kernel/polygon_form_factor.h"
#include "support/closed_forms.h"
#include "support/shapes.h"

namespace kinelux::hard_cases {

namespace {

using model::Patch;
using support::rectangle;

constexpr double asked = 1e-3; ///< relative, of every pair that exchanges light
constexpr double none = 0.0;   ///< exactly zero

Patch facing_up(double width = 1.0, double depth = 1.0) {
    return rectangle(Vec3(0), {width, 0, 0}, {0, depth, 0});
}
Patch facing_down(double height, double width = 1.0, double depth = 1.0) {
    return rectangle({0, 0, height}, {0, depth, 0}, {width, 0, 0});
}
// Upright over the line x = at, y from low to high; faces +x, or -x.
Patch wall(double at, double low, double high, double bottom, double top) {
    return rectangle({at, low, bottom}, {0, high - low, 0}, {0, 0, top - bottom});
}
Patch wall_facing_back(double at, double low, double high, double bottom, double top) {
    return rectangle({at, low, bottom}, {0, 0, top - bottom}, {0, high - low, 0});
}

HardPair pair(std::string name, std::vector<Patch> patches, double expected, double bound) {
    model::PatchSet set;
    set.patches = std::move(patches);
    return {std::move(name), std::move(set), expected, bound};
}

void add_contacts(std::vector<HardPair>& pairs) {
    // No light enters a closed contact: at a gap of exactly 0 neither face sees anything, and what they emit is lost.
    pairs.push_back(pair("contact, gap 0", {facing_up(), facing_down(0.0)}, 0.0, none));
    for (int exponent = -1; exponent >= -9; --exponent) {
        const double gap = std::pow(10.0, exponent);
        pairs.push_back(pair(fmt::format("facing, gap {:.0e}", gap), {facing_up(), facing_down(gap)},
                             support::parallel_equal_rectangles(1, 1, gap), asked));
    }
    pairs.push_back(pair("duplicates", {facing_up(), facing_up()}, 0.0, none));
    // Both copies are seen in full, as coplanar faces never hide each other: rows of what sees them count both.
    pairs.push_back(pair("duplicate of the receiver there", {facing_up(), facing_down(1.0), facing_down(1.0)},
                         support::parallel_equal_rectangles(1, 1, 1), asked));
    pairs.push_back(
        pair("receiver reversed", {facing_up(), rectangle({0, 0, 1}, {1, 0, 0}, {0, 1, 0})}, 0.0, none));
    pairs.push_back(pair("neighbours in one plane", {facing_up(), rectangle({1, 0, 0}, {1, 0, 0}, {0, 1, 0})},
                         0.0, none));
    pairs.push_back(pair("neighbours in one plane, one reversed",
                         {facing_up(), rectangle({1, 0, 0}, {0, 1, 0}, {1, 0, 0})}, 0.0, none));
    pairs.push_back(pair("foot of a box that stands on a table, its side",
                         {facing_up(), wall(0.5, 0.3, 0.7, 0, 0.2)},
                         0.5 * support::perpendicular_rectangles({0, 1, 0, 0.5}, {0.3, 0.7, 0, 0.2}), asked));
}

void add_crossings(std::vector<HardPair>& pairs) {
    // Of either the half in front of the other counts: they meet in a common edge.
    const double upright = 0.5 * support::perpendicular_rectangles_common_edge(1, 0.5, 0.5);
    pairs.push_back(
        pair("crossing at right angles", {facing_up(), wall(0.5, 0, 1, -0.5, 0.5)}, upright, asked));
    pairs.push_back(pair("crossing at right angles, other side",
                         {facing_up(), wall_facing_back(0.5, 0, 1, -0.5, 0.5)}, upright, asked));
    const double angle = std::numbers::pi / 3.0;
    const Vec3 along(std::cos(angle), 0, std::sin(angle)), across(0, 1, 0),
        corner = Vec3(0.5, 0, 0) - 0.5 * along;
    pairs.push_back(pair("crossing at 60 degrees", {facing_up(), rectangle(corner, across, along)},
                         0.5 * support::hinged_rectangles(1, 0.5, 0.5, angle), asked));
    pairs.push_back(pair("crossing at 60 degrees, other side",
                         {facing_up(), rectangle(corner, along, across)},
                         0.5 * support::hinged_rectangles(1, 0.5, 0.5, std::numbers::pi - angle), asked));
}

void add_slivers(std::vector<HardPair>& pairs) {
    constexpr double thin = 1e-4;
    pairs.push_back(pair("floor to a sliver of 1e4 at a wall's foot", {facing_up(), wall(0, 0, 1, 0, thin)},
                         support::perpendicular_rectangles_common_edge(1, 1, thin), asked));
    pairs.push_back(pair("sliver of 1e4 along a wall to the wall",
                         {facing_up(thin, 1.0), wall(0, 0, 1, 0, 2)},
                         support::perpendicular_rectangles_common_edge(1, thin, 2), asked));
    pairs.push_back(pair("sliver of 1e4 along a wall, 1e-3 from it",
                         {rectangle({1e-3, 0, 0}, {thin, 0, 0}, {0, 1, 0}), wall(0, 0, 1, 0, 2)},
                         support::perpendicular_rectangles({0, 1, 1e-3, 1e-3 + thin}, {0, 1, 0, 2}), asked));
    pairs.push_back(pair("two slivers of 1e4 at right angles", {facing_up(thin, 1.0), wall(0, 0, 1, 0, thin)},
                         support::perpendicular_rectangles_common_edge(1, thin, thin), asked));
}

std::vector<Vec3> corners_of(const Patch& patch) {
    std::vector<Vec3> corners;
    for (const std::uint32_t i : patch.loops.front())
        corners.push_back(patch.surface.origin + patch.points[i].x * patch.surface.axis_u +
                          patch.points[i].y * patch.surface.axis_v);
    return corners;
}

void add_specks(std::vector<HardPair>& pairs) {
    constexpr double speck = 1e-6, small = 1e-3, hall = 100.0;
    const auto at = [](double x, double size) {
        return rectangle({x, -0.5 * size, 0}, {size, 0, 0}, {0, size, 0});
    };
    const Patch tall = wall(0, -0.5 * hall, 0.5 * hall, 0, hall);
    const Patch ceiling = rectangle({-0.5 * hall, -0.5 * hall, hall}, {0, hall, 0}, {hall, 0, 0});
    pairs.push_back(pair("1e-6 m in a hall of 100 m, to its ceiling", {at(-0.5 * speck, speck), ceiling},
                         4.0 * support::element_to_parallel_rectangle(50, 50, 100), asked));
    // The double contour integral: the closed form of corners loses all digits between such sizes.
    const Patch beside = at(0, speck);
    pairs.push_back(pair("1e-6 m in a hall of 100 m, to the wall it touches", {beside, tall},
                         kernel::polygon_form_factor(corners_of(beside), corners_of(tall)).value, asked));
    pairs.push_back(pair(
        "sizes 1e5 to 1, touching at right angles", {at(0, small), tall},
        support::perpendicular_rectangles({-0.5 * small, 0.5 * small, 0, small}, {-50, 50, 0, 100}), asked));
    pairs.push_back(pair("sizes 1e5 to 1, facing at 1e-3",
                         {at(0, small), rectangle({-50, -50, 1e-3}, {0, 100, 0}, {100, 0, 0})},
                         support::parallel_rectangles({0, small, 0, small}, {-50, 50, -50, 50}, 1e-3),
                         asked));
}

void add_horizons(std::vector<HardPair>& pairs) {
    pairs.push_back(pair("wall apart, its foot on the floor's horizon",
                         {facing_up(), wall_facing_back(2, 0, 1, 0, 1)},
                         support::perpendicular_rectangles({0, 1, 1, 2}, {0, 1, 0, 1}), asked));
    pairs.push_back(pair("wall apart that just stays below the horizon",
                         {facing_up(), wall_facing_back(2, 0, 1, -1, 0)}, 0.0, none));
    pairs.push_back(pair("common corner only", {facing_up(), wall_facing_back(1, 1, 2, 0, 1)},
                         support::perpendicular_rectangles({0, 1, 0, 1}, {1, 2, 0, 1}), asked));
    pairs.push_back(pair("T-junction, half of an edge common", {facing_up(), wall(0, 0, 0.5, 0, 1)},
                         support::perpendicular_rectangles({0, 1, 0, 1}, {0, 0.5, 0, 1}), asked));
    pairs.push_back(pair("T-junction, a third of an edge common", {facing_up(), wall(0, 2.0 / 3.0, 3, 0, 1)},
                         support::perpendicular_rectangles({0, 1, 0, 1}, {2.0 / 3.0, 3, 0, 1}), asked));
}

} // namespace

std::vector<HardPair> hard_pairs() {
    std::vector<HardPair> pairs;
    add_contacts(pairs);
    add_crossings(pairs);
    add_slivers(pairs);
    add_specks(pairs);
    add_horizons(pairs);
    return pairs;
}

} // namespace kinelux::hard_cases
