// SPDX-License-Identifier: GPL-3.0-or-later
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
