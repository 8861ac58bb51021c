// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/element_shape.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/quadrature.h"
#include "geometry/surface.h"
#include "support/curved.h"
#include "support/shapes.h"

namespace kinelux::geometry {
namespace {

using model::SurfaceType;
using std::numbers::pi;

// One element of a plane z = 0 from triangles of its points.
ElementShape planar_element(const std::vector<Vec2>& points, const std::vector<model::Triangle>& triangles,
                            int degree) {
    model::PatchSet set;
    set.patches = {support::rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0))};
    model::ClusterTree tree;
    for (const auto& [a, b, c] : triangles)
        tree.domain_triangles.push_back({points[a], points[b], points[c]});
    model::Element element;
    element.patch = PatchId(0);
    element.triangle_count = static_cast<std::uint32_t>(triangles.size());
    tree.elements = {element};
    return element_shapes(set, tree, degree, 0).front();
}

ElementShape ell(int degree) {
    return planar_element({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 3}, {0, 3}, {0, 1}},
                          {{0, 1, 4}, {0, 4, 7}, {1, 2, 3}, {1, 3, 4}, {7, 4, 5}, {7, 5, 6}}, degree);
}

ElementShape frame(int degree) {
    return planar_element(
        {{0, 0}, {3, 0}, {3, 3}, {0, 3}, {1, 1}, {2, 1}, {2, 2}, {1, 2}},
        {{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}}, degree);
}

ElementShape curved_element(const model::Patch& patch, int degree) {
    model::PatchSet set;
    set.patches = {patch};
    return support::shapes_of(set, 1, degree).front();
}

double signed_area(const std::vector<Vec3>& loop) {
    double twice = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
        twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * twice;
}

double total_weight(const NodeSet& rule) {
    double sum = 0.0;
    for (const SurfaceNode& node : rule.nodes) sum += node.weight;
    return sum;
}

// Largest entry of | integral of phi_k phi_l dA - I | by one of the element's rules.
double orthonormality_defect(const ElementShape& shape, const NodeSet& rule) {
    const std::size_t n = shape.basis.size();
    double defect = 0.0;
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t l = 0; l < n; ++l) {
            double sum = k == l ? -1.0 : 0.0;
            for (std::size_t i = 0; i < rule.nodes.size(); ++i)
                sum += rule.nodes[i].weight * rule.basis[i * n + k] * rule.basis[i * n + l];
            defect = std::max(defect, std::abs(sum));
        }
    return defect;
}

TEST(ElementShape, outline_of_a_rectangle_has_its_four_corners) {
    const ElementShape shape = planar_element({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}},
                                              {{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}}, 1);
    ASSERT_EQ(shape.outline.size(), 1u);
    EXPECT_EQ(shape.outline[0].size(), 4u);
    EXPECT_DOUBLE_EQ(signed_area(shape.outline[0]), 2.0);
}

TEST(ElementShape, outline_of_an_ell_keeps_the_inner_corner) {
    const ElementShape shape = ell(1);
    ASSERT_EQ(shape.outline.size(), 1u);
    EXPECT_EQ(shape.outline[0].size(), 6u);
    EXPECT_DOUBLE_EQ(signed_area(shape.outline[0]), 4.0);
}

TEST(ElementShape, holes_run_clockwise) {
    const ElementShape shape = frame(1);
    ASSERT_EQ(shape.outline.size(), 2u);
    EXPECT_DOUBLE_EQ(signed_area(shape.outline[0]), 9.0);
    EXPECT_DOUBLE_EQ(signed_area(shape.outline[1]), -1.0);
}

TEST(ElementShape, outline_with_a_divided_edge_encloses_the_area) {
    const ElementShape shape = planar_element({{0, 0}, {2, 0}, {2, 1}, {0, 1}, {1, 1}, {1, 2}},
                                              {{0, 1, 2}, {0, 2, 3}, {3, 4, 5}, {4, 2, 5}}, 1);
    double sum = 0.0;
    for (const auto& loop : shape.outline) sum += signed_area(loop);
    EXPECT_NEAR(sum, shape.area, 1e-14);
}

