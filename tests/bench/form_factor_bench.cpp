// SPDX-License-Identifier: GPL-3.0-or-later
// Form factors of triangulated squares and rooms, every triangle an element of degree 0, all pairs computed: CPU time,
// blocks and rays per second, and errors, beside what other programs were measured at. Prints docs/speed.md's table.
//   form_factor_bench [--small] [--tolerance T] [--sight-tolerance T] [CASE...]
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "coefficients/coefficients.h"
#include "core/parallel.h"
#include "geometry/quadrature.h"
#include "kernel/polygon_form_factor.h"
#include "kernel/polygon_irradiance.h"
#include "support/shapes.h"

namespace kinelux {
namespace {

using Polygon = std::vector<Vec3>;

// User and system time of the whole process [s].
double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Patch p cut into cells[p] x cells[p] squares of two triangles; every triangle is an element, in order of patches. A
// patch of no cells only casts shadows.
model::ClusterTree triangle_elements(const model::PatchSet& set, std::span<const int> cells) {
    model::ClusterTree tree;
    for (std::size_t p = 0; p < set.patches.size(); ++p) {
        const model::Patch& patch = set.patches[p];
        const int n = cells[p];
        const Vec2 u = (patch.points[1] - patch.points[0]) / static_cast<double>(n);
        const Vec2 v = (patch.points[3] - patch.points[0]) / static_cast<double>(n);
        for (int k = 0; k < 2 * n * n; ++k) {
            const int i = k / 2 / n, j = k / 2 % n;
            const Vec2 c = patch.points[0] + static_cast<double>(i) * u + static_cast<double>(j) * v;
            model::Element element;
            element.patch = PatchId(p);
            element.object = patch.object;
            element.material = patch.material;
            element.first_triangle = static_cast<std::uint32_t>(tree.domain_triangles.size());
            element.triangle_count = 1;
            if (k % 2 == 0)
                tree.domain_triangles.push_back({c, c + u, c + u + v});
            else
                tree.domain_triangles.push_back({c, c + u + v, c + v});
            tree.elements.push_back(element);
        }
    }
    return tree;
}

/// A scene, how it is cut, and what the factors from the first patch to the second should be.
struct Case {
    std::string name;
    std::vector<model::Patch> patches;
    std::vector<int> cells;
    std::function<double(const Polygon&)>
        expected;                         ///< from a triangle of patch 0 to all of patch 1; none: closed
    std::string view3d, open_view_factor; ///< as published: CPU seconds, errors
};

constexpr int full_cells = 32; ///< of the published 4,096 triangles

const Polygon floor_square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const Polygon ceiling_square{{0, 1, 1}, {1, 1, 1}, {1, 0, 1}, {0, 0, 1}};
const Polygon wall_square{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}};

// The factor from a triangle of the floor to the ceiling behind the centred square of side 0.5 at half height. The shadow
// of that from any point of the floor is an axis-parallel square of side 1; its part in the ceiling changes its shape only
// where x or y is 0.5, along edges of the triangles, so that Gauss nodes see an analytic function.
double factor_behind_pane(const Polygon& triangle) {
    constexpr int nodes = 8;
    const geometry::GaussRule& rule = geometry::gauss_rule(nodes);
    const auto seen = [](const Vec3& x) {
        const Vec2 low(std::max(0.0, 0.5 - x.x), std::max(0.0, 0.5 - x.y));
        const Vec2 high(std::min(1.0, 1.5 - x.x), std::min(1.0, 1.5 - x.y));
        const Polygon shadow{{low.x, high.y, 1}, {high.x, high.y, 1}, {high.x, low.y, 1}, {low.x, low.y, 1}};
        const Vec3 up(0, 0, 1);
        return kernel::point_to_polygon(x, up, ceiling_square) - kernel::point_to_polygon(x, up, shadow);
    };
    double sum = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i)
        for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
            const double s = rule.nodes[i], t = rule.nodes[j];
            const Vec3 x =
                triangle[0] + s * ((1.0 - t) * (triangle[1] - triangle[0]) + t * (triangle[2] - triangle[0]));
            sum += 2.0 * s * rule.weights[i] * rule.weights[j] * seen(x);
        }
    return sum;
}

