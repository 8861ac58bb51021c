// SPDX-License-Identifier: GPL-3.0-or-later
#include "closed_form_cases.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <fmt/format.h>

#include "coefficients/coefficients.h"
#include "geometry/quadrature.h"
#include "kernel/polygon_form_factor.h"
#include "kernel/polygon_irradiance.h"
#include "support/closed_forms.h"
#include "support/planar_patches.h"
#include "support/shapes.h"

namespace kinelux::validation {

namespace {

using support::rectangle;
using Polygon = std::vector<Vec3>;

constexpr double degree = std::numbers::pi / 180.0;
constexpr double flat = 1e-6, hinged = 1e-5, hidden = 1e-3; // relative, what is asked for at 1e-6

model::PatchSet patches(std::vector<model::Patch> list) {
    model::PatchSet set;
    for (std::size_t p = 0; p < list.size(); ++p) list[p].object = ObjectId(p);
    set.patches = std::move(list);
    return set;
}

model::Patch facing_up(const Vec3& corner, double u, double v) {
    return rectangle(corner, {u, 0, 0}, {0, v, 0});
}
model::Patch facing_down(const Vec3& corner, double u, double v) {
    return rectangle(corner, {0, v, 0}, {u, 0, 0});
}

Polygon circle(double radius, double height, int corners, double turn) {
    Polygon result;
    for (int i = 0; i < corners; ++i) {
        const double angle = turn * 2.0 * std::numbers::pi * i / corners;
        result.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    }
    return result;
}

void add_parallel(std::vector<ClosedFormCase>& cases) {
    for (const double gap : {10.0, 3.0, 1.0, 0.3, 1e-1, 1e-2, 1e-3, 1e-6, 1e-9})
        cases.push_back({fmt::format("facing unit squares, gap {:g}", gap), "Howell C-11",
                         patches({facing_up({0, 0, 0}, 1, 1), facing_down({0, 0, gap}, 1, 1)}),
                         support::parallel_equal_rectangles(1, 1, gap), flat});
    cases.push_back({"facing rectangles 2 x 0.7, gap 0.5", "Howell C-11",
                     patches({facing_up({0, 0, 0}, 2, 0.7), facing_down({0, 0, 0.5}, 2, 0.7)}),
                     support::parallel_equal_rectangles(2, 0.7, 0.5), flat});
    cases.push_back({"parallel rectangles 1 x 0.5 and 1.5 x 3, shifted", "Ehlert and Smith 1993",
                     patches({facing_up({0, 0, 0}, 1, 0.5), facing_down({2, 1, 0.8}, 1.5, 3)}),
                     support::parallel_rectangles({0, 1, 0, 0.5}, {2, 3.5, 1, 4}, 0.8), flat});
    cases.push_back({"parallel squares 1 and 0.5, half overlapping, gap 0.1", "Ehlert and Smith 1993",
                     patches({facing_up({0, 0, 0}, 1, 1), facing_down({0.75, 0.25, 0.1}, 0.5, 0.5)}),
                     support::parallel_rectangles({0, 1, 0, 1}, {0.75, 1.25, 0.25, 0.75}, 0.1), flat});
}

void add_perpendicular(std::vector<ClosedFormCase>& cases) {
    const auto wall = [](double low, double width, double bottom, double height) {
        return rectangle({low, 0, bottom}, {0, 0, height}, {width, 0, 0});
    };
    cases.push_back({"perpendicular unit squares, common edge", "Howell C-14",
                     patches({facing_up({0, 0, 0}, 1, 1), wall(0, 1, 0, 1)}),
                     support::perpendicular_rectangles_common_edge(1, 1, 1), flat});
    cases.push_back({"perpendicular 2 x 0.3 and 2 x 4, common edge", "Howell C-14",
                     patches({facing_up({0, 0, 0}, 2, 0.3), wall(0, 2, 0, 4)}),
                     support::perpendicular_rectangles_common_edge(2, 0.3, 4), flat});
    cases.push_back({"perpendicular, edges overlapping in part", "Ehlert and Smith 1993",
                     patches({facing_up({0, 0, 0}, 1, 0.5), wall(0.3, 2, 0, 1.5)}),
                     support::perpendicular_rectangles({0, 1, 0, 0.5}, {0.3, 2.3, 0, 1.5}), flat});
    cases.push_back({"perpendicular, common corner", "Ehlert and Smith 1993",
                     patches({facing_up({0, 0, 0}, 1, 1), wall(1, 1, 0, 1)}),
                     support::perpendicular_rectangles({0, 1, 0, 1}, {1, 2, 0, 1}), flat});
    cases.push_back({"perpendicular, both off the common line", "Ehlert and Smith 1993",
                     patches({facing_up({0, 0.2, 0}, 1, 0.3), wall(1.5, 2, 0.1, 1.5)}),
                     support::perpendicular_rectangles({0, 1, 0.2, 0.5}, {1.5, 3.5, 0.1, 1.6}), flat});
    cases.push_back({"wall half below a floor's horizon", "Howell C-14 and symmetry",
                     patches({facing_up({0, 0, 0}, 1, 1), wall(0, 1, -1, 2)}),
                     support::perpendicular_rectangles_common_edge(1, 1, 1), flat});
}

void add_hinges(std::vector<ClosedFormCase>& cases) {
    for (const double angle : {5.0, 10.0, 30.0, 45.0, 60.0, 90.0, 120.0, 150.0, 170.0}) {
        const double a = angle * degree;
        cases.push_back({fmt::format("unit squares hinged at {:g} degrees", angle),
                         "Hamilton and Morgan 1952, P-4",
                         patches({facing_up({0, 0, 0}, 1, 1),
                                  rectangle(Vec3(0), {0, 1, 0}, {std::cos(a), 0, std::sin(a)})}),
                         support::hinged_rectangles(1, 1, 1, a), hinged});
    }
}

void add_small(std::vector<ClosedFormCase>& cases) {
    // A square of 1e-4 is an element: what it sees varies by the square of that.
    const double s = 1e-4;
    cases.push_back({"element under the middle of a 2 x 1 rectangle", "Howell B-3",
                     patches({facing_up({-0.5 * s, -0.5 * s, 0}, s, s), facing_down({-1, -0.5, 0.7}, 2, 1)}),
                     4.0 * support::element_to_parallel_rectangle(1, 0.5, 0.7), flat});
    cases.push_back({"element before the middle of a 2 x 1 wall", "Howell B-4",
                     patches({facing_up({-0.5 * s, 0.7 - 0.5 * s, 0}, s, s),
                              rectangle({-1, 0, 0}, {0, 0, 1}, {2, 0, 0})}),
                     2.0 * support::element_to_perpendicular_rectangle(1, 1, 0.7), flat});
    const Polygon below = circle(1, 0, 64, 1), above = circle(0.5, 0.8, 64, -1);
    cases.push_back({"coaxial discs as polygons of 64 corners", "double contour integral",
                     patches({support::polygon_patch(below), support::polygon_patch(above)}),
                     kernel::polygon_form_factor(below, above).value, flat});
}

// Polygons in no special position: each in front of the other, and one that reaches behind the other's plane.
void add_tilted(std::vector<ClosedFormCase>& cases) {
    const Polygon pentagon{{0, 0, 0}, {1, -0.2, 0}, {1.4, 0.6, 0}, {0.7, 1.2, 0}, {-0.1, 0.8, 0}};
    const Polygon triangle{{0.1, 0.2, 0.5}, {0.3, 1.4, 0.9}, {1.5, 0.1, 1.3}};
    cases.push_back({"pentagon and tilted triangle", "double contour integral",
                     patches({support::polygon_patch(pentagon), support::polygon_patch(triangle)}),
                     kernel::polygon_form_factor(pentagon, triangle).value, flat});
}

// The part of one convex polygon in another, both in one plane z = constant, counter-clockwise from above.
Polygon common_part(Polygon polygon, std::span<const Vec3> window) {
    for (std::size_t i = 0; i < window.size() && !polygon.empty(); ++i) {
        const Vec3& from = window[i];
        const Vec3 along = window[(i + 1) % window.size()] - from;
        const auto inside = [&](const Vec3& p) {
            return along.x * (p.y - from.y) - along.y * (p.x - from.x);
        };
        Polygon kept;
        for (std::size_t c = 0; c < polygon.size(); ++c) {
            const Vec3 &p = polygon[c], &q = polygon[(c + 1) % polygon.size()];
            const double hp = inside(p), hq = inside(q);
            if (hp >= 0.0) kept.push_back(p);
            if (hp * hq < 0.0) kept.push_back(p + (q - p) * (hp / (hp - hq)));
        }
        polygon = std::move(kept);
    }
    return polygon;
}

// From the unit square at z = 0 to a convex polygon at z = 1 with a convex one at z = 0.5 between: from each point the
// polygon less its part in the blocker's shadow, by Gauss over cells so small that their kinks do not matter.
double factor_behind(const Polygon& target, const Polygon& blocker) {
    constexpr int cells = 48;
    const auto& rule = geometry::gauss_rule(2);
    const auto seen = [](const Vec3& x, Polygon polygon) {
        std::reverse(polygon.begin(), polygon.end());
        return polygon.size() < 3 ? 0.0 : kernel::point_to_polygon(x, {0, 0, 1}, polygon);
    };
    double sum = 0.0;
    for (int i = 0; i < 2 * cells; ++i)
        for (int j = 0; j < 2 * cells; ++j) {
            const int row = i / 2, column = j / 2;
            const Vec3 x((row + rule.nodes[i % 2]) / cells, (column + rule.nodes[j % 2]) / cells, 0.0);
            Polygon shadow;
            for (const Vec3& p : blocker) shadow.push_back(x + 2.0 * (p - x));
            sum += seen(x, target) - seen(x, common_part(target, shadow));
        }
    return sum / (4.0 * cells * cells);
}

void add_hidden(std::vector<ClosedFormCase>& cases) {
    const Polygon target{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    const Polygon pane{{0.2, 0.3, 0.5}, {0.7, 0.3, 0.5}, {0.7, 0.6, 0.5}, {0.2, 0.6, 0.5}};
    Polygon disc = circle(0.3, 0.5, 32, 1);
    for (Vec3& p : disc) p += Vec3(0.5, 0.5, 0.0);
    for (const auto& [name, blocker] : {std::pair{"rectangle", pane}, std::pair{"disc of 32 corners", disc}})
        cases.push_back({fmt::format("facing unit squares, gap 1, a {} between", name),
                         "shadow polygons, 96^2 points",
                         patches({facing_up({0, 0, 0}, 1, 1), facing_down({0, 0, 1}, 1, 1),
                                  support::polygon_patch(blocker)}),
                         factor_behind(target, blocker), hidden});
    cases.push_back({"facing 2 x 1 rectangles parted by a full wall", "Howell C-11",
                     patches({facing_up({0, 0, 0}, 2, 1), facing_down({0, 0, 1}, 2, 1),
                              rectangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1})}),
                     support::parallel_equal_rectangles(1, 1, 1), hidden});
}

} // namespace

