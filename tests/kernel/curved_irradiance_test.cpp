// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/curved_irradiance.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/quadrature.h"
#include "geometry/surface.h"
#include "support/curved.h"
#include "support/shapes.h"

namespace kinelux::kernel {
namespace {

using geometry::ElementShape;
using model::SurfaceType;
using std::numbers::pi;

std::vector<ElementShape> elements(const model::Patch& patch, int n, int degree) {
    model::PatchSet set;
    set.patches = {patch};
    return support::shapes_of(set, n, degree);
}

// Configuration factor from a point to elements: the constant function's value times the root of the area.
struct Factor {
    double value = 0.0, error = 0.0;
};
Factor factor(const Vec3& x, const Vec3& normal, const std::vector<ElementShape>& shapes, double tolerance) {
    Factor sum;
    for (const ElementShape& shape : shapes) {
        std::vector<double> values(shape.basis.size());
        sum.error += curved_irradiance(x, normal, shape, tolerance, values) * std::sqrt(shape.area);
        sum.value += values[0] * std::sqrt(shape.area);
    }
    return sum;
}

model::Patch part(SurfaceType type, double orientation, const Vec2& low, const Vec2& high) {
    return support::surface_patch(support::tilted_surface(type, orientation), low, high);
}

constexpr std::array<double, 3> tolerances{1e-3, 1e-5, 1e-8};

TEST(CurvedIrradiance, on_a_sphere_every_part_counts_by_its_area) {
    const model::Surface inside = support::tilted_surface(SurfaceType::Sphere, -1.0);
    for (const double tolerance : tolerances)
        for (const Vec2& low : {Vec2(0.1, -0.4), Vec2(0.1, 0.5 * pi - 1.0)}) {
            const Vec2 high = low + Vec2(1.3, 1.0);
            const auto shapes = elements(part(SurfaceType::Sphere, -1.0, low, high), 1, 2);
            for (const Vec2& at : {Vec2(0.5, 0.1), Vec2(0.1, 0.2), Vec2(0.1, 0.5 * pi - 1.0), Vec2(1.5, 0.3),
                                   Vec2(3.0, 0.9)}) {
                const geometry::SurfaceJet jet = geometry::evaluate(inside, at);
                const Factor f = factor(jet.position, jet.normal, shapes, tolerance);
                const double exact = shapes[0].area / (4.0 * pi);
                EXPECT_NEAR(f.value, exact, tolerance * exact) << at.x << " " << at.y;
            }
        }
}

TEST(CurvedIrradiance, inside_a_sphere_everything_is_seen_once) {
    const model::Surface inside = support::tilted_surface(SurfaceType::Sphere, -1.0);
    const auto shapes = elements(support::whole_sphere(-1.0), 4, 1);
    for (const double tolerance : tolerances)
        for (const double depth : {1.0, 0.3, 1e-2, 1e-5}) {
            const Vec3 n = glm::normalize(Vec3(1, 2, -0.5));
            const Factor f = factor(inside.origin + (1.0 - depth) * n, n, shapes, tolerance);
            EXPECT_NEAR(f.value, 1.0, 3.0 * tolerance) << depth;
        }
}

// Howell B-43: a sphere of radius 1 at distance d, the receiver's normal at the angle t from the way to its centre.
double sphere_factor(double d, double t) {
    const double w = std::acos(1.0 / d), c = std::cos(t), tangent = std::sqrt(d * d - 1.0);
    if (t <= 0.5 * pi - std::asin(1.0 / d)) return c / (d * d);
    if (t >= pi - w) return 0.0;
    return 0.5 - std::asin(tangent / (d * std::sin(t))) / pi +
           (c * std::acos(-tangent / std::tan(t)) - tangent * std::sqrt(1.0 - d * d * c * c)) / (pi * d * d);
}

TEST(CurvedIrradiance, sphere_partly_below_the_horizon_has_its_closed_form) {
    const model::Surface sphere = support::tilted_surface(SurfaceType::Sphere);
    const auto shapes = elements(support::whole_sphere(), 4, 0);
    for (const double tolerance : tolerances)
        for (const double d : {1.2, 3.0})
            for (const double t : {0.3, 1.3, 1.7}) {
                const double exact = sphere_factor(d, t);
                const Vec3 way = glm::normalize(Vec3(1, 0.4, 0.2));
                const Vec3 side = glm::normalize(glm::cross(way, Vec3(0, 0, 1)));
                const Factor f = factor(sphere.origin - d * way, std::cos(t) * way + std::sin(t) * side,
                                        shapes, tolerance);
                EXPECT_NEAR(f.value, exact, 3.0 * tolerance * std::max(exact, 1e-3)) << d << " " << t;
            }
}

TEST(CurvedIrradiance, cylinder_from_a_point_on_its_axis) {
    // Looking along the axis at a wall from height 0 to l: 1 - R^2 / (R^2 + l^2) less nothing, for the rest is the end disc.
    const auto shapes = elements(part(SurfaceType::Cylinder, -1.0, {0, 0}, {2 * pi, 2.0}), 4, 1);
    const model::Surface s = support::tilted_surface(SurfaceType::Cylinder, -1.0);
    for (const double tolerance : tolerances) {
        const double exact = 1.0 - 1.0 / (1.0 + 4.0);
        EXPECT_NEAR(factor(s.origin, s.axis_w, shapes, tolerance).value, exact, 2.0 * tolerance);
    }
}

TEST(CurvedIrradiance, self_factor_of_a_cylinder_is_its_closed_form) {
    // Howell C-78: inner wall of a cylinder to itself, X = h / (2 R): 1 + X - sqrt(1 + X^2).
    const double height = 2.0, x = height / 2.0, exact = 1.0 + x - std::sqrt(1.0 + x * x);
    const auto shapes = elements(part(SurfaceType::Cylinder, -1.0, {0, 0}, {2 * pi, height}), 4, 1);
    const model::Surface s = support::tilted_surface(SurfaceType::Cylinder, -1.0);
    for (const double tolerance : {1e-3, 1e-6, 1e-8}) {
        double sum = 0.0;
        const geometry::GaussRule& gauss = geometry::gauss_rule(20);
        for (std::size_t i = 0; i < gauss.nodes.size(); ++i) {
            const geometry::SurfaceJet jet = geometry::evaluate(s, {0.7, height * gauss.nodes[i]});
            sum += gauss.weights[i] * factor(jet.position, jet.normal, shapes, tolerance).value;
        }
        EXPECT_NEAR(sum, exact, 3.0 * tolerance + 1e-9);
    }
}

TEST(CurvedIrradiance, all_functions_agree_with_plain_quadrature_from_afar) {
    for (const SurfaceType type : {SurfaceType::Sphere, SurfaceType::Bilinear, SurfaceType::Cone}) {
        const ElementShape shape = elements(part(type, 1.0, {0.1, 0.1}, {0.9, 0.9}), 1, 4)[0];
        const Vec3 x = shape.centre + 3.0 * shape.mean_normal + Vec3(0.3, 0.2, 0.0),
                   normal = -shape.mean_normal;
        std::vector<double> values(shape.basis.size()), phi(values.size()), plain(values.size(), 0.0);
        const double error = curved_irradiance(x, normal, shape, 1e-9, values);
        for (const geometry::Facet& facet : shape.facets)
            for (const geometry::TriangleNode& t : geometry::triangle_rule(32)) {
                Vec2 parameter;
                const geometry::SurfaceNode y = geometry::node_at(shape, facet, t.barycentric, parameter);
                const Vec3 way = y.position - x;
                const double kernel = glm::dot(normal, way) * -glm::dot(y.normal, way) /
                                      (pi * glm::dot(way, way) * glm::dot(way, way));
                shape.basis.evaluate(parameter, phi);
                for (std::size_t l = 0; l < phi.size(); ++l)
                    plain[l] += t.weight * y.weight * kernel * phi[l];
            }
        for (std::size_t l = 0; l < plain.size(); ++l)
            EXPECT_NEAR(values[l], plain[l], 1e-9 * plain[0] + error);
    }
}

TEST(CurvedIrradiance, does_not_depend_on_scale_and_place) {
    const model::Surface unit = support::tilted_surface(SurfaceType::Cylinder, -1.0);
    const auto at = [&](double scale, const Vec3& offset) {
        model::Surface s = unit;
        s.radius = scale;
        s.origin = scale * (unit.origin + offset);
        const auto shapes = elements(support::surface_patch(s, {0, 0}, {1, scale}), 1, 2);
        const geometry::SurfaceJet jet = geometry::evaluate(s, {0.4, -0.01 * scale});
        return factor(jet.position, s.axis_w, shapes, 1e-7).value;
    };
    const double value = at(1.0, Vec3(0.0));
    EXPECT_GT(value, 0.05);
    EXPECT_NEAR(at(1e-6, Vec3(0.0)), value, 1e-7 * value);
    EXPECT_NEAR(at(1e6, Vec3(0.0)), value, 1e-7 * value);
    EXPECT_NEAR(at(1.0, Vec3(1e3, -1e3, 1e3)), value, 1e-7 * value);
}

TEST(CurvedIrradiance, hidden_points_do_not_count) {
    const model::Surface sphere = support::tilted_surface(SurfaceType::Sphere);
    const auto shapes = elements(support::whole_sphere(), 4, 0);
    const Vec3 way(0.0, 0.0, 1.0), x = sphere.origin - 2.0 * way;
    double sum = 0.0, open = 0.0;
    std::vector<double> values(1);
    for (const ElementShape& shape : shapes) {
        curved_irradiance(x, way, shape, 1e-3, values);
        open += values[0] * std::sqrt(shape.area);
        curved_irradiance(x, way, shape, 1e-3, values, [&](const Vec3& y) { return y.x > sphere.origin.x; });
        sum += values[0] * std::sqrt(shape.area);
    }
    EXPECT_NEAR(open, 0.25, 1e-3);
    EXPECT_NEAR(sum, 0.125, 0.01);
}

TEST(CurvedIrradiance, a_receiver_behind_the_surface_gets_nothing) {
    const model::Surface sphere = support::tilted_surface(SurfaceType::Sphere);
    const auto shapes = elements(support::whole_sphere(), 4, 2);
    const geometry::SurfaceJet jet = geometry::evaluate(sphere, {0.4, 0.3});
    EXPECT_EQ(factor(jet.position, jet.normal, shapes, 1e-6).value, 0.0);
    EXPECT_EQ(factor(sphere.origin, jet.normal, shapes, 1e-6).value, 0.0);
}

TEST(CurvedIrradiance, estimated_errors_cover_the_true_ones) {
    const auto shapes = elements(part(SurfaceType::Torus, -1.0, {0, 0}, {1, 1.5}), 2, 3);
    const model::Surface s = support::tilted_surface(SurfaceType::Torus, -1.0);
    const geometry::SurfaceJet jet = geometry::evaluate(s, {0.45, 0.3});
    for (const double lift : {0.0, 1e-3, 0.1})
        for (const ElementShape& shape : shapes) {
            std::vector<double> fine(shape.basis.size()), coarse(shape.basis.size());
            const Vec3 x = jet.position + lift * jet.normal;
            curved_irradiance(x, jet.normal, shape, 1e-9, fine);
            for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-6}) {
                const double error = curved_irradiance(x, jet.normal, shape, tolerance, coarse);
                double difference = 0.0, size = 0.0;
                for (std::size_t l = 0; l < fine.size(); ++l) {
                    difference += (fine[l] - coarse[l]) * (fine[l] - coarse[l]);
                    size += fine[l] * fine[l];
                }
                EXPECT_LE(std::sqrt(difference), error + 1e-8 * std::sqrt(size) + 1e-12);
                EXPECT_LE(error, 1.5 * tolerance * std::sqrt(size) + 1e-11);
            }
        }
}

} // namespace
} // namespace kinelux::kernel