std::vector<Case> cases(bool small) {
    const auto to = [](const Polygon& target) {
        return
            [target](const Polygon& triangle) { return kernel::polygon_form_factor(triangle, target).value; };
    };
    const auto square = [](const Polygon& p) { return support::rectangle(p[0], p[1] - p[0], p[3] - p[0]); };
    const model::Patch pane = support::rectangle({0.25, 0.25, 0.5}, {0.5, 0, 0}, {0, 0.5, 0});
    const auto room = support::box(Vec3(0), Vec3(1), support::Facing::Inwards);
    auto room_with_box = room;
    for (const auto& patch :
         support::box(Vec3(0.35, 0.3, 0.15), Vec3(0.7, 0.65, 0.5), support::Facing::Outwards))
        room_with_box.push_back(patch);
    std::vector<Case> list;
    for (const int n : small ? std::vector{4} : std::vector{16, full_cells}) {
        const bool full = n == full_cells;
        list.push_back({"parallel",
                        {square(floor_square), square(ceiling_square)},
                        {n, n},
                        to(ceiling_square),
                        full ? "0.9 s, 4e-8" : "",
                        full ? "0.5 s, 1e-4" : ""});
        list.push_back({"hinge",
                        {square(floor_square), square(wall_square)},
                        {n, n},
                        to(wall_square),
                        full ? "0.9 s, 2e-7 / 1.3e-5" : "",
                        full ? "0.5 s, 2e-5 / 4.8e-4" : ""});
        list.push_back({"obstructed",
                        {square(floor_square), square(ceiling_square), pane},
                        {n, n, 0},
                        factor_behind_pane,
                        full ? "21 s, 3e-8" : "",
                        full ? "1.9 s, 37 % wrong" : ""});
    }
    for (const int n : small ? std::vector{3} : std::vector{10, 18})
        list.push_back({"room", room, std::vector<int>(6, n), nullptr, "", ""});
    for (const int n : small ? std::vector{4} : std::vector{9, 16}) {
        std::vector<int> cells(6, n);
        cells.resize(12, n == 9 ? 4 : n / 2);
        list.push_back({"room with a box", room_with_box, cells, nullptr,
                        n == 9    ? "6 s, 4.5e-5"
                        : n == 16 ? "61 s, 2.9e-5"
                                  : "",
                        ""});
    }
    return list;
}

/// Errors relative to the expected values [1].
struct Errors {
    double sum = 0.0, rms = 0.0, largest = 0.0; ///< of all rows together; of single rows
};

Errors errors_of(const Case& item, std::span<const geometry::ElementShape> shapes,
                 const model::Coefficients& result) {
    std::vector<double> rows(shapes.size(), 0.0);
    const auto triangles = [&](std::size_t patch) {
        const auto n = static_cast<std::size_t>(item.cells[patch]);
        return 2 * n * n;
    };
    const std::size_t first = triangles(0), second = first + triangles(1);
    for (const model::BlockEntry& entry : result.static_blocks.entries) {
        const double value = result.static_blocks.values[entry.offset];
        const double ratio = std::sqrt(shapes[entry.j].area / shapes[entry.i].area);
        if (item.expected) {
            if (entry.i < first && entry.j >= first && entry.j < second) rows[entry.i] += value * ratio;
            continue;
        }
        rows[entry.i] += value * ratio;
        if (entry.i != entry.j) rows[entry.j] += value / ratio;
    }
    if (item.expected) rows.resize(first);
    Errors errors;
    double sum = 0.0, expected_sum = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& corners = shapes[i].facets[0].corners;
        const double expected = item.expected ? item.expected({corners.begin(), corners.end()}) : 1.0;
        const double relative = rows[i] / expected - 1.0;
        sum += rows[i] * shapes[i].area;
        expected_sum += expected * shapes[i].area;
        errors.rms += relative * relative / static_cast<double>(rows.size());
        errors.largest = std::max(errors.largest, std::abs(relative));
    }
    errors.sum = std::abs(sum / expected_sum - 1.0);
    errors.rms = std::sqrt(errors.rms);
    return errors;
}

void run(const Case& item, const kernel::TransportOptions& options) {
    const model::PatchSet set{item.patches};
    const auto scene = support::plain_scene(1);
    const auto shapes = geometry::element_shapes(set, triangle_elements(set, item.cells), 0, 0);
    const auto occluders = support::occluders_of(set, scene);
    const double before = cpu_seconds();
    const auto result = coefficients::compute_coefficients(shapes, scene, {.degree = 0}, occluders, options,
                                                           1e6, {.use = coefficients::Grouping::Never});
    const double seconds = cpu_seconds() - before;
    const auto blocks = static_cast<double>(result.static_blocks.entries.size());
    const Errors errors = errors_of(item, shapes, result);
    fmt::print("| {} | {} | {:.0f} | {:.2f} | {:.2f} | {:.2f} | {:.1e} | {:.1e} | {:.1e} | {} | {} |\n",
               item.name, shapes.size(), blocks / 1e3, seconds, blocks / seconds / 1e6,
               result.rays_cast / 1e6, errors.sum, errors.rms, errors.largest, item.view3d,
               item.open_view_factor);
    std::fflush(stdout);
}

} // namespace
} // namespace kinelux

int main(int argc, char** argv) {
    using namespace kinelux;
    bool small = false;
    kernel::TransportOptions options{.tolerance = 1e-3, .sight_tolerance = 1e-2};
    std::vector<std::string_view> names;
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (argument == "--small")
            small = true;
        else if (argument == "--tolerance" && i + 1 < argc)
            options.tolerance = std::atof(argv[++i]);
        else if (argument == "--sight-tolerance" && i + 1 < argc)
            options.sight_tolerance = std::atof(argv[++i]);
        else
            names.push_back(argument);
    }
    core::set_thread_count(1);
    fmt::print("tolerance {:g}, with something between {:g}; one thread\n\n", options.tolerance,
               options.sight_tolerance);
    fmt::print("| case | triangles | blocks [k] | CPU s | Mblocks/s | Mrays | sum off by | rows off by, RMS "
               "| largest |"
               " View3D | OpenViewFactor |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const Case& item : cases(small))
        if (names.empty() || std::find(names.begin(), names.end(), item.name) != names.end())
            run(item, options);
    return 0;
}
