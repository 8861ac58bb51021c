// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/hierarchy.h"

#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/sequence.h"

namespace kinelux::model {

namespace {

/// Four elements with 1, 3, 1 and 1 unknowns; groups 4 = (0, 1), 5 = (2, 3), 6 = (4, 5) with 2 unknowns each; links
/// between the first two groups, and between an element and a group.
Coefficients tree_of_four() {
    core::Random random(5);
    Coefficients coefficients;
    coefficients.layout.offsets = {0, 1, 4, 5, 6};
    Hierarchy& hierarchy = coefficients.hierarchy;
    hierarchy.layout.offsets = {0, 1, 4, 5, 6, 8, 10, 12};
    hierarchy.groups = {{0, 1, 0}, {2, 3, 8}, {4, 5, 12}};
    hierarchy.restrictions.resize(20);
    for (double& value : hierarchy.restrictions) value = random.next() - 0.5;
    hierarchy.links.entries = {{1, 5, 0, 0.1f}, {4, 5, 6, 0.1f}};
    for (int k = 0; k < 10; ++k) hierarchy.links.values.push_back(static_cast<float>(random.next()));
    return coefficients;
}

std::vector<double> random_vector(std::size_t size, std::uint64_t seed) {
    core::Random random(seed);
    std::vector<double> result(size);
    for (double& value : result) value = random.next() - 0.3;
    return result;
}

double dot(const std::vector<double>& x, const std::vector<double>& y) {
    return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
}

} // namespace

TEST(Hierarchy, spreading_is_the_transpose_of_gathering) {
    const Hierarchy hierarchy = tree_of_four().hierarchy;
    const auto x = random_vector(6 * 3, 1);
    auto arrived = random_vector(12 * 3, 2);
    const double gathered = dot(gather_groups(hierarchy, 3, x), arrived);
    std::vector<double> y(x.size(), 0.0);
    spread_groups(hierarchy, 3, arrived, y);
    EXPECT_NEAR(gathered, dot(x, y), 1e-14);
}

TEST(Hierarchy, link_transport_is_symmetric) {
    const Hierarchy hierarchy = tree_of_four().hierarchy;
    const auto u = random_vector(6, 3), v = random_vector(6, 4);
    std::vector<double> to_u(6, 0.0), to_v(6, 0.0);
    add_link_transport(hierarchy, 1, v, to_u);
    add_link_transport(hierarchy, 1, u, to_v);
    EXPECT_NEAR(dot(u, to_u), dot(v, to_v), 1e-15);
    EXPECT_GT(std::abs(dot(u, to_u)), 1e-3);
}

TEST(CheckHierarchy, whole_one_passes) { EXPECT_NO_THROW(check(tree_of_four())); }

TEST(CheckHierarchy, groups_are_trees_over_nodes_before_them) {
    for (const ElementGroup wrong :
         {ElementGroup{4, 7, 12}, ElementGroup{4, 6, 12}, ElementGroup{4, 4, 12}, ElementGroup{0, 5, 12}}) {
        Coefficients broken = tree_of_four();
        broken.hierarchy.groups[2] = wrong;
        EXPECT_THROW(check(broken), core::GeometryError);
    }
}

TEST(CheckHierarchy, nodes_are_the_elements_and_then_the_groups) {
    Coefficients broken = tree_of_four();
    broken.hierarchy.layout.offsets = {0, 2, 4, 5, 6, 8, 10, 12};
    EXPECT_THROW(check(broken), core::GeometryError);
    broken = tree_of_four();
    broken.hierarchy.layout.offsets.pop_back();
    EXPECT_THROW(check(broken), core::GeometryError);
    broken = tree_of_four();
    broken.hierarchy.layout.offsets.clear();
    EXPECT_THROW(check(broken), core::GeometryError);
}

TEST(CheckHierarchy, restrictions_and_links_end_within_finite_values) {
    Coefficients broken = tree_of_four();
    broken.hierarchy.restrictions.pop_back();
    EXPECT_THROW(check(broken), core::GeometryError);
    broken = tree_of_four();
    broken.hierarchy.restrictions[3] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(check(broken), core::GeometryError);
    broken = tree_of_four();
    broken.hierarchy.links.values.pop_back();
    EXPECT_THROW(check(broken), core::GeometryError);
    broken = tree_of_four();
    broken.hierarchy.links.entries[1].j = 7;
    EXPECT_THROW(check(broken), core::GeometryError);
}

} // namespace kinelux::model