std::vector<ClosedFormCase> closed_form_cases() {
    std::vector<ClosedFormCase> cases;
    add_parallel(cases);
    add_perpendicular(cases);
    add_hinges(cases);
    add_small(cases);
    add_tilted(cases);
    add_hidden(cases);
    for (ClosedFormCase& item : curved_form_cases()) cases.push_back(std::move(item));
    return cases;
}

double computed_factor(const ClosedFormCase& item, double accuracy) {
    const auto scene = support::plain_scene(item.set.patches.size());
    const auto shapes = geometry::element_shapes(item.set, support::whole_patch_elements(item.set), 2, 0);
    const visibility::Occluders occluders(item.open ? std::vector<visibility::Body>()
                                                    : visibility::bodies_of(item.set, scene));
    const auto blocks = coefficients::compute_coefficients(
        shapes, scene, {.degree = 2}, occluders,
        {.tolerance = accuracy, .sight_tolerance = std::max(accuracy, 1e-4), .most_blockers = 16}, 1e6);
    std::vector<std::uint32_t> group_of = item.group_of;
    for (auto e = static_cast<std::uint32_t>(group_of.size()); e < shapes.size(); ++e) group_of.push_back(e);
    const std::uint32_t groups = *std::max_element(group_of.begin(), group_of.end()) + 1;
    for (const auto& factor : coefficients::form_factors(blocks, shapes, group_of, groups))
        if (factor.from == 0 && factor.to == item.to) return factor.value;
    return 0.0;
}

} // namespace kinelux::validation
