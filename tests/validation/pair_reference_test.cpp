// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/pair_reference.h"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/quadrature.h"
#include "pair_recipes.h"
#include "support/planar_patches.h"
#include "support/shapes.h"

namespace kinelux::support {
namespace {

using geometry::ElementShape;
using geometry::Facet;

double kernel(const Vec3& x, const Vec3& nx, const Vec3& y, const Vec3& ny) {
    const Vec3 r = y - x;
    const double r2 = glm::dot(r, r);
    return std::max(0.0, glm::dot(nx, r)) * std::max(0.0, -glm::dot(ny, r)) / (std::numbers::pi * r2 * r2);
}

// Values of a block by any list of points of a facet pair.
class BlockSum {
public:
    BlockSum(const ElementShape& a, const ElementShape& b)
        : a_(a),
          b_(b),
          values(a.basis.size() * b.basis.size(), 0.0),
          phi_(a.basis.size()),
          psi_(b.basis.size()) {}

    void add(const Facet& f, const Vec2& x, const Facet& g, const Vec2& y, double weight) {
        const auto point = [](const Facet& facet, const Vec2& p) {
            return facet.corners[0] + p.x * (facet.corners[1] - facet.corners[0]) +
                   p.y * (facet.corners[2] - facet.corners[1]);
        };
        const auto parameter = [](const Facet& facet, const Vec2& p) {
            return facet.parameters[0] + p.x * (facet.parameters[1] - facet.parameters[0]) +
                   p.y * (facet.parameters[2] - facet.parameters[1]);
        };
        a_.basis.evaluate(parameter(f, x), phi_);
        b_.basis.evaluate(parameter(g, y), psi_);
        const double value =
            weight * 4.0 * f.area * g.area * kernel(point(f, x), f.normal, point(g, y), g.normal);
        for (std::size_t k = 0; k < phi_.size(); ++k)
            for (std::size_t l = 0; l < psi_.size(); ++l)
                values[k * psi_.size() + l] += value * phi_[k] * psi_[l];
    }

private:
    const ElementShape& a_;
    const ElementShape& b_;

public:
    std::vector<double> values;

private:
    std::vector<double> phi_, psi_;
};

// The points of the reference triangle are 0 <= p.y <= p.x <= 1: corner 0, then corners 1 and 2 at p.x = 1.
template <class Visit>
void for_points_of_the_cube(int n, const Visit& visit) {
    const auto& rule = geometry::gauss_rule(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k)
                for (int l = 0; l < n; ++l)
                    visit(rule.nodes[i], rule.nodes[j], rule.nodes[k], rule.nodes[l],
                          rule.weights[i] * rule.weights[j] * rule.weights[k] * rule.weights[l]);
}

// Disjoint triangles: the product of two collapsed Gauss rules.
void add_product(const Facet& f, const Facet& g, int n, BlockSum& sum) {
    for_points_of_the_cube(n, [&](double x, double s, double y, double t, double w) {
        sum.add(f, {x, x * s}, g, {y, y * t}, w * x * y);
    });
}

// Sauter and Schwab, Boundary Element Methods (2011), section 5.2.3: triangles whose corner 0 is common.
void add_common_vertex(const Facet& f, const Facet& g, int n, BlockSum& sum) {
    for_points_of_the_cube(n, [&](double xi, double e1, double e2, double e3, double w) {
        const double jacobian = w * xi * xi * xi * e2;
        sum.add(f, {xi, xi * e1}, g, {xi * e2, xi * e2 * e3}, jacobian);
        sum.add(f, {xi * e2, xi * e2 * e3}, g, {xi, xi * e1}, jacobian);
    });
}

// The same, section 5.2.2: triangles whose corners 0 and 1 are common, in this order in both.
void add_common_edge(const Facet& f, const Facet& g, int n, BlockSum& sum) {
    for_points_of_the_cube(n, [&](double xi, double e1, double e2, double e3, double w) {
        const double j1 = w * xi * xi * xi * e1 * e1, j2 = j1 * e2;
        sum.add(f, {xi, xi * e1 * e3}, g, {xi * (1 - e1 * e2), xi * e1 * (1 - e2)}, j1);
        sum.add(f, {xi, xi * e1}, g, {xi * (1 - e1 * e2 * e3), xi * e1 * e2 * (1 - e3)}, j2);
        sum.add(f, {xi * (1 - e1 * e2), xi * e1 * (1 - e2)}, g, {xi, xi * e1 * e2 * e3}, j2);
        sum.add(f, {xi * (1 - e1 * e2 * e3), xi * e1 * e2 * (1 - e3)}, g, {xi, xi * e1}, j2);
        sum.add(f, {xi * (1 - e1 * e2 * e3), xi * e1 * (1 - e2 * e3)}, g, {xi, xi * e1 * e2}, j2);
    });
}

ElementShape triangle(const Vec3& p, const Vec3& q, const Vec3& r, int degree) {
    model::PatchSet set;
    set.patches = {polygon_patch(std::array{p, q, r})};
    return geometry::element_shapes(set, whole_patch_elements(set), degree, 0)[0];
}

// A facet with its corners in another order; its normal stays.
Facet renumbered(const Facet& facet, std::array<std::size_t, 3> order) {
    Facet result = facet;
    for (std::size_t c = 0; c < 3; ++c) {
        result.corners[c] = facet.corners[order[c]];
        result.parameters[c] = facet.parameters[order[c]];
    }
    return result;
}

double relative_difference(const PairReference& reference, const std::vector<double>& values) {
    double sum = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k)
        sum += (values[k] - reference.values[k]) * (values[k] - reference.values[k]);
    return std::sqrt(sum) / reference.norm;
}

class ReferenceOfDegree : public testing::TestWithParam<int> {};

TEST_P(ReferenceOfDegree, is_the_gauss_product_of_separate_triangles) {
    const auto a = triangle({0, 0, 0}, {1, 0, 0}, {0.2, 0.9, 0}, GetParam());
    const auto b = triangle({0.1, 0.2, 1.0}, {0.3, 1.1, 1.2}, {1.0, 0.1, 1.1}, GetParam());
    BlockSum sum(a, b);
    add_product(a.facets[0], b.facets[0], 16, sum);
    EXPECT_LT(relative_difference(pair_reference(a, b), sum.values), 1e-9);
}

TEST_P(ReferenceOfDegree, is_the_sauter_schwab_block_of_triangles_with_a_common_edge) {
    for (const double angle : {60.0, 100.0, 150.0}) {
        const double rad = angle * std::numbers::pi / 180.0;
        const auto a = triangle({0, 0, 0}, {1, 0, 0}, {0.3, 0.8, 0}, GetParam());
        const auto b =
            triangle({1, 0, 0}, {0, 0, 0}, {0.6, 0.9 * std::cos(rad), 0.9 * std::sin(rad)}, GetParam());
        BlockSum sum(a, b);
        add_common_edge(a.facets[0], renumbered(b.facets[0], {1, 0, 2}), 16, sum);
        EXPECT_LT(relative_difference(pair_reference(a, b), sum.values), 1e-7) << "angle " << angle;
    }
}

TEST_P(ReferenceOfDegree, is_the_sauter_schwab_block_of_triangles_with_a_common_corner) {
    const auto a = triangle({0, 0, 0}, {0.8, 0.3, 0}, {0.1, 0.9, 0}, GetParam());
    const auto b = triangle({0, 0, 0}, {-0.4, 0.4, 0.9}, {0.4, 0.2, 0.8}, GetParam());
    BlockSum sum(a, b);
    add_common_vertex(a.facets[0], b.facets[0], 16, sum);
    EXPECT_GT(pair_reference(a, b).norm, 1e-3);
    EXPECT_LT(relative_difference(pair_reference(a, b), sum.values), 1e-7);
}

INSTANTIATE_TEST_SUITE_P(degrees, ReferenceOfDegree, testing::Values(0, 2, 4));

TEST(PairReference, facing_elements_that_almost_touch_exchange_by_the_product_of_their_bases) {
    // As the gap closes, K tends to a Dirac function: G^kl = integral phi_k phi_l over the overlap, here all of both.
    model::PatchSet set;
    set.patches = {rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), rectangle({0, 0, 1e-9}, {0, 1, 0}, {1, 0, 0})};
    const auto shapes = geometry::element_shapes(set, whole_patch_elements(set), 1, 0);
    const auto reference = pair_reference(shapes[0], shapes[1]);
    EXPECT_NEAR(reference.values[0], 1.0, 1e-8);
    EXPECT_NEAR(reference.norm, std::sqrt(3.0), 1e-7);
    EXPECT_LT(reference.disagreement, 1e-7);
}

TEST(PairReference, agrees_from_both_sides_on_every_class_of_pair) {
    using namespace validation;
    for (std::size_t kind = 0; kind < pair_class_names.size(); ++kind) {
        const auto pair = make_pair({static_cast<PairClass>(kind), 20, 1});
        const auto reference = pair_reference(pair.a, pair.b);
        EXPECT_LT(reference.disagreement, 3e-7 * std::max(reference.norm, 1e-6)) << pair_class_names[kind];
    }
}

} // namespace
} // namespace kinelux::support
