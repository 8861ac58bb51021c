// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/animation.h"

#include <gtest/gtest.h>

#include "coefficients/coefficients.h"
#include "motion/exact_engine.h"
#include "support/shapes.h"

namespace kinelux {
namespace {

/// A closed room whose ceiling shines, in channels of one colour.
struct Room {
    model::Scene scene;
    model::PatchSet patches;
    model::ClusterTree tree;
    model::Plan plan;

    Room() {
        scene.channels = {"a", "b"};
        scene.materials = {{.name = "wall", .reflectance = {0.5, 0.5}, .exitance = {0.0, 0.0}},
                           {.name = "lamp", .reflectance = {0.2, 0.2}, .exitance = {2.0, 6.0}}};
        scene.objects.resize(1);
        patches.patches = support::box(Vec3(0.0), Vec3(1.0), support::Facing::Inwards);
        patches.patches[1].material = MaterialId(1);
        tree = support::uniform_elements(patches, 2);
        plan.degree = 1;
        plan.bounces = 10;
        plan.static_occlusion = plan.moving_occlusion = false;
    }

    model::Solution solve(const std::vector<std::uint32_t>& frames = {0}) const {
        const auto shapes = geometry::element_shapes(patches, tree, plan.degree, 0);
        visibility::Occluders occluders(visibility::bodies_of(patches, scene));
        const auto options = coefficients::transport_options_for(scene, plan, shapes);
        const auto blocks = coefficients::compute_coefficients(shapes, scene, plan, occluders, options, 1e6);
        motion::ExactEngine engine(blocks, shapes, plan, occluders, options);
        std::vector<double> areas;
        areas.reserve(shapes.size());
        for (const auto& shape : shapes) areas.push_back(shape.area);
        return solve::solve_animation({scene, plan, blocks, tree.elements, areas}, engine, frames, {},
                                      [](const model::FrameSolution&) {});
    }
};

TEST(Animation, one_solved_channel_scaled_equals_all_channels_solved) {
    Room room;
    const auto all = room.solve();
    room.plan.single_channel = true;
    const auto one = room.solve();
    ASSERT_EQ(one.channels, 2u);
    ASSERT_EQ(one.frames[0].radiosity.size(), all.frames[0].radiosity.size());
    for (std::size_t k = 0; k < all.frames[0].radiosity.size(); ++k)
        EXPECT_NEAR(one.frames[0].radiosity[k], all.frames[0].radiosity[k], 1e-3);
}

TEST(Animation, without_bounces_radiosity_is_direct_light_reflected_once) {
    Room room;
    room.plan.bounces = 0;
    const auto frame = room.solve().frames[0];
    for (const double value : frame.irradiance_indirect) EXPECT_EQ(value, 0.0);
    // Element 0 lies on the floor; its first function is constant.
    EXPECT_GT(frame.irradiance_direct[0], 0.0);
    EXPECT_DOUBLE_EQ(frame.radiosity[0], 0.5 * frame.irradiance_direct[0]);
}

TEST(Animation, error_estimate_is_small_and_positive_where_blocks_are_good) {
    const auto frame = Room().solve().frames[0];
    EXPECT_GT(frame.error_estimate, 0.0);
    EXPECT_LT(frame.error_estimate, 0.05);
    EXPECT_EQ(frame.element_error.size(), 24u);
    EXPECT_TRUE(frame.converged);
}

TEST(Animation, a_scene_at_rest_is_solved_once_for_all_frames) {
    Room room;
    room.scene.time = {0.0, 2.0, 3};
    const auto frames = room.solve({0, 1, 2}).frames;
    ASSERT_EQ(frames.size(), 3u);
    EXPECT_GT(frames[0].sweeps, 0.0);
    for (const std::uint32_t f : {1u, 2u}) {
        EXPECT_EQ(frames[f].sweeps, 0.0);
        EXPECT_EQ(frames[f].radiosity, frames[0].radiosity);
        EXPECT_EQ(frames[f].frame, f);
        EXPECT_EQ(frames[f].time_s, f);
    }
}

/// The exact engine, noting the times it is asked for.
class NotingEngine : public motion::Engine {
public:
    NotingEngine(motion::Engine& engine, bool has_memory) : engine_(engine), has_memory_(has_memory) {}
    motion::FrameBlocks advance(double time_s, std::span<const geometry::Pose> poses) override {
        times.push_back(time_s);
        return engine_.advance(time_s, poses);
    }
    bool remembers() const override { return has_memory_; }
    std::vector<double> times;

private:
    motion::Engine& engine_;
    bool has_memory_;
};

TEST(Animation, taken_up_again_gives_the_same_frames_and_leads_engines_with_a_memory_through_those_before) {
    Room room;
    room.patches.patches.push_back(
        support::rectangle(Vec3(0.2, 0.2, 0.5), Vec3(0.0, 0.3, 0.0), Vec3(0.3, 0.0, 0.0), ObjectId(1)));
    room.scene.objects.resize(2);
    room.scene.motions = {
        {.name = "slide",
         .keyframes = {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)}, {1.0, Vec3(0.4, 0.0, 0.0), Quat(1, 0, 0, 0)}}}};
    room.scene.objects[1].motion = MotionId(0);
    room.scene.time = {0.0, 1.0, 6};
    room.plan.moving_objects = {ObjectId(1)};
    room.tree = support::uniform_elements(room.patches, 2);
    const auto shapes = geometry::element_shapes(room.patches, room.tree, 1, 0);
    visibility::Occluders occluders(visibility::bodies_of(room.patches, room.scene));
    const auto options = coefficients::transport_options_for(room.scene, room.plan, shapes);
    const auto blocks =
        coefficients::compute_coefficients(shapes, room.scene, room.plan, occluders, options, 1e6);
    motion::ExactEngine exact(blocks, shapes, room.plan, occluders, options);
    std::vector<double> areas;
    areas.reserve(shapes.size());
    for (const auto& shape : shapes) areas.push_back(shape.area);
    const solve::Animation animation{room.scene, room.plan, blocks, room.tree.elements, areas};
    const std::vector<std::uint32_t> frames{0, 1, 2, 3, 4, 5};
    model::SolutionSoFar left;
    const auto whole = solve::solve_animation(
        animation, exact, frames, {}, [](const auto&) {},
        {.save = [&](const model::Solution& solution, const model::SolverState& state) {
            if (solution.frames.size() == 3) left = {solution, state};
        }});
    for (const bool has_memory : {false, true}) {
        NotingEngine engine(exact, has_memory);
        const auto again =
            solve::solve_animation(animation, engine, frames, {}, [](const auto&) {}, {.from = left});
        ASSERT_EQ(again.frames.size(), 6u);
        for (std::size_t f = 0; f < 6; ++f) EXPECT_EQ(again.frames[f].radiosity, whole.frames[f].radiosity);
        EXPECT_EQ(engine.times.size(), has_memory ? 6u : 4u);
        EXPECT_DOUBLE_EQ(engine.times.front(), has_memory ? 0.0 : 0.4);
    }
}

