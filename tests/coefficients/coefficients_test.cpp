// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/parallel.h"
#include "support/computed.h"

namespace kinelux::coefficients {
namespace {

TEST(FormFactors, rows_of_objects_sum_to_one) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(2, 3, 1), support::Facing::Inwards);
    for (const auto& patch :
         support::box(Vec3(0.7, 0.8, 0.2), Vec3(1.2, 1.5, 0.6), support::Facing::Outwards)) {
        set.patches.push_back(patch);
        set.patches.back().object = ObjectId(1);
    }
    const auto [shapes, coefficients] = support::compute(set, support::plain_scene(2), 3, 2);
    std::vector<std::uint32_t> groups;
    groups.reserve(shapes.size());
    for (const auto& shape : shapes) groups.push_back(shape.object.value);
    const auto factors = form_factors(coefficients, shapes, groups, 2);
    ASSERT_EQ(factors.size(), 4u);
    const double room_area = 22.0, block_area = 2 * (0.5 * 0.7 + 0.5 * 0.4 + 0.7 * 0.4);
    EXPECT_NEAR(factors[0].value + factors[1].value, 1.0, 0.01);
    EXPECT_NEAR(factors[2].value + factors[3].value, 1.0, 0.01);
    EXPECT_NEAR(factors[3].value, 0.0, 1e-12) << "a convex body does not see itself";
    EXPECT_NEAR(factors[1].value * room_area, block_area, 0.01 * block_area)
        << "all its light reaches the room";
}

TEST(Coefficients, more_blocks_than_memory_allows_are_refused_before_work_starts) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(1), support::Facing::Inwards);
    const auto scene = support::plain_scene(1);
    const auto shapes = support::shapes_of(set, 4, 2);
    const auto occluders = support::occluders_of(set, scene);
    EXPECT_THROW(compute_coefficients(shapes, scene, {.degree = 2}, occluders, {}, 0.1), core::ResourceError);
}

TEST(Coefficients, groups_are_linked_from_a_number_of_elements_on_that_can_be_chosen) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(1), support::Facing::Inwards);
    const auto scene = support::plain_scene(1);
    const auto shapes = support::shapes_of(set, 4, 0);
    const auto occluders = support::occluders_of(set, scene);
    const auto links = [&](const GroupingOptions& grouping) {
        return compute_coefficients(shapes, scene, {.degree = 0}, occluders, {}, 1e6, grouping)
            .hierarchy.links;
    };
    EXPECT_TRUE(links({.most_elements = shapes.size()}).entries.empty());
    EXPECT_FALSE(links({.most_elements = shapes.size() - 1}).entries.empty());
    EXPECT_TRUE(links({.use = Grouping::Never, .most_elements = 1}).entries.empty());
}

TEST(FormFactors, rows_of_objects_sum_to_one_through_links) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(2, 3, 1), support::Facing::Inwards);
    for (std::size_t p = 3; p < 6; ++p) set.patches[p].object = ObjectId(1);
    const auto scene = support::plain_scene(2);
    const auto shapes = support::shapes_of(set, 6, 0);
    const auto occluders = support::occluders_of(set, scene);
    const auto coefficients =
        compute_coefficients(shapes, scene, {.degree = 0}, occluders, {}, 1e6, {.use = Grouping::Always});
    ASSERT_FALSE(coefficients.hierarchy.links.entries.empty());
    std::vector<std::uint32_t> groups;
    groups.reserve(shapes.size());
    for (const auto& shape : shapes) groups.push_back(shape.object.value);
    const auto factors = form_factors(coefficients, shapes, groups, 2);
    EXPECT_NEAR(factors[0].value + factors[1].value, 1.0, 0.02);
    EXPECT_NEAR(factors[2].value + factors[3].value, 1.0, 0.02);
}

// Two squares that face each other across a gap and glide together along x, from x = 0 to x = 4, and a square across
// the gap at a place of the way.
struct Carriage {
    model::PatchSet set;
    model::Scene scene = support::plain_scene(3);
    model::Plan plan{.degree = 0, .moving_objects = {ObjectId(0), ObjectId(1)}};

