// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include <gtest/gtest.h>

#include "solve/solve.h"
#include "support/computed.h"

namespace kinelux::solve {
namespace {

std::vector<double> areas_of(const std::vector<geometry::ElementShape>& shapes) {
    std::vector<double> areas;
    areas.reserve(shapes.size());
    for (const auto& shape : shapes) areas.push_back(shape.area);
    return areas;
}

// Uniform M and rho in a closed scene: B = M / (1 - rho) everywhere.
double furnace_error(double rho) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(1.0, 1.5, 0.8), support::Facing::Inwards);
    const auto scene = support::plain_scene(1, rho, 1.0);
    const auto [shapes, coefficients] = support::compute(set, scene, 3, 2);
    const auto areas = areas_of(shapes);
    const std::vector<double> ones(shapes.size(), 1.0), reflectance(shapes.size(), rho);
    const BlockOperator blocks(coefficients.layout, coefficients.static_blocks);
    const auto exitance = constant_coefficients(coefficients.layout, 1, areas, ones);
    const auto solution = solve_system({blocks, 1, exitance, reflectance, areas}, {.tolerance = 1e-8}, {});
    double worst = 0.0;
    for (std::size_t e = 0; e < shapes.size(); ++e) {
        const double mean = solution.radiosity[coefficients.layout.offsets[e]] / std::sqrt(areas[e]);
        worst = std::max(worst, std::abs(mean * (1.0 - rho) - 1.0));
    }
    ::testing::Test::RecordProperty("furnace_error_rho_" + std::to_string(rho), std::to_string(worst));
    return worst;
}

TEST(Furnace, closed_box_glows_evenly) {
    EXPECT_LT(furnace_error(0.5), 0.01);
    EXPECT_LT(furnace_error(0.9), 0.05);
}

} // namespace
} // namespace kinelux::solve