/// Counts how often blocks are asked for.
struct CountingEngine : motion::Engine {
    int advances = 0;
    motion::FrameBlocks advance(double, std::span<const geometry::Pose>) override {
        ++advances;
        return {};
    }
};

TEST(Animation, dimmed_lamps_over_bodies_at_rest_scale_the_light_and_recompute_no_block) {
    Room room;
    room.scene.time = {0.0, 4.0, 5};
    room.scene.dimmings = {{"evening",
                            model::Interpolation::Linear,
                            {{0.0, 1.0}, {1.0, 0.5}, {2.0, 0.5}, {3.0, 0.0}, {4.0, 2.0}}}};
    room.scene.materials[1].dimming = DimmingId(0);
    const auto shapes = geometry::element_shapes(room.patches, room.tree, room.plan.degree, 0);
    const visibility::Occluders occluders(visibility::bodies_of(room.patches, room.scene));
    const auto blocks = coefficients::compute_coefficients(shapes, room.scene, room.plan, occluders, {}, 1e6);
    std::vector<double> areas;
    areas.reserve(shapes.size());
    for (const auto& shape : shapes) areas.push_back(shape.area);
    for (const std::uint32_t bounces : {10u, 0u}) {
        room.plan.bounces = bounces;
        CountingEngine engine;
        const std::vector<std::uint32_t> all{0, 1, 2, 3, 4};
        const auto frames = solve::solve_animation({room.scene, room.plan, blocks, room.tree.elements, areas},
                                                   engine, all, {.tolerance = 1e-10}, [](const auto&) {})
                                .frames;
        EXPECT_EQ(engine.advances, 1);
        EXPECT_GT(frames[1].sweeps, 0.0);
        EXPECT_EQ(frames[2].sweeps, 0.0) << "the lamp has not changed since the frame before";
        const std::vector<double> factors{1.0, 0.5, 0.5, 0.0, 2.0};
        for (std::size_t f = 0; f < factors.size(); ++f) {
            EXPECT_EQ(frames[f].blocks_recomputed, 0u);
            for (std::size_t k = 0; k < frames[0].radiosity.size(); ++k)
                ASSERT_NEAR(frames[f].radiosity[k], factors[f] * frames[0].radiosity[k], 1e-8)
                    << "frame " << f;
        }
    }
}

