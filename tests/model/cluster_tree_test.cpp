// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/cluster_tree.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace kinelux::model {
namespace {

// One patch and two small triangles.
PatchSet patches() {
    PatchSet set;
    Patch patch;
    patch.points = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
    patch.triangles = {{0, 1, 2}};
    set.patches.push_back(patch);
    set.small.points = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    set.small.triangles = {{0, 1, 2}, {0, 2, 1}};
    set.small.objects = {ObjectId(0), ObjectId(0)};
    set.small.materials = {MaterialId(0), MaterialId(0)};
    return set;
}

ClusterTree tree_of(const PatchSet& set) {
    ClusterTree tree;
    tree.clusters = {{ObjectId(0), MaterialId(0), {0}, 0.0}, {ObjectId(0), MaterialId(0), {1}, 0.0}};
    tree.domain_triangles = {{set.patches[0].points[0], set.patches[0].points[1], set.patches[0].points[2]}};
    Element piece;
    piece.patch = PatchId(0);
    piece.triangle_count = 1;
    Element first, second;
    first.cluster = ClusterId(0);
    second.cluster = ClusterId(1);
    tree.elements = {piece, first, second};
    return tree;
}

TEST(ClusterTree, well_formed_tree_passes) { EXPECT_NO_THROW(check(tree_of(patches()), patches())); }

TEST(ClusterTree, triangle_in_no_cluster_or_in_two_is_refused) {
    ClusterTree tree = tree_of(patches());
    tree.clusters[1].triangles = {0};
    EXPECT_THROW(check(tree, patches()), core::GeometryError);
    tree = tree_of(patches());
    tree.clusters[1].triangles = {0, 1};
    EXPECT_THROW(check(tree, patches()), core::GeometryError);
    tree = tree_of(patches());
    tree.clusters[1].triangles = {2};
    EXPECT_THROW(check(tree, patches()), core::GeometryError);
}

TEST(ClusterTree, patches_and_clusters_without_element_are_refused) {
    ClusterTree tree = tree_of(patches());
    tree.elements.pop_back();
    EXPECT_THROW(check(tree, patches()), core::GeometryError);
    tree = tree_of(patches());
    tree.elements.erase(tree.elements.begin());
    EXPECT_THROW(check(tree, patches()), core::GeometryError);
}

TEST(ClusterTree, element_of_nothing_or_of_both_is_refused) {
    ClusterTree tree = tree_of(patches());
    tree.elements[0].patch.reset();
    EXPECT_THROW(check(tree, patches()), core::GeometryError);
    tree = tree_of(patches());
    tree.elements[0].cluster = ClusterId(0);
    EXPECT_THROW(check(tree, patches()), core::GeometryError);
}

TEST(ClusterTree, ranges_out_of_bounds_are_refused) {
    ClusterTree tree = tree_of(patches());
    tree.elements[0].triangle_count = 2;
    EXPECT_THROW(check(tree, patches()), core::GeometryError);
    tree = tree_of(patches());
    tree.elements[0].object = ObjectId(1);
    EXPECT_THROW(check(tree, patches()), core::GeometryError);
}

} // namespace
} // namespace kinelux::model