    explicit Carriage(double screen_x) {
        set.patches = {support::rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, ObjectId(0)),
                       support::rectangle({0, 0, 1}, {0, 1, 0}, {1, 0, 0}, ObjectId(1)),
                       support::rectangle({screen_x, 0, 0.5}, {0.5, 0, 0}, {0, 1, 0}, ObjectId(2))};
        scene.time = {0.0, 1.0, 9};
        scene.motions = {{"glide",
                          model::Interpolation::Linear,
                          Vec3(0),
                          {{0.0, Vec3(0), Quat(1, 0, 0, 0)}, {1.0, Vec3(4, 0, 0), Quat(1, 0, 0, 0)}}}};
        scene.objects[0].motion = scene.objects[1].motion = MotionId(0);
    }
    model::Coefficients compute() const {
        const auto shapes = support::shapes_of(set, 1, 0);
        const auto occluders = support::occluders_of(set, scene);
        return compute_coefficients(shapes, scene, plan, occluders, {}, 1e6);
    }
    bool watches_the_riders() const {
        const auto coefficients = compute();
        const auto& pairs = coefficients.crossed_pairs;
        return std::find(pairs.begin(), pairs.end(), model::ElementPair{0, 1}) != pairs.end();
    }
};

TEST(Coefficients, bodies_that_ride_together_are_watched_where_something_may_come_between_them) {
    EXPECT_FALSE(Carriage(9.0).watches_the_riders()) << "far beyond the end of the way";
    EXPECT_TRUE(Carriage(2.0).watches_the_riders());
    Carriage beside(2.0);
    beside.set.patches[2].surface.origin.z = -0.1; // below both: it has both on one side
    EXPECT_FALSE(beside.watches_the_riders());
    Carriage mover(9.0); // which comes to meet them
    mover.scene.motions.push_back(
        {"meet",
         model::Interpolation::Linear,
         Vec3(0),
         {{0.0, Vec3(0), Quat(1, 0, 0, 0)}, {1.0, Vec3(-6, 0, 0), Quat(1, 0, 0, 0)}}});
    mover.scene.objects[2].motion = MotionId(1);
    mover.plan.moving_objects.push_back(ObjectId(2));
    EXPECT_TRUE(mover.watches_the_riders());
}

TEST(Coefficients, integrated_at_points_are_within_a_few_standard_errors_of_the_automatic_ones) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(1, 2, 1), support::Facing::Inwards);
    set.patches.push_back(support::rectangle({0.3, 0.5, 0.5}, {0.4, 0, 0}, {0, 0.8, 0}));
    const auto scene = support::plain_scene(1);
    const auto shapes = support::shapes_of(set, 2, 1);
    const auto occluders = support::occluders_of(set, scene);
    const model::Plan plan{.degree = 1};
    const auto exact = compute_coefficients(shapes, scene, plan, occluders, {.tolerance = 1e-4}, 1e6);
    for (const auto integration : {kernel::Integration::Sobol, kernel::Integration::Random}) {
        const auto sampled = compute_coefficients(shapes, scene, plan, occluders,
                                                  {.integration = integration, .samples = 256}, 1e6);
        double difference = 0.0, stated = 0.0;
        const auto of_exact = element_row_sums(exact, shapes), found = element_row_sums(sampled, shapes);
        for (std::size_t e = 0; e < found.size(); ++e) difference += std::abs(found[e] - of_exact[e]);
        for (const model::BlockEntry& entry : sampled.static_blocks.entries)
            stated += static_cast<double>(entry.error);
        EXPECT_GT(difference, 0.0) << "points leave an error";
        EXPECT_LT(difference, 2.0 * stated);
        EXPECT_GT(stated, 0.0);
    }
}

TEST(Coefficients, a_scene_at_rest_has_no_pairs_that_change) {
    Carriage still(2.0);
    for (model::Object& object : still.scene.objects) object.motion.reset();
    still.plan.moving_objects.clear();
    const auto coefficients = still.compute();
    EXPECT_TRUE(coefficients.moving_pairs.empty());
    EXPECT_TRUE(coefficients.crossed_pairs.empty());
}

TEST(Coefficients, are_the_same_bytes_on_one_thread_and_two) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(1), support::Facing::Inwards);
    const auto scene = support::plain_scene(1);
    core::set_thread_count(1);
    const auto one = support::compute(set, scene, 3, 2).coefficients.static_blocks.values;
    core::set_thread_count(2);
    const auto two = support::compute(set, scene, 3, 2).coefficients.static_blocks.values;
    core::set_thread_count(0);
    EXPECT_EQ(one, two);
}

} // namespace
} // namespace kinelux::coefficients
