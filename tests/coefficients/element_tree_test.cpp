// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/element_tree.h"

#include <numeric>

#include <gtest/gtest.h>

#include "core/parallel.h"
#include "model/hierarchy.h"
#include "support/computed.h"

namespace kinelux::coefficients {
namespace {

// A room with a box that stands on its floor: the floor below the box is a patch of its own.
model::PatchSet room_with_a_box_on_the_floor() {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(4, 3, 2.5), support::Facing::Inwards);
    set.patches[0] = support::rectangle(Vec3(0), Vec3(1.5, 0, 0), Vec3(0, 3, 0));
    set.patches.push_back(support::rectangle(Vec3(2.5, 0, 0), Vec3(1.5, 0, 0), Vec3(0, 3, 0)));
    for (const double y : {0.0, 1.0, 2.0})
        set.patches.push_back(support::rectangle(Vec3(1.5, y, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)));
    for (const auto& patch : support::box(Vec3(1.5, 1, 0), Vec3(2.5, 2, 0.8), support::Facing::Outwards))
        set.patches.push_back(patch);
    return set;
}

struct Tree {
    model::PatchSet set = room_with_a_box_on_the_floor();
    std::vector<geometry::ElementShape> shapes;
    ElementTree tree;

    explicit Tree(int degree) : shapes(support::shapes_of(set, 4, degree)) {
        std::vector<std::uint32_t> members(shapes.size());
        std::iota(members.begin(), members.end(), 0u);
        tree = build_element_tree(shapes, members, support::occluders_of(set, support::plain_scene(1)));
    }
};

TEST(ElementTree, holds_every_element_once_below_its_root) {
    const Tree it(1);
    std::vector<int> found(it.shapes.size(), 0);
    std::vector<std::size_t> open{it.tree.root};
    while (!open.empty()) {
        const std::size_t n = open.back();
        open.pop_back();
        const TreeNode& node = it.tree.nodes[n];
        if (node.is_element())
            ++found[n];
        else
            open.insert(open.end(), {node.first, node.second});
    }
    EXPECT_EQ(found, std::vector<int>(it.shapes.size(), 1));
    EXPECT_EQ(it.tree.nodes.size(), 2 * it.shapes.size() - 1);
}

TEST(ElementTree, bases_are_orthonormal_on_rules_of_few_nodes) {
    const Tree it(0);
    for (const TreeNode& node : it.tree.nodes) {
        EXPECT_LE(node.rule.nodes.size(), 10u);
        for (std::size_t k = 0; k < node.basis_size; ++k)
            for (std::size_t l = 0; l < node.basis_size; ++l) {
                double product = 0.0;
                for (std::size_t i = 0; i < node.rule.nodes.size(); ++i)
                    product += node.rule.nodes[i].weight * node.rule.basis[i * node.basis_size + k] *
                               node.rule.basis[i * node.basis_size + l];
                EXPECT_NEAR(product, k == l ? 1.0 : 0.0, 1e-9);
            }
        for (const auto& x : node.rule.nodes) EXPECT_GT(x.weight, 0.0);
    }
}

// What is linear in position is a function of every group: nothing of it is lost on the way up and down.
TEST(ElementTree, linear_functions_survive_the_way_up_and_down) {
    const Tree it(1);
    const model::UnknownLayout& layout = it.tree.hierarchy.layout;
    std::vector<double> x(layout.offsets[it.shapes.size()], 0.0);
    for (std::size_t e = 0; e < it.shapes.size(); ++e) {
        const geometry::NodeSet& rule = it.shapes[e].rules[0];
        const std::size_t size = it.shapes[e].basis.size();
        for (std::size_t i = 0; i < rule.nodes.size(); ++i)
            for (std::size_t k = 0; k < size; ++k)
                x[layout.offsets[e] + k] += rule.nodes[i].weight * rule.basis[i * size + k] *
                                            (1.0 + glm::dot(rule.nodes[i].position, Vec3(0.3, -0.2, 0.5)));
    }
    std::vector<double> all = model::gather_groups(it.tree.hierarchy, 1, x);
    for (std::size_t u = 0; u + 4 < all.size(); ++u) all[u] = 0.0; // but the root's
    ASSERT_EQ(layout.count(it.tree.root), 4u);
    std::vector<double> y(x.size(), 0.0);
    model::spread_groups(it.tree.hierarchy, 1, all, y);
    for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(y[k], x[k], 1e-9);
}

TEST(ElementTree, what_lies_below_a_box_is_grouped_apart) {
    const Tree it(0);
    const TreeNode& root = it.tree.nodes[it.tree.root];
    const TreeNode& buried = it.tree.nodes[root.second];
    EXPECT_NEAR(buried.area, 1.0, 1e-9)
        << "the floor below the box; the box's own lower side looks out of the room";
}

} // namespace
} // namespace kinelux::coefficients