TEST(ElementShape, pieces_that_touch_in_a_point_have_a_loop_each) {
    const ElementShape shape =
        planar_element({{0, 0}, {1, 0}, {0.5, 1}, {1, 2}, {0, 2}}, {{0, 1, 2}, {2, 3, 4}}, 0);
    ASSERT_EQ(shape.outline.size(), 2u);
    for (const auto& loop : shape.outline) EXPECT_EQ(loop.size(), 3u);
}

TEST(ElementShape, rules_are_exact_to_the_degree_they_say) {
    for (int degree = 0; degree <= max_degree; ++degree)
        for (const ElementShape& shape : {ell(degree), frame(degree)})
            for (const NodeSet& rule : shape.rules)
                for (int p = 0; p <= rule.exactness; ++p) {
                    const int q = rule.exactness - p;
                    double sum = 0.0, exact = 0.0;
                    for (const SurfaceNode& n : rule.nodes)
                        sum += n.weight * std::pow(n.position.x, p) * std::pow(n.position.y, q);
                    for (const Facet& facet : shape.facets)
                        for (const TriangleNode& t : triangle_rule(rule.exactness)) {
                            const Vec3 x = t.barycentric[0] * facet.corners[0] +
                                           t.barycentric[1] * facet.corners[1] +
                                           t.barycentric[2] * facet.corners[2];
                            exact += t.weight * facet.area * std::pow(x.x, p) * std::pow(x.y, q);
                        }
                    EXPECT_NEAR(sum, exact, 1e-11 * exact) << "degree " << degree << ", " << p << " " << q;
                }
}

TEST(ElementShape, a_parallelogram_of_degree_two_takes_nine_nodes) {
    model::PatchSet set;
    set.patches = {support::rectangle(Vec3(1, 1, 1), Vec3(0.6, 0.8, 0), Vec3(-0.4, 0.3, 0.5))};
    for (const ElementShape& shape : support::shapes_of(set, 3, 2)) {
        EXPECT_EQ(shape.rules[0].nodes.size(), 9u);
        EXPECT_EQ(shape.rules[1].nodes.size(), 16u);
        EXPECT_EQ(shape.rules[2].nodes.size(), 36u);
        for (const NodeSet& rule : shape.rules) EXPECT_LT(orthonormality_defect(shape, rule), 1e-13);
    }
}

struct CurvedCase {
    model::Patch patch;
    double area;
};

// Areas in closed form; bilinear and whole surfaces with seam and poles among them.
std::vector<CurvedCase> curved_cases() {
    const double slope = std::tan(0.3), r = 0.25;
    return {
        {support::surface_patch(support::tilted_surface(SurfaceType::Cylinder), {0.2, -1}, {1.4, 2}), 3.6},
        {support::surface_patch(support::tilted_surface(SurfaceType::Cone), {0.2, 0}, {1.2, 2}),
         (2.0 + 2.0 * slope) / std::cos(0.3)},
        {support::surface_patch(support::tilted_surface(SurfaceType::Sphere), {0, 0}, {0.5 * pi, 0.5 * pi}),
         0.5 * pi},
        {support::surface_patch(support::tilted_surface(SurfaceType::Torus), {0, 0.2}, {1, 1.5}),
         r * (1.3 + r * (std::sin(1.5) - std::sin(0.2)))},
        {support::whole_sphere(), 4.0 * pi},
        {support::whole_sphere(-1.0), 4.0 * pi},
        {support::surface_patch(support::tilted_surface(SurfaceType::Torus), {0, 0}, {2 * pi, 2 * pi}),
         4.0 * pi * pi * r}};
}

