// SPDX-License-Identifier: GPL-3.0-or-later
// Transport with links between groups, against all pairs of elements.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "coefficients/coefficients.h"
#include "core/error.h"
#include "core/parallel.h"
#include "motion/exact_engine.h"
#include "solve/animation.h"
#include "support/shapes.h"

namespace kinelux::solve {
namespace {

using coefficients::Grouping;

// A room with a screen across it, a box and a lamp.
struct Rooms {
    model::PatchSet set;
    model::Scene scene = support::plain_scene(2, 0.6);
    model::Plan plan{.degree = 1, .bounces = 20};
    std::vector<geometry::ElementShape> shapes;
    std::vector<double> areas;

    explicit Rooms(int n, int degree = 1) {
        set.patches = support::box(Vec3(0), Vec3(6, 3, 2.5), support::Facing::Inwards);
        for (const auto& [low, high] : {std::pair(Vec3(2.9, 0.3, 0.3), Vec3(3.1, 2.7, 1.9)),
                                        std::pair(Vec3(0.8, 0.9, 0.25), Vec3(1.5, 1.9, 0.8)),
                                        std::pair(Vec3(4.2, 1.2, 2.2), Vec3(4.8, 1.8, 2.3))})
            for (const auto& patch : support::box(low, high, support::Facing::Outwards))
                set.patches.push_back(patch);
        for (std::size_t p = set.patches.size() - 6; p < set.patches.size(); ++p)
            set.patches[p].material = MaterialId(1);
        scene.materials.push_back({"lamp", {0.6}, {40.0}, model::Sides::Front});
        scene.accuracy.target = 0.02;
        plan.degree = degree;
        shapes = support::shapes_of(set, n, degree);
        for (const auto& shape : shapes) areas.push_back(shape.area);
    }
    model::Coefficients compute(Grouping use) const {
        const auto occluders = support::occluders_of(set, scene);
        return coefficients::compute_coefficients(shapes, scene, plan, occluders, {.tolerance = 2e-3}, 1e6,
                                                  {.use = use});
    }
    SystemSolution solve(const TransportOperator& transport, double rho, double exitance_of_all) const {
        std::vector<double> exitance, reflectance(shapes.size(), rho);
        for (const auto& shape : shapes)
            exitance.push_back(exitance_of_all + scene.materials[shape.material.value].exitance[0]);
        return solve_system(
            {transport, 1, constant_coefficients(transport.layout(), 1, areas, exitance), reflectance, areas},
            {.tolerance = 1e-6}, {});
    }
};

double relative_difference(const std::vector<double>& x, const std::vector<double>& y) {
    double difference = 0.0, size = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        difference += (x[k] - y[k]) * (x[k] - y[k]);
        size += y[k] * y[k];
    }
    return std::sqrt(difference / size);
}

TEST(LinkedOperator, irradiance_differs_from_that_of_all_pairs_by_less_than_the_accuracy) {
    for (const int degree : {0, 1}) {
        const Rooms rooms(degree == 0 ? 7 : 6, degree);
        const auto all = rooms.compute(Grouping::Never), linked = rooms.compute(Grouping::Always);
        ASSERT_GT(linked.hierarchy.links.entries.size(), 100u);
        ASSERT_LT(linked.static_blocks.entries.size() + linked.hierarchy.links.entries.size(),
                  all.static_blocks.entries.size() / 2);
        const BlockOperator dense(all.layout, all.static_blocks), blocks(linked.layout, linked.static_blocks);
        const auto expected = rooms.solve(dense, 0.6, 0.0);
        const auto found = rooms.solve(LinkedOperator(blocks, linked.hierarchy), 0.6, 0.0);
        EXPECT_TRUE(found.converged);
        const double difference = relative_difference(found.irradiance, expected.irradiance);
        RecordProperty("difference_degree_" + std::to_string(degree), std::to_string(difference));
        EXPECT_LT(difference, rooms.scene.accuracy.target);
    }
}

TEST(LinkedOperator, closed_scene_glows_evenly) {
    Rooms rooms(5);
    rooms.scene.materials[1].exitance = {0.0};
    const auto linked = rooms.compute(Grouping::Always);
    const BlockOperator blocks(linked.layout, linked.static_blocks);
    const auto solution = rooms.solve(LinkedOperator(blocks, linked.hierarchy), 0.5, 1.0);
    double error = 0.0, area = 0.0;
    for (std::size_t e = 0; e < rooms.shapes.size(); ++e) {
        const double mean = solution.radiosity[linked.layout.offsets[e]] / std::sqrt(rooms.areas[e]);
        error += rooms.areas[e] * (mean - 2.0) * (mean - 2.0);
        area += rooms.areas[e] * 4.0;
    }
    EXPECT_LT(std::sqrt(error / area), rooms.scene.accuracy.target);
}

TEST(LinkedOperator, is_symmetric) {
    const Rooms rooms(4);
    const auto linked = rooms.compute(Grouping::Always);
    const BlockOperator blocks(linked.layout, linked.static_blocks);
    const LinkedOperator transport(blocks, linked.hierarchy);
    std::vector<double> u(linked.layout.unknowns()), v(u.size()), to_u(u.size()), to_v(u.size());
    for (std::size_t k = 0; k < u.size(); ++k) {
        u[k] = std::sin(static_cast<double>(k));
        v[k] = std::cos(1.7 * static_cast<double>(k)) + 0.5;
    }
    transport.apply(1, v, to_u);
    transport.apply(1, u, to_v);
    double left = 0.0, right = 0.0, scale = 0.0;
    for (std::size_t k = 0; k < u.size(); ++k) {
        left += u[k] * to_u[k];
        right += v[k] * to_v[k];
        scale += std::abs(u[k] * to_u[k]);
    }
    EXPECT_NEAR(left, right, 1e-12 * scale);
}

TEST(LinkedOperator, is_the_same_bytes_on_one_thread_and_two) {
    const Rooms rooms(4);
    core::set_thread_count(1);
    const auto one = rooms.compute(Grouping::Always);
    core::set_thread_count(2);
    const auto two = rooms.compute(Grouping::Always);
    core::set_thread_count(0);
    EXPECT_EQ(one.hierarchy.links.values, two.hierarchy.links.values);
    EXPECT_EQ(one.hierarchy.restrictions, two.hierarchy.restrictions);
    EXPECT_EQ(one.static_blocks.values, two.static_blocks.values);
}

TEST(ConjugateGradients, need_far_fewer_sweeps_than_gauss_seidel_between_bright_walls) {
    const Rooms rooms(2);
    const auto all = rooms.compute(Grouping::Never);
    const BlockOperator blocks(all.layout, all.static_blocks);
    const std::vector<double> exitance = constant_coefficients(all.layout, 1, rooms.areas,
                                                               std::vector<double>(rooms.shapes.size(), 1.0)),
                              rho(rooms.shapes.size(), 0.95);
    const auto sweeps = [&](Method method) {
        const auto solution =
            solve_system({blocks, 1, exitance, rho, rooms.areas}, {.method = method, .tolerance = 1e-6}, {});
        EXPECT_TRUE(solution.converged);
        return solution.sweeps;
    };
    EXPECT_LT(2 * sweeps(Method::ConjugateGradients), sweeps(Method::GaussSeidel));
}

TEST(LinkedOperator, shooting_is_refused) {
    const Rooms rooms(4);
    const auto linked = rooms.compute(Grouping::Always);
    const BlockOperator blocks(linked.layout, linked.static_blocks);
    const LinkedOperator transport(blocks, linked.hierarchy);
    const std::vector<double> ones(linked.layout.unknowns(), 1.0), rho(rooms.shapes.size(), 0.5);
    EXPECT_THROW(solve_system({transport, 1, ones, rho, rooms.areas}, {.method = Method::Shooting}, {}),
                 core::OptionError);
}

// Whether the lamp's ball meets the segment at the start, half way, or the end of its way down.
bool lamp_cuts(const Vec3& from, const Vec3& to) {
    const double radius = 0.5 * glm::length(Vec3(0.6, 0.6, 0.1));
    bool cuts = false;
    for (const double sunk : {0.0, 0.9, 1.8}) {
        const Vec3 centre(4.5, 1.5, 2.25 - sunk), axis = to - from;
        const double t = std::clamp(glm::dot(centre - from, axis) / glm::dot(axis, axis), 0.0, 1.0);
        cuts = cuts || glm::distance(centre, from + t * axis) < radius;
    }
    return cuts;
}

// The lamp sinks to the floor.
TEST(LinkedOperator, frames_with_a_moving_lamp_equal_those_of_all_pairs) {
    Rooms rooms(5);
    for (std::size_t p = rooms.set.patches.size() - 6; p < rooms.set.patches.size(); ++p)
        rooms.set.patches[p].object = ObjectId(1);
    rooms.shapes = support::shapes_of(rooms.set, 5, 1);
    model::Motion motion;
    motion.name = "sink";
    motion.keyframes = {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)}, {1.0, Vec3(0.0, 0.0, -1.8), Quat(1, 0, 0, 0)}};
    rooms.scene.motions = {motion};
    rooms.scene.objects[1].motion = MotionId(0);
    rooms.scene.time = {0.0, 1.0, 3};
    rooms.plan.moving_objects = {ObjectId(1)};
    auto bodies = visibility::bodies_of(rooms.set, rooms.scene);
    bodies[1].moves = true;
    visibility::Occluders occluders(std::move(bodies));
    const kernel::TransportOptions options{.tolerance = 2e-3};
    const auto tree = support::uniform_elements(rooms.set, 5);
    const std::vector<std::uint32_t> frames{0, 1, 2};
    const auto solved = [&](Grouping use) {
        const auto coefficients = coefficients::compute_coefficients(rooms.shapes, rooms.scene, rooms.plan,
                                                                     occluders, options, 1e6, {.use = use});
        EXPECT_FALSE(coefficients.crossed_pairs.empty());
        motion::ExactEngine engine(coefficients, rooms.shapes, rooms.plan, occluders, options);
        auto solution = solve_animation({rooms.scene, rooms.plan, coefficients, tree.elements, rooms.areas},
                                        engine, frames, {.tolerance = 1e-6}, [](const auto&) {});
        return std::pair(std::move(solution), coefficients.crossed_pairs);
    };
    const auto [expected, crossed] = solved(Grouping::Never);
    const auto [found, crossed_linked] = solved(Grouping::Always);
    EXPECT_TRUE(std::includes(crossed.begin(), crossed.end(), crossed_linked.begin(), crossed_linked.end()));
    for (const model::ElementPair& pair : crossed) {
        const bool surely = lamp_cuts(rooms.shapes[pair.i].centre, rooms.shapes[pair.j].centre);
        EXPECT_TRUE(!surely || std::binary_search(crossed_linked.begin(), crossed_linked.end(), pair))
            << "the lamp passes between " << pair.i << " and " << pair.j << ", which a link holds";
    }
    for (std::size_t f = 0; f < frames.size(); ++f)
        EXPECT_LT(relative_difference(found.frames[f].radiosity, expected.frames[f].radiosity),
                  rooms.scene.accuracy.target)
            << "frame " << f;
}

} // namespace
} // namespace kinelux::solve
