// SPDX-License-Identifier: GPL-3.0-or-later
#include "cluster/cluster.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/error.h"
#include "fit/fit.h"
#include "fit/scene_meshes.h"
#include "geometry/element_shape.h"
#include "geometry/surface.h"
#include "support/curved.h"

namespace kinelux::cluster {
namespace {

using support::add_object;
using support::add_sheet;
using support::empty_scene;

double area(const model::ClusterTree& tree, const model::Element& element) {
    double twice = 0.0;
    for (std::uint32_t i = 0; i < element.triangle_count; ++i) {
        const model::DomainTriangle& t = tree.domain_triangles[element.first_triangle + i];
        twice += (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
    }
    return 0.5 * twice;
}

double area(const model::ClusterTree& tree) {
    double sum = 0.0;
    for (const model::Element& element : tree.elements) sum += area(tree, element);
    return sum;
}

model::PatchSet patches_of(const model::Scene& scene) { return fit::fit_patches(scene, {}).patches; }

model::ClusterTree built(const model::PatchSet& patches, const ClusterOptions& options) {
    model::ClusterTree tree = build_clusters(patches, options);
    model::check(tree, patches);
    return tree;
}

model::Scene wall_with_window() {
    model::Scene scene = empty_scene();
    model::Mesh wall;
    const auto outside_window = [](int i, int j) { return i < 10 || i >= 20 || j < 10 || j >= 20; };
    add_sheet(wall, Vec3{0.0}, Vec3{3.0, 0.0, 0.0}, Vec3{0.0, 0.0, 3.0}, 30, 30, outside_window);
    add_object(scene, "wall", wall);
    return scene;
}

TEST(Cluster, pieces_of_a_patch_keep_its_area_and_size) {
    const model::PatchSet patches = patches_of(wall_with_window());
    for (const double size : {0.13, 0.4, 0.75, 1.1, 10.0}) {
        const model::ClusterTree tree = built(patches, {.element_size = size, .cluster_size = size});
        EXPECT_NEAR(area(tree), 8.0, 8e-12) << size;
        for (const model::Element& element : tree.elements) {
            Vec2 low{1e9}, high{-1e9};
            for (std::uint32_t i = 0; i < element.triangle_count; ++i) {
                for (const Vec2& p : tree.domain_triangles[element.first_triangle + i]) {
                    low = glm::min(low, p);
                    high = glm::max(high, p);
                }
            }
            // A sliver that joined its neighbour makes it at most 5 % larger.
            EXPECT_LE(std::max(high.x - low.x, high.y - low.y), 1.06 * size);
        }
    }
}

TEST(Cluster, patch_smaller_than_the_size_is_one_element) {
    const model::PatchSet patches = patches_of(wall_with_window());
    EXPECT_EQ(built(patches, {.element_size = 3.0, .cluster_size = 3.0}).elements.size(), 1U);
    EXPECT_EQ(built(patches, {.element_size = 1.0, .cluster_size = 3.0}).elements.size(), 8U);
}

TEST(Cluster, slivers_join_a_neighbour) {
    // A wall whose slanted top leaves slivers in the uppermost row.
    model::Scene scene = empty_scene();
    model::Mesh wall;
    wall.points = {{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}, {10.0, 0.0, 2.1}, {0.0, 0.0, 2.0}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    add_object(scene, "wall", wall);
    const model::PatchSet patches = patches_of(scene);
    const model::ClusterTree tree = built(patches, {.element_size = 0.7, .cluster_size = 1.0});
    EXPECT_NEAR(area(tree), 20.5, 20.5e-12);
    for (const model::Element& element : tree.elements) EXPECT_GE(area(tree, element), 0.05 * 0.4);
}

TEST(Cluster, pieces_of_one_patch_fit_together_to_the_last_bit) {
    const model::PatchSet patches = patches_of(wall_with_window());
    const model::ClusterTree tree = built(patches, {.element_size = 0.37, .cluster_size = 1.0});
    // Every edge is either met by the same edge in the opposite direction or on the wall's boundary.
    std::map<std::tuple<double, double, double, double>, int> edges;
    for (const model::DomainTriangle& t : tree.domain_triangles) {
        for (int k = 0; k < 3; ++k) {
            const Vec2 &a = t[k], &b = t[(k + 1) % 3];
            ++edges[{a.x, a.y, b.x, b.y}];
        }
    }
    double open = 0.0;
    for (const auto& [edge, count] : edges) {
        const auto [ax, ay, bx, by] = edge;
        EXPECT_EQ(count, 1);
        if (!edges.contains({bx, by, ax, ay})) open += std::hypot(bx - ax, by - ay);
    }
    EXPECT_NEAR(open, 12.0 + 4.0, 1e-12);
}

TEST(Cluster, emitting_patches_stay_whole_up_to_two_elements) {
    model::Scene scene = empty_scene();
    model::Mesh lamp;
    add_sheet(lamp, Vec3{0.0}, Vec3{1.8, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0});
    add_object(scene, "lamp", support::finished(lamp, MaterialId(1)));
    const model::PatchSet patches = patches_of(scene);
    EXPECT_EQ(built(patches, {.element_size = 1.0, .cluster_size = 1.0}).elements.size(), 2U);
    EXPECT_EQ(built(patches, {.element_size = 1.0, .cluster_size = 1.0, .emitters = {MaterialId(1)}})
                  .elements.size(),
              1U);
    EXPECT_EQ(built(patches, {.element_size = 0.5, .cluster_size = 1.0, .emitters = {MaterialId(1)}})
                  .elements.size(),
              8U);
}

TEST(Cluster, crowded_rooms_get_smaller_elements_than_empty_ones) {
    const auto size = [](int boxes) {
        model::Scene scene = empty_scene();
        add_object(scene, "room", support::turned_inside_out(support::box_mesh(Vec3{0.0}, Vec3{4.0})));
        for (int i = 0; i < boxes; ++i)
            add_object(scene, "box",
                       support::box_mesh(Vec3{0.5 + 0.3 * i, 0.5, 0.5}, Vec3{0.6 + 0.3 * i, 3.5, 3.5}));
        return cluster_options_for(scene, patches_of(scene)).element_size;
    };
    EXPECT_NEAR(size(0), 0.4, 1e-12); // a tenth of the extent: the free path is 8/3
    EXPECT_LT(size(3), 0.7 * size(0));
}

TEST(Cluster, sizes_follow_the_accuracy_and_the_scene) {
    model::Scene scene = wall_with_window();
    const model::PatchSet patches = patches_of(scene);
    scene.accuracy.target = 0.03;
    EXPECT_NEAR(cluster_options_for(scene, patches).element_size, 0.3, 1e-12);
    scene.accuracy.target = 0.0075;
    EXPECT_NEAR(cluster_options_for(scene, patches).element_size, 0.15, 1e-12);
    scene.accuracy.element_size = 0.42;
    EXPECT_EQ(cluster_options_for(scene, patches).element_size, 0.42);
    EXPECT_EQ(cluster_options_for(scene, patches).emitters, std::vector<MaterialId>{MaterialId(1)});
}

TEST(Cluster, round_bodies_are_gathered_within_the_limits) {
    model::Scene scene = empty_scene();
    add_object(scene, "room",
               support::turned_inside_out(support::box_mesh(Vec3{-5.0, -5.0, 0.0}, Vec3{5.0, 5.0, 4.0})));
    add_object(scene, "column", support::prism_mesh(Vec3{0.0}, 0.3, 4.0, 48));
    scene.objects[1].mesh.two_sided.assign(scene.objects[1].mesh.triangles.size(), 1);
    const model::PatchSet patches = fit::fit_patches(scene, {.round_face_turn_deg = 0.0}).patches;
    const ClusterOptions options{.element_size = 1.0, .cluster_size = 1.0, .normal_spread_deg = 40.0};
    const model::ClusterTree tree = built(patches, options);
    ASSERT_FALSE(tree.clusters.empty());
    for (const model::Cluster& cluster : tree.clusters) {
        EXPECT_EQ(cluster.object, ObjectId(1));
        EXPECT_LE(cluster.normal_spread_deg, 40.0);
        Vec3 low{1e9}, high{-1e9};
        for (const std::uint32_t t : cluster.triangles) {
            for (const std::uint32_t corner : patches.small.triangles[t]) {
                low = glm::min(low, patches.small.points[corner]);
                high = glm::max(high, patches.small.points[corner]);
            }
        }
        const Vec3 size = high - low;
        EXPECT_LE(std::max({size.x, size.y, size.z}), 1.0 + 1e-12);
    }
    EXPECT_LT(tree.clusters.size(), patches.small.triangles.size() / 4);
    EXPECT_TRUE(
        std::is_sorted(tree.elements.begin(), tree.elements.end(),
                       [](const model::Element& a, const model::Element& b) { return a.object < b.object; }));
}

TEST(Cluster, curved_patches_are_cut_by_their_length_on_the_surface) {
    model::Patch quarter_pipe;
    quarter_pipe.surface.type = model::SurfaceType::Cylinder;
    quarter_pipe.surface.radius = 2.0;
    quarter_pipe.points = {{0.0, 0.0}, {1.5, 0.0}, {1.5, 1.0}, {0.0, 1.0}};
    quarter_pipe.triangles = {{0, 1, 2}, {0, 2, 3}};
    quarter_pipe.loops = {{0, 1, 2, 3}};
    model::PatchSet patches;
    patches.patches.push_back(quarter_pipe);
    EXPECT_EQ(built(patches, {.element_size = 1.01, .cluster_size = 1.0}).elements.size(), 3U);
}

// Longest of the ways along u and v across an element, measured on the surface in small steps.
double longest_way(const model::ClusterTree& tree, const model::Element& element, const model::Patch& patch) {
    Vec2 low{1e9}, high{-1e9};
    for (std::uint32_t t = 0; t < element.triangle_count; ++t)
        for (const Vec2& uv : tree.domain_triangles[element.first_triangle + t]) {
            low = glm::min(low, uv);
            high = glm::max(high, uv);
        }
    constexpr int steps = 100;
    double longest = 0.0;
    for (int line = 0; line <= steps; ++line) {
        Vec2 ways{0.0};
        for (int i = 0; i < steps; ++i)
            for (int axis = 0; axis < 2; ++axis) {
                Vec2 share{static_cast<double>(line) / steps}, next = share;
                share[axis] = static_cast<double>(i) / steps;
                next[axis] = static_cast<double>(i + 1) / steps;
                ways[axis] += glm::distance(geometry::position(patch.surface, glm::mix(low, high, share)),
                                            geometry::position(patch.surface, glm::mix(low, high, next)));
            }
        longest = std::max({longest, ways.x, ways.y});
    }
    return longest;
}

TEST(Cluster, whole_spheres_cylinders_and_tori_are_cut_by_size_and_turn) {
    using model::SurfaceType;
    using std::numbers::pi;
    const auto whole = [](SurfaceType type, const Vec2& low, const Vec2& high) {
        return support::surface_patch(support::tilted_surface(type), low, high);
    };
    for (const model::Patch& patch :
         {support::whole_sphere(), whole(SurfaceType::Cylinder, {0, 0}, {2 * pi, 3}),
          whole(SurfaceType::Torus, {0, 0}, {2 * pi, 2 * pi}), whole(SurfaceType::Bilinear, {0, 0}, {1, 1})})
        for (const double size : {0.2, 0.7, 100.0}) {
            model::PatchSet patches;
            patches.patches.push_back(patch);
            const model::ClusterTree tree = built(patches, {.element_size = size, .cluster_size = size});
            double area = 0.0;
            for (const geometry::ElementShape& shape : geometry::element_shapes(patches, tree, 1, 0)) {
                area += shape.area;
                EXPECT_LE(longest_way(tree, tree.elements[shape.id.value], patch), 1.001 * size);
                EXPECT_GT(shape.cone_cosine, -0.5) << "bends by more than a quarter turn each way";
            }
            EXPECT_NEAR(area, geometry::area(patch), 1e-9 * area);
        }
}

TEST(Cluster, same_input_gives_the_same_tree) {
    const model::PatchSet patches = patches_of(wall_with_window());
    const ClusterOptions options{.element_size = 0.3, .cluster_size = 0.3};
    const model::ClusterTree a = build_clusters(patches, options), b = build_clusters(patches, options);
    EXPECT_EQ(a.domain_triangles, b.domain_triangles);
}

TEST(Cluster, size_of_zero_is_refused) { EXPECT_THROW(build_clusters({}, {}), core::GeometryError); }

} // namespace
} // namespace kinelux::cluster
