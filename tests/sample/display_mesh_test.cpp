// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "sample/mesh_checks.h"
#include "sample/sampler.h"
#include "support/shapes.h"

namespace kinelux::sample {
namespace {

TEST(DisplayMesh, its_area_is_that_of_the_elements_and_no_edge_is_too_long) {
    const model::PatchSet set{support::box({0, 0, 0}, {1, 2, 0.7}, support::Facing::Inwards), {}};
    const auto tree = support::uniform_elements(set, 3);
    const auto shapes = geometry::element_shapes(set, tree, 1, 0);
    const model::DisplayMesh mesh = display_mesh(shapes, set, tree, 0.13);
    test::expect_consistent(mesh);
    std::vector<double> areas(shapes.size(), 0.0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        areas[mesh.elements[t].value] += test::area_of(mesh, t);
        for (std::size_t e = 0; e < 3; ++e)
            EXPECT_LE(
                glm::distance(mesh.points[mesh.triangles[t][e]], mesh.points[mesh.triangles[t][(e + 1) % 3]]),
                0.13 * (1.0 + 1e-9));
    }
    for (std::size_t e = 0; e < shapes.size(); ++e) EXPECT_NEAR(areas[e], shapes[e].area, 1e-12);
}

TEST(DisplayMesh, a_patch_has_no_t_junction_and_no_crack) {
    model::Patch slanted = support::rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    slanted.points = {{0.0, 0.0}, {1.3, 0.2}, {1.1, 0.9}, {-0.2, 0.77}}; // no side along an axis
    const model::PatchSet set{{slanted}, {}};
    const auto tree =
        support::uniform_elements({{support::rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})}, {}}, 3);
    for (const bool skew : {false, true}) {
        model::ClusterTree used = tree;
        if (skew) { // two elements divided by the diagonal
            used.elements.resize(2);
            used.domain_triangles = {{slanted.points[0], slanted.points[1], slanted.points[2]},
                                     {slanted.points[0], slanted.points[2], slanted.points[3]}};
            for (std::uint32_t e = 0; e < 2; ++e) {
                used.elements[e].first_triangle = e;
                used.elements[e].triangle_count = 1;
            }
        }
        const auto shapes = geometry::element_shapes(set, used, 0, 0);
        const model::DisplayMesh mesh = display_mesh(shapes, set, used, 0.17);
        test::expect_consistent(mesh);
        EXPECT_GT(mesh.triangles.size(), 60u);
        EXPECT_EQ(test::t_junctions(mesh), 0u);
        // Euler: a disc has points - edges + triangles = 1, and 2 edges = 3 triangles + open edges.
        const std::size_t open = test::open_edges(mesh);
        EXPECT_EQ(2 * mesh.points.size(), 2 + mesh.triangles.size() + open);
    }
}

model::Patch cylinder(double radius, double height, double orientation) {
    model::Patch patch;
    patch.surface.type = model::SurfaceType::Cylinder;
    patch.surface.radius = radius;
    patch.surface.orientation = orientation;
    const double turn = 2.0 * std::numbers::pi;
    patch.points = {{0.0, 0.0}, {turn, 0.0}, {turn, height}, {0.0, height}};
    patch.triangles = {{0, 1, 2}, {0, 2, 3}};
    patch.loops = {{0, 1, 2, 3}};
    return patch;
}

TEST(DisplayMesh, round_patches_are_shown_round_with_exact_normals) {
    for (const double orientation : {1.0, -1.0}) {
        const model::PatchSet set{{cylinder(0.5, 1.0, orientation)}, {}};
        const auto tree = support::uniform_elements(set, 8);
        const auto shapes = geometry::element_shapes(set, tree, 0, 0);
        const model::DisplayMesh mesh = display_mesh(shapes, set, tree, 0.3);
        test::expect_consistent(mesh);
        double area = 0.0;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) area += test::area_of(mesh, t);
        EXPECT_NEAR(area, std::numbers::pi, 0.01 * std::numbers::pi);
        for (std::size_t p = 0; p < mesh.points.size(); ++p) {
            EXPECT_NEAR(glm::length(Vec2(mesh.points[p])), 0.5, 1e-14);
            EXPECT_NEAR(glm::dot(Vec2(mesh.normals[p]), Vec2(mesh.points[p])), 0.5 * orientation, 1e-12);
        }
    }
}

/// An octahedron's eight triangles as one or two clusters.
model::PatchSet octahedron() {
    model::PatchSet set;
    set.small.points = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (std::uint32_t i = 0; i < 4; ++i) {
        set.small.triangles.push_back({i, (i + 1) % 4, 4});
        set.small.triangles.push_back({(i + 1) % 4, i, 5});
    }
    set.small.objects.assign(8, ObjectId(0));
    set.small.materials.assign(8, MaterialId(0));
    return set;
}

model::ClusterTree clusters(std::vector<std::vector<std::uint32_t>> groups) {
    model::ClusterTree tree;
    for (auto& group : groups) {
        model::Element element;
        element.cluster = ClusterId(tree.clusters.size());
        tree.elements.push_back(element);
        tree.clusters.push_back({ObjectId(0), MaterialId(0), std::move(group), 0.0});
    }
    return tree;
}

TEST(DisplayMesh, cluster_triangles_are_split_evenly_and_share_points_only_where_smooth) {
    const model::PatchSet set = octahedron();
    const auto tree = clusters({{0, 2, 4, 6}, {1, 3, 5, 7}});
    const auto shapes = geometry::element_shapes(set, tree, 0, 0);
    const model::DisplayMesh coarse = display_mesh(shapes, set, tree, 10.0);
    test::expect_consistent(coarse);
    EXPECT_EQ(coarse.triangles.size(), 8u);
    EXPECT_EQ(coarse.points.size(), 24u); // faces meet at 70 degrees
    const model::DisplayMesh fine = display_mesh(shapes, set, tree, 0.5);
    test::expect_consistent(fine);
    double area = 0.0;
    for (std::size_t t = 0; t < fine.triangles.size(); ++t) area += test::area_of(fine, t);
    EXPECT_NEAR(area, 4.0 * std::sqrt(3.0), 1e-12);
    EXPECT_EQ(fine.triangles.size(), 8u * 16u);
    EXPECT_EQ(test::open_edges(fine), 8u * 3u * 4u);
}

TEST(DisplayMesh, smooth_clusters_agree_on_normals_at_their_seam) {
    // Two triangles folded by 20 degrees, each its own cluster.
    model::PatchSet set;
    const double fold = std::numbers::pi / 9.0;
    set.small.points = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {std::cos(fold), 0, std::sin(fold)}};
    set.small.triangles = {{0, 1, 2}, {0, 3, 1}};
    set.small.objects.assign(2, ObjectId(0));
    set.small.materials.assign(2, MaterialId(0));
    const auto tree = clusters({{0}, {1}});
    const auto shapes = geometry::element_shapes(set, tree, 0, 0);
    const model::DisplayMesh mesh = display_mesh(shapes, set, tree, 10.0);
    ASSERT_EQ(mesh.points.size(), 6u);
    for (std::size_t p = 0; p < 3; ++p)
        for (std::size_t q = 3; q < 6; ++q)
            if (mesh.points[p] == mesh.points[q]) {
                EXPECT_NEAR(glm::dot(mesh.normals[p], mesh.normals[q]), 1.0, 1e-12);
            }
}

} // namespace
} // namespace kinelux::sample
