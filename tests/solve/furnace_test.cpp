// SPDX-License-Identifier: GPL-3.0-or-later
// The white furnace: where everything glows and reflects alike in a closed room, B = M / (1 - rho) everywhere. What rows
// of form factors miss is amplified by the bounces, so this is the hardest test of closure there is.
#include <algorithm>
#include <cmath>
#include <ctime>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cluster/cluster.h"
#include "coefficients/coefficients.h"
#include "plan/plan.h"
#include "solve/solve.h"
#include "support/closed_rooms.h"
#include "support/shapes.h"

namespace kinelux::solve {
namespace {

struct Furnace {
    double defect = 0.0;    ///< largest |row sum - 1| of an element
    double tolerance = 0.0; ///< of blocks, as derived from accuracy and reflectances
    double error_l2 = 0.0, error_worst = 0.0; ///< of radiosity: relative L2, and of the worst element's mean
    std::size_t elements = 0;
    double seconds = 0.0; ///< CPU
};

// From patches to radiosity as the program goes, with elements of a size of ours.
Furnace furnace(const support::ClosedRoom& room, double rho, double accuracy, double element_size) {
    model::Scene scene = support::plain_scene(1, rho, 1.0);
    scene.accuracy.target = accuracy;
    scene.accuracy.element_size = element_size;
    const auto tree =
        cluster::build_clusters(room.set, cluster::cluster_options_for(scene, room.set));
    const model::Plan plan = plan::plan_effects(scene, room.set, tree);
    const auto elements = geometry::element_shapes(room.set, tree, plan.degree, plan.cluster_degree);
    const auto occluders = support::occluders_of(room.set, scene);
    const auto options = coefficients::transport_options_for(scene, plan, elements);
    Furnace result{.tolerance = options.tolerance, .elements = elements.size()};
    const std::clock_t started = std::clock();
    const auto transport =
        coefficients::compute_coefficients(elements, scene, plan, occluders, options, 1e6);
    result.seconds = static_cast<double>(std::clock() - started) / CLOCKS_PER_SEC;
    for (const double sum : coefficients::element_row_sums(transport, elements))
        result.defect = std::max(result.defect, std::abs(sum - 1.0));

    std::vector<double> areas;
    for (const auto& element : elements) areas.push_back(element.area);
    const std::vector<double> ones(elements.size(), 1.0), reflectance(elements.size(), rho);
    const BlockOperator blocks(transport.layout, transport.static_blocks);
    const auto exitance = constant_coefficients(transport.layout, 1, areas, ones);
    const auto solution =
        solve_system({blocks, 1, exitance, reflectance, areas}, {.tolerance = std::min(1e-4, 0.01 * accuracy)}, {});
    EXPECT_TRUE(solution.converged) << room.name;
    double difference = 0.0, norm = 0.0;
    for (std::size_t k = 0; k < exitance.size(); ++k) {
        const double expected = exitance[k] / (1.0 - rho);
        difference += std::pow(solution.radiosity[k] - expected, 2.0);
        norm += expected * expected;
    }
    result.error_l2 = std::sqrt(difference / norm);
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const double mean = solution.radiosity[transport.layout.offsets[e]] / std::sqrt(areas[e]);
        result.error_worst = std::max(result.error_worst, std::abs(mean * (1.0 - rho) - 1.0));
    }
    return result;
}

// Pieces of at most this share of the longest edge: coarse, because constant light needs no more.
void expect_even_glow(double accuracy, double share) {
    fmt::print("| room | rho | elements | blocks' tolerance | largest row defect | radiosity, relative L2 | worst element "
               "| CPU seconds |\n|---|---|---|---|---|---|---|---|\n");
    for (const support::ClosedRoom& room : support::closed_rooms()) if (!std::getenv("ROOM") || room.name.find(std::getenv("ROOM"))!=std::string::npos)
        for (const double rho : {0.5, 0.9, 0.99}) {
            const Furnace found = furnace(room, rho, accuracy, share * room.longest_edge);
            fmt::print("| {} | {} | {} | {:.1e} | {:.1e} | {:.1e} | {:.1e} | {:.2f} |\n", room.name, rho,
                       found.elements, found.tolerance, found.defect, found.error_l2, found.error_worst,
                       found.seconds);
            EXPECT_LT(found.defect, 3.0 * found.tolerance) << room.name << ", rho " << rho;
            EXPECT_LT(found.error_l2, accuracy) << room.name << ", rho " << rho;
            EXPECT_LT(found.error_worst, accuracy) << room.name << ", rho " << rho;
        }
}

TEST(Furnace, closed_rooms_glow_evenly_within_3_percent) { expect_even_glow(0.03, 0.25); }
TEST(Furnace, closed_rooms_glow_evenly_within_1e_4) { expect_even_glow(1e-4, 0.25); }

} // namespace
} // namespace kinelux::solve