TEST(ElementShape, curved_elements_have_their_true_area_and_an_orthonormal_basis) {
    for (const auto& [patch, area] : curved_cases())
        for (const int degree : {0, 2, 6}) {
            const ElementShape shape = curved_element(patch, degree);
            EXPECT_FALSE(shape.planar);
            EXPECT_NEAR(shape.area, area, 1e-11 * area);
            for (const NodeSet& rule : shape.rules) {
                EXPECT_NEAR(total_weight(rule), area, 1e-11 * area);
                EXPECT_LT(orthonormality_defect(shape, rule), 1e-10);
            }
        }
}

TEST(ElementShape, nodes_of_curved_elements_lie_on_the_surface_with_its_normals) {
    for (const double orientation : {1.0, -1.0}) {
        const ElementShape shape = curved_element(support::whole_sphere(orientation), 2);
        for (const SurfaceNode& node : shape.rules[1].nodes)
            EXPECT_LT(glm::distance(node.position - shape.surface->origin, orientation * node.normal), 1e-14);
    }
}

TEST(ElementShape, bounds_and_normal_cone_hold_the_true_surface) {
    for (const auto& [patch, area] : curved_cases()) {
        const Pose pose{glm::angleAxis(0.7, glm::normalize(Vec3(1, 2, -1))), Vec3(0, 0, 5)};
        const ElementShape shape = moved(curved_element(patch, 0), pose);
        for (int i = 0; i <= 50; ++i)
            for (int j = 0; j <= 50; ++j) {
                const Vec2 at = glm::mix(
                    patch.points[0], patch.points[2],
                    Vec2(std::clamp(i / 50.0, 1e-9, 1 - 1e-9), std::clamp(j / 50.0, 1e-9, 1 - 1e-9)));
                const SurfaceJet jet = evaluate(*shape.surface, at);
                EXPECT_TRUE(glm::all(glm::lessThanEqual(shape.box_low, jet.position)));
                EXPECT_TRUE(glm::all(glm::lessThanEqual(jet.position, shape.box_high)));
                EXPECT_LE(glm::distance(jet.position, shape.centre), shape.radius);
                EXPECT_GE(glm::dot(jet.normal, shape.mean_normal), shape.cone_cosine);
            }
    }
}

TEST(ElementShape, node_weights_over_facets_add_up_to_the_true_area) {
    for (const SurfaceType type : {SurfaceType::Sphere, SurfaceType::Bilinear}) {
        const ElementShape shape =
            curved_element(support::surface_patch(support::tilted_surface(type), {0, 0}, {1, 1}), 1);
        double sum = 0.0;
        for (const Facet& facet : shape.facets)
            for (const TriangleNode& t : triangle_rule(20)) {
                Vec2 parameter;
                const SurfaceNode node = node_at(shape, facet, t.barycentric, parameter);
                sum += t.weight * node.weight;
                EXPECT_LT(glm::distance(node.position, position(*shape.surface, parameter)), 1e-15);
            }
        EXPECT_NEAR(sum, shape.area, 1e-12 * shape.area);
    }
}

TEST(ElementShape, moved_surfaces_carry_points_and_normals) {
    for (const auto& [patch, area] : curved_cases()) {
        const Pose pose{glm::angleAxis(0.7, glm::normalize(Vec3(1, 2, -1))), Vec3(0, 0, 5)};
        const ElementShape shape = curved_element(patch, 1), turned = moved(shape, pose);
        Vec2 parameter;
        const std::array<double, 3> middle{0.3, 0.3, 0.4};
        const SurfaceNode before = node_at(shape, shape.facets[0], middle, parameter);
        const SurfaceNode after = node_at(turned, turned.facets[0], middle, parameter);
        EXPECT_LT(glm::distance(after.position, pose.point(before.position)), 1e-14);
        EXPECT_LT(glm::distance(after.normal, pose.direction(before.normal)), 1e-14);
        EXPECT_NEAR(after.weight, before.weight, 1e-14);
    }
}

} // namespace
} // namespace kinelux::geometry