TEST(BlocksAt, frame_blocks_take_the_place_of_static_ones_and_missing_ones_are_zero) {
    const model::BlockSet fixed{.entries = {{0, 1, 0, 0.1f}, {0, 2, 1, 0.2f}, {1, 2, 2, 0.3f}},
                                .values = {1.0f, 2.0f, 3.0f}};
    motion::FrameBlocks frame;
    frame.pairs = {{0, 0}, {0, 2}, {1, 2}};
    frame.blocks = {.entries = {{0, 0, 0, 0.0f}, {1, 2, 1, 0.0f}}, .values = {7.0f, 8.0f}};
    const model::BlockSet now = solve::blocks_at(fixed, frame);
    ASSERT_EQ(now.entries.size(), 3u);
    EXPECT_EQ(now.entries[0].j, 0u);
    EXPECT_EQ(now.values[now.entries[0].offset], 7.0f);
    EXPECT_EQ(now.values[now.entries[1].offset], 1.0f);
    EXPECT_EQ(now.values[now.entries[2].offset], 8.0f);
}

TEST(IrradianceErrors, follow_block_errors_and_brightness) {
    const model::UnknownLayout layout{{0, 1, 2}};
    const std::vector<model::BlockEntry> entries{{0, 1, 0, 0.5f}};
    const std::vector<double> areas{1.0, 4.0}, exitance{3.0, 0.0};
    model::FrameSolution frame;
    frame.radiosity = {3.0, 2.0};
    frame.irradiance_indirect = {0.0, 0.0};
    const auto errors = solve::irradiance_errors(layout, entries, areas, exitance, frame, 1);
    EXPECT_FLOAT_EQ(errors[0], 1.0f);  // 0.5 * 2 / sqrt(1)
    EXPECT_FLOAT_EQ(errors[1], 0.75f); // 0.5 * 3 / sqrt(4)
}

TEST(IrradianceErrors, let_degrees_fall_on_for_what_the_basis_leaves_out) {
    const model::UnknownLayout layout{{0, 6, 7, 10, 13}}; // degree 2, 0, 1, 1
    const std::vector<double> areas{4.0, 1.0, 1.0, 1.0}, exitance(13, 0.0);
    model::FrameSolution frame;
    frame.radiosity.assign(13, 0.0);
    frame.irradiance_indirect = {9.0, 6.0, 0.0, 1.0, 2.0, 2.0, 7.0, 9.0, 0.9, 0.0, 1.0, 3.0, 4.0};
    const auto errors = solve::irradiance_errors(layout, {}, areas, exitance, frame, 1);
    EXPECT_FLOAT_EQ(errors[0], 0.75f); // sqrt((1 + 4 + 4) / 4) * 3 / 6
    EXPECT_FLOAT_EQ(errors[1], 0.7f);  // a tenth of a constant
    EXPECT_FLOAT_EQ(errors[2], 0.27f); // no faster than by 0.3
    EXPECT_FLOAT_EQ(errors[3], 5.0f);  // not at all
}

} // namespace
} // namespace kinelux
