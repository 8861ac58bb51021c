// SPDX-License-Identifier: GPL-3.0-or-later
// The white furnace: where everything glows and reflects alike in a closed room, B = M / (1 - rho) everywhere. What rows
// of form factors miss is amplified by the bounces, so this is the hardest test of closure there is.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <tuple>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cluster/cluster.h"
#include "coefficients/coefficients.h"
#include "plan/plan.h"
#include "solve/animation.h"
#include "solve/solve.h"
#include "support/closed_rooms.h"
#include "support/planar_patches.h"
#include "support/shapes.h"

namespace kinelux::solve {
namespace {

// What the program makes of patches, from elements to radiosity.
struct Glow {
    std::vector<geometry::ElementShape> elements;
    kernel::TransportOptions options;
    model::Coefficients transport;
    std::vector<double> areas, radiosity; ///< per element [m2]; coefficients
    std::vector<double> means;            ///< of radiosity, per element
    std::vector<std::size_t> patches;     ///< of the elements
    double seconds = 0.0;                 ///< CPU, of the blocks
};

// @param element_size  ours [m]; all else is chosen as the program chooses it
Glow glow_of(const model::PatchSet& set, model::Scene& scene, double accuracy, double element_size) {
    scene.accuracy.target = accuracy;
    scene.accuracy.element_size = element_size;
    const auto tree = cluster::build_clusters(set, cluster::cluster_options_for(scene, set));
    const model::Plan plan = plan::plan_effects(scene, set, tree);
    Glow glow;
    glow.elements = geometry::element_shapes(set, tree, plan.degree, plan.cluster_degree);
    const auto occluders = support::occluders_of(set, scene);
    glow.options = coefficients::transport_options_for(scene, plan, glow.elements);
    const std::clock_t started = std::clock();
    glow.transport =
        coefficients::compute_coefficients(glow.elements, scene, plan, occluders, glow.options, 1e6);
    glow.seconds = static_cast<double>(std::clock() - started) / CLOCKS_PER_SEC;

    std::vector<double> emitted, reflectance;
    for (std::size_t e = 0; e < glow.elements.size(); ++e) {
        const model::Material& material = scene.materials[glow.elements[e].material.value];
        glow.areas.push_back(glow.elements[e].area);
        glow.patches.push_back(tree.elements[e].patch->value);
        emitted.push_back(material.exitance.front());
        reflectance.push_back(material.reflectance.front());
    }
    const model::UnknownLayout& layout = glow.transport.layout;
    const BlockOperator blocks(layout, glow.transport.static_blocks);
    const auto exitance = constant_coefficients(layout, 1, glow.areas, emitted);
    const auto solution = solve_system({blocks, 1, exitance, reflectance, glow.areas},
                                       {.tolerance = tolerance_for(accuracy)}, {});
    EXPECT_TRUE(solution.converged);
    glow.radiosity = solution.radiosity;
    for (std::size_t e = 0; e < glow.elements.size(); ++e)
        glow.means.push_back(glow.radiosity[layout.offsets[e]] / std::sqrt(glow.areas[e]));
    return glow;
}

struct Furnace {
    std::size_t elements = 0;
    bool occluded = false;
    double tolerance = 0.0, sight_tolerance = 0.0; ///< of blocks, as derived from accuracy and reflectances
    double defect = 0.0;                           ///< largest |row sum - 1| of an element
    double error_l2 = 0.0, error_worst = 0.0; ///< of radiosity: relative L2, and of the worst element's mean
    double seconds = 0.0;                     ///< CPU
};

Furnace furnace(const support::ClosedRoom& room, double rho, double accuracy, double element_size) {
    model::Scene scene = support::plain_scene(1, rho, 1.0);
    const Glow glow = glow_of(room.set, scene, accuracy, element_size);
    Furnace result{.elements = glow.elements.size(),
                   .occluded = glow.options.occlusion,
                   .tolerance = glow.options.tolerance,
                   .sight_tolerance = glow.options.sight_tolerance,
                   .seconds = glow.seconds};
    for (const double sum : coefficients::element_row_sums(glow.transport, glow.elements))
        result.defect = std::max(result.defect, std::abs(sum - 1.0));
    const std::vector<double> ones(glow.elements.size(), 1.0);
    const auto exitance = constant_coefficients(glow.transport.layout, 1, glow.areas, ones);
    double difference = 0.0, norm = 0.0;
    for (std::size_t k = 0; k < exitance.size(); ++k) {
        const double expected = exitance[k] / (1.0 - rho);
        difference += std::pow(glow.radiosity[k] - expected, 2.0);
        norm += expected * expected;
    }
    result.error_l2 = std::sqrt(difference / norm);
    for (const double mean : glow.means)
        result.error_worst = std::max(result.error_worst, std::abs(mean * (1.0 - rho) - 1.0));
    return result;
}

// Pieces of at most this share of the longest edge: coarse, because constant light needs no more.
void expect_even_glow(double accuracy, double share) {
    fmt::print("| room | rho | elements | tolerance: clear, hidden in part | largest row defect | radiosity, "
               "relative L2 "
               "| worst element | CPU seconds |\n|---|---|---|---|---|---|---|---|\n");
    for (const support::ClosedRoom& room : support::closed_rooms())
        for (const double rho : {0.5, 0.9, 0.99}) {
            const Furnace found = furnace(room, rho, accuracy, share * room.longest_edge);
            fmt::print("| {} | {} | {} | {:.1e}, {:.1e} | {:.1e} | {:.1e} | {:.1e} | {:.2f} |\n", room.name,
                       rho, found.elements, found.tolerance, found.sight_tolerance, found.defect,
                       found.error_l2, found.error_worst, found.seconds);
            const double tolerance = found.occluded ? found.sight_tolerance : found.tolerance;
            EXPECT_LT(found.defect, 3.0 * tolerance) << room.name << ", rho " << rho;
            EXPECT_LT(found.error_l2, accuracy) << room.name << ", rho " << rho;
            EXPECT_LT(found.error_worst, accuracy) << room.name << ", rho " << rho;
        }
}

TEST(Furnace, closed_rooms_glow_evenly_within_3_percent) { expect_even_glow(0.03, 0.34); }
TEST(Furnace, closed_rooms_glow_evenly_within_1e_4) { expect_even_glow(1e-4, 0.5); }

// Most of what the scene has is black, so its mean reflectance promises few bounces; the cavity has hundreds.
TEST(Furnace, white_cavity_in_a_dark_hall_glows_evenly) {
    const double rho = 0.99, accuracy = 0.03;
    support::ClosedRoom hall = support::closed_rooms().back();
    const std::size_t cavity = hall.set.patches.size();
    for (const auto& [low, high, facing] : {std::tuple{Vec3(-0.01), Vec3(1.01), support::Facing::Outwards},
                                            std::tuple{Vec3(-2.0), Vec3(3.0), support::Facing::Inwards}})
        for (model::Patch& patch : support::box(low, high, facing)) {
            patch.material = MaterialId(1);
            hall.set.patches.push_back(patch);
        }
    model::Scene scene = support::plain_scene(1, rho, 1.0);
    scene.materials.push_back({"black", {0.05}, {0.0}, model::Sides::Front});
    const Glow glow = glow_of(hall.set, scene, accuracy, 1.0);
    double worst = 0.0;
    for (std::size_t e = 0; e < glow.means.size(); ++e)
        if (glow.patches[e] < cavity) worst = std::max(worst, std::abs(glow.means[e] * (1.0 - rho) - 1.0));
    RecordProperty("worst_element", fmt::format("{:.1e}", worst));
    EXPECT_LT(worst, accuracy);
}

// A lamp of a millionth of the room's area: beside what it emits all that walls send back is small, and is what counts.
TEST(Furnace, all_light_of_a_tiny_lamp_is_absorbed) {
    const double rho = 0.9, accuracy = 0.03, low = 0.5, high = 0.5025;
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(1), support::Facing::Inwards);
    set.patches[0] = support::frame_patch(Vec3(0), {1, 0, 0}, {0, 1, 0}, Vec2(low), Vec2(high));
    set.patches.push_back(
        support::rectangle({low, low, 0}, {high - low, 0, 0}, {0, high - low, 0}, {}, MaterialId(1)));
    model::Scene scene = support::plain_scene(1, rho, 0.0);
    scene.materials.push_back({"lamp", {rho}, {1.0}, model::Sides::Front});
    const Glow glow = glow_of(set, scene, accuracy, 0.5);
    double absorbed = 0.0, emitted = 0.0;
    for (std::size_t e = 0; e < glow.means.size(); ++e) {
        const double exitance = scene.materials[glow.elements[e].material.value].exitance.front();
        absorbed += glow.areas[e] * (glow.means[e] - exitance) * (1.0 - rho) / rho;
        emitted += glow.areas[e] * exitance;
    }
    RecordProperty("lost", fmt::format("{:.1e}", 1.0 - absorbed / emitted));
    EXPECT_NEAR(absorbed / emitted, 1.0, 0.2 * accuracy);
}

} // namespace
} // namespace kinelux::solve
