// SPDX-License-Identifier: GPL-3.0-or-later
// Prints the table of docs/quadrature.md: error of a block, relative to its norm, and time by method and kind of pair.
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "kernel/quasi_monte_carlo.h"
#include "kernel/transport.h"
#include "support/pair_reference.h"
#include "support/planar_patches.h"
#include "support/shapes.h"

namespace kinelux {
namespace {

struct Pair {
    std::string name;
    model::Patch a, b;
};

std::vector<Pair> pairs() {
    const auto floor = support::rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const auto above = [](double gap) { return support::rectangle({0, 0, gap}, {0, 1, 0}, {1, 0, 0}); };
    const auto hinged = [](double degrees) {
        const double a = degrees * std::numbers::pi / 180.0;
        return support::rectangle(Vec3(0), {0, 1, 0}, {std::cos(a), 0, std::sin(a)});
    };
    return {{"far, gap 6", floor, above(6)},
            {"gap 1", floor, above(1)},
            {"gap 0.3", floor, above(0.3)},
            {"shared edge, 90 degrees", floor, hinged(90)},
            {"shared edge, 30 degrees", floor, hinged(30)},
            {"shared vertex", floor, support::rectangle({0, 0, 0}, {0, 0, 1}, {0, -1, 0})},
            {"facing, gap 0.1", floor, above(0.1)},
            {"facing, gap 1e-3", floor, above(1e-3)}};
}

const visibility::Occluders& nothing() {
    static const visibility::Occluders occluders{std::vector<visibility::Body>()};
    return occluders;
}

// "error / microseconds" of one method on one pair.
template <class Method>
std::string cell(const support::PairReference& reference, const Method& method) {
    using Clock = std::chrono::steady_clock;
    kernel::TransportBlock block = method();
    int runs = 0;
    const auto start = Clock::now();
    constexpr double enough_seconds = 0.02;
    double seconds = 0.0;
    while (seconds < enough_seconds) {
        block = method();
        ++runs;
        seconds = std::chrono::duration<double>(Clock::now() - start).count();
    }
    block.values.resize(reference.values.size());
    double sum = 0.0;
    for (std::size_t k = 0; k < block.values.size(); ++k)
        sum += (block.values[k] - reference.values[k]) * (block.values[k] - reference.values[k]);
    return fmt::format(" {:.0e} / {:.0f} |", std::sqrt(sum) / reference.norm, 1e6 * seconds / runs);
}

void print_row(const Pair& pair, int degree) {
    model::PatchSet set;
    set.patches = {pair.a, pair.b};
    const auto shapes = geometry::element_shapes(set, support::whole_patch_elements(set), degree, 0);
    const auto reference = support::pair_reference(shapes[0], shapes[1]);
    std::string row = fmt::format("| {} | {} |", pair.name, degree);
    for (const auto points : {kernel::Points::Random, kernel::Points::Sobol})
        for (const std::uint32_t samples : {128u, 8192u})
            row += cell(reference, [&] {
                return kernel::quasi_monte_carlo(shapes[0], shapes[1], nothing(),
                                                 {.samples = samples, .points = points, .occlusion = false});
            });
    for (const double tolerance : {1e-2, 1e-3, 1e-6})
        row += cell(reference, [&] {
            return kernel::transport(shapes[0], shapes[1], nothing(),
                                     {.tolerance = tolerance, .occlusion = false});
        });
    fmt::print("{}\n", row);
}

} // namespace
} // namespace kinelux

int main() {
    fmt::print(
        "| pair | degree | MC 1024 | MC 65536 | Sobol 1024 | Sobol 65536 | automatic 1e-2 | 1e-3 | 1e-6 |\n"
        "|---|---|---|---|---|---|---|---|---|\n");
    for (const auto& pair : kinelux::pairs())
        for (int degree = 0; degree <= 3; ++degree) kinelux::print_row(pair, degree);
    return 0;
}
