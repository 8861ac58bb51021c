// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/facet_surface.h"

#include <cmath>

#include <gtest/gtest.h>

#include "geometry/kronrod.h"
#include "support/curved.h"
#include "support/shapes.h"

namespace kinelux::geometry {
namespace {

using model::SurfaceType;

ElementShape element(SurfaceType type, double orientation) {
    model::PatchSet set;
    set.patches = {
        support::surface_patch(support::tilted_surface(type, orientation), {0.1, 0.2}, {0.9, 1.0})};
    return support::shapes_of(set, 1, 1).front();
}

constexpr std::array all_types{SurfaceType::Cylinder, SurfaceType::Cone, SurfaceType::Sphere,
                               SurfaceType::Torus, SurfaceType::Bilinear};

TEST(FacetSurface, agrees_with_the_nodes_of_its_element) {
    for (const SurfaceType type : all_types)
        for (const double orientation : {1.0, -1.0}) {
            const ElementShape shape = element(type, orientation);
            for (const Facet& facet : shape.facets) {
                Vec2 parameter;
                const SurfaceNode node = node_at(shape, facet, {0.2, 0.3, 0.5}, parameter);
                const FacetSurface::Point point = FacetSurface(shape, facet).at({0.3, 0.5});
                EXPECT_LT(glm::distance(point.position, node.position), 1e-15);
                EXPECT_LT(glm::distance(0.5 * point.area_normal, node.weight * node.normal), 1e-15);
                EXPECT_LT(glm::distance(point.parameter, parameter), 1e-15);
            }
        }
}

TEST(FacetSurface, nearest_point_of_a_point_over_the_facet_is_its_foot) {
    for (const SurfaceType type : all_types) {
        const ElementShape shape = element(type, 1.0);
        const FacetSurface surface(shape, shape.facets[0]);
        for (const Vec2& foot : {Vec2(0.3, 0.4), Vec2(0.0, 0.5), Vec2(0.01, 0.01)})
            for (const double height : {0.0, 1e-8, 0.05}) {
                const FacetSurface::Point point = surface.at(foot);
                const Vec2 found =
                    surface.nearest(point.position + height * glm::normalize(point.area_normal));
                EXPECT_LT(glm::distance(surface.at(found).position, point.position), 1e-7);
            }
    }
}

TEST(FacetSurface, no_sample_is_much_nearer_than_the_nearest_point) {
    for (const SurfaceType type : all_types) {
        const ElementShape shape = element(type, 1.0);
        const FacetSurface surface(shape, shape.facets[1]);
        for (const Vec3& x : {Vec3(0, 0, 1), Vec3(2, 1, -1), Vec3(-1, 1, 0.3), shape.centre}) {
            const double distance = glm::distance(surface.at(surface.nearest(x)).position, x);
            for (int i = 0; i <= 20; ++i)
                for (int j = 0; i + j <= 20; ++j)
                    EXPECT_LE(distance,
                              glm::distance(surface.at(Vec2(i, j) / 20.0).position, x) + 0.03 * shape.radius);
        }
    }
}

TEST(Kronrod, both_rules_are_exact_to_their_degrees) {
    const auto integral = [](std::span<const double> nodes, std::span<const double> weights, int power) {
        double sum = 0.0;
        for (std::size_t i = 0; i < nodes.size(); ++i) sum += weights[i] * std::pow(nodes[i], power);
        return sum;
    };
    for (const auto& [rule, degree, gauss_degree] :
         {std::tuple(&kronrod_7(), 11, 5), std::tuple(&kronrod_15(), 23, 13)})
        for (int power = 0; power <= degree; ++power) {
            const double exact = power % 2 == 0 ? 2.0 / (power + 1) : 0.0;
            EXPECT_NEAR(integral(rule->nodes, rule->weights, power), exact, 1e-15);
            if (power <= gauss_degree) {
                EXPECT_NEAR(integral(rule->nodes, rule->gauss_weights, power), exact, 1e-15);
            }
        }
}

} // namespace
} // namespace kinelux::geometry
