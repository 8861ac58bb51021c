// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include <gtest/gtest.h>

#include "coefficients/coefficients.h"
#include "motion/frame_blocks.h"
#include "solve/solve.h"
#include "support/shapes.h"

namespace kinelux::solve {
namespace {

struct Computed {
    std::vector<geometry::ElementShape> shapes;
    model::Coefficients coefficients;
};

Computed compute(const model::PatchSet& set, const model::Scene& scene, int n, int degree) {
    Computed result;
    result.shapes = support::shapes_of(set, n, degree);
    const auto occluders = support::occluders_of(set, scene);
    result.coefficients = coefficients::compute_coefficients(result.shapes, scene, {.degree = degree},
                                                             occluders, {.tolerance = 1e-3}, 1e6);
    return result;
}

std::vector<double> areas_of(const std::vector<geometry::ElementShape>& shapes) {
    std::vector<double> areas;
    for (const auto& shape : shapes) areas.push_back(shape.area);
    return areas;
}

// Uniform M and rho in a closed scene: B = M / (1 - rho) everywhere.
double furnace_error(double rho) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(1.0, 1.5, 0.8), support::Facing::Inwards);
    const auto scene = support::plain_scene(1, rho, 1.0);
    const auto [shapes, coefficients] = compute(set, scene, 3, 2);
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

TEST(Furnace, form_factor_rows_of_objects_sum_to_one) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(2, 3, 1), support::Facing::Inwards);
    for (const auto& patch :
         support::box(Vec3(0.7, 0.8, 0.2), Vec3(1.2, 1.5, 0.6), support::Facing::Outwards)) {
        set.patches.push_back(patch);
        set.patches.back().object = ObjectId(1);
    }
    const auto [shapes, coefficients] = compute(set, support::plain_scene(2), 3, 2);
    std::vector<std::uint32_t> groups;
    for (const auto& shape : shapes) groups.push_back(shape.object.value);
    const auto factors = coefficients::form_factors(coefficients, shapes, groups, 2);
    ASSERT_EQ(factors.size(), 4u);
    const double room_area = 22.0, block_area = 2 * (0.5 * 0.7 + 0.5 * 0.4 + 0.7 * 0.4);
    EXPECT_NEAR(factors[0].value + factors[1].value, 1.0, 0.01);
    EXPECT_NEAR(factors[2].value + factors[3].value, 1.0, 0.01);
    EXPECT_NEAR(factors[3].value, 0.0, 1e-12) << "a convex body does not see itself";
    EXPECT_NEAR(factors[1].value * room_area, block_area, 0.01 * block_area)
        << "all its light reaches the room";
}

// A box room with a lamp that slides under the ceiling.
struct LampRoom {
    model::PatchSet set;
    model::Scene scene = support::plain_scene(3, 0.6);
    model::Plan plan{.degree = 2, .moving_objects = {ObjectId(1)}};

    explicit LampRoom(bool with_shelf) {
        set.patches = support::box(Vec3(0), Vec3(2, 2, 2), support::Facing::Inwards);
        set.patches.push_back(
            support::rectangle(Vec3(0.2, 0.8, 1.8), Vec3(0, 0.4, 0), Vec3(0.4, 0, 0), ObjectId(1)));
        if (with_shelf)
            set.patches.push_back(
                support::rectangle(Vec3(0.5, 0.5, 1.0), Vec3(1, 0, 0), Vec3(0, 1, 0), ObjectId(2)));
        model::Motion motion;
        motion.name = "slide";
        motion.keyframes = {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)}, {1.0, Vec3(1.2, 0.0, 0.0), Quat(1, 0, 0, 0)}};
        scene.motions = {motion};
        scene.objects[1].motion = MotionId(0);
        scene.time = {0.0, 1.0, 5};
    }
    visibility::Occluders occluders() const {
        auto bodies = visibility::bodies_of(set, scene);
        bodies[1].moves = true;
        return visibility::Occluders(std::move(bodies));
    }
};

// The same room built anew with the lamp where it is at a time, everything at rest.
model::Coefficients from_scratch(const LampRoom& room, double time_s, int n) {
    LampRoom still = room;
    const auto pose = geometry::pose_at(room.scene.motions[0], time_s);
    for (auto& patch : still.set.patches)
        if (patch.object == ObjectId(1)) patch.surface.origin = pose.point(patch.surface.origin);
    still.scene.objects[1].motion.reset();
    const auto shapes = support::shapes_of(still.set, n, 2);
    const auto occluders = support::occluders_of(still.set, still.scene);
    return coefficients::compute_coefficients(shapes, still.scene, {.degree = 2}, occluders,
                                              {.tolerance = 1e-3}, 1e6);
}

TEST(FrameUpdater, frames_equal_a_scene_built_anew) {
    for (const bool with_shelf : {false, true}) {
        LampRoom room(with_shelf);
        const int n = 4;
        const auto shapes = support::shapes_of(room.set, n, 2);
        auto occluders = room.occluders();
        const kernel::TransportOptions options{.tolerance = 1e-3};
        const auto coefficients =
            coefficients::compute_coefficients(shapes, room.scene, room.plan, occluders, options, 1e6);
        motion::FrameUpdater updater(coefficients, shapes, room.scene, room.plan, occluders, options);
        BlockOperator moving(coefficients.layout, coefficients.static_blocks);
        std::vector<double> x(coefficients.layout.unknowns());
        for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::sin(static_cast<double>(k));
        std::vector<double> y(x.size()), expected(x.size());
        for (const double time : {0.0, 0.5, 1.0, 0.25}) {
            const auto frame = updater.at(time);
            moving.replace(frame.pairs, frame.blocks);
            apply(moving, 1, x, y);
            const auto anew = from_scratch(room, time, n);
            const BlockOperator still(anew.layout, anew.static_blocks);
            apply(still, 1, x, expected);
            double difference = 0.0, size = 0.0;
            for (std::size_t k = 0; k < x.size(); ++k) {
                difference += (y[k] - expected[k]) * (y[k] - expected[k]);
                size += expected[k] * expected[k];
            }
            // What differs is which rays sample the shadow of the lamp.
            EXPECT_LT(std::sqrt(difference / size), 0.02) << "time " << time << " shelf " << with_shelf;
        }
    }
}

} // namespace
} // namespace kinelux::solve
