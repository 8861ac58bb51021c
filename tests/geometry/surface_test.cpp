// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/error.h"
#include "geometry/quadrature.h"

namespace kinelux::geometry {
namespace {

// A frame in no special position.
model::Surface surface_of(model::SurfaceType type) {
    model::Surface s;
    s.type = type;
    s.origin = {1.0, -2.0, 0.5};
    s.axis_u = glm::normalize(Vec3{1.0, 2.0, 2.0});
    s.axis_v = glm::normalize(Vec3{2.0, 1.0, -2.0});
    s.axis_w = glm::cross(s.axis_u, s.axis_v);
    s.radius = 2.0;
    s.minor_radius = 0.5;
    s.half_angle_rad = 0.3;
    s.corners = {Vec3(0, 0, 0), Vec3(1, 0, 0.3), Vec3(1.2, 1, 0), Vec3(0, 0.9, 0.4)};
    return s;
}

// A quarter circle of radius 1 in the plane of x and y, swept along z: exact as a rational quadratic.
model::Surface quarter_pipe() {
    model::Surface s;
    s.type = model::SurfaceType::BSpline;
    const double w = std::sqrt(0.5);
    s.bspline.degree_u = 2;
    s.bspline.degree_v = 1;
    s.bspline.count_u = 3;
    s.bspline.count_v = 2;
    s.bspline.knots_u = {0.0, 0.0, 0.0, 1.0, 1.0, 1.0};
    s.bspline.knots_v = {0.0, 0.0, 2.0, 2.0};
    s.bspline.poles = {{1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}, {0.0, 1.0, 0.0},
                       {1.0, 0.0, 2.0}, {1.0, 1.0, 2.0}, {0.0, 1.0, 2.0}};
    s.bspline.weights = {1.0, w, 1.0, 1.0, w, 1.0};
    return s;
}

TEST(Surface, normal_and_area_factor_agree_with_differences) {
    for (const model::SurfaceType type :
         {model::SurfaceType::Plane, model::SurfaceType::Cylinder, model::SurfaceType::Cone,
          model::SurfaceType::Sphere, model::SurfaceType::Torus, model::SurfaceType::BSpline,
          model::SurfaceType::Bilinear}) {
        const model::Surface s = type == model::SurfaceType::BSpline ? quarter_pipe() : surface_of(type);
        const double h = 1e-6;
        const Vec2 uv{0.4, 0.3};
        const Vec3 x_u =
            (evaluate(s, uv + Vec2{h, 0.0}).position - evaluate(s, uv - Vec2{h, 0.0}).position) / (2.0 * h);
        const Vec3 x_v =
            (evaluate(s, uv + Vec2{0.0, h}).position - evaluate(s, uv - Vec2{0.0, h}).position) / (2.0 * h);
        const SurfaceJet jet = evaluate(s, uv);
        EXPECT_NEAR(jet.area_factor, glm::length(glm::cross(x_u, x_v)), 1e-8);
        EXPECT_NEAR(glm::distance(jet.normal, glm::normalize(glm::cross(x_u, x_v))), 0.0, 1e-8);
        EXPECT_NEAR(glm::length(jet.normal), 1.0, 1e-14);
    }
}

TEST(Surface, sphere_and_cylinder_points_lie_at_their_radius) {
    const model::Surface sphere = surface_of(model::SurfaceType::Sphere);
    EXPECT_NEAR(glm::distance(evaluate(sphere, {2.0, -0.7}).position, sphere.origin), 2.0, 1e-14);
    const model::Surface cylinder = surface_of(model::SurfaceType::Cylinder);
    const Vec3 offset = evaluate(cylinder, {2.0, 5.0}).position - cylinder.origin;
    EXPECT_NEAR(glm::dot(offset, cylinder.axis_w), 5.0, 1e-13);
    EXPECT_NEAR(glm::length(offset - 5.0 * cylinder.axis_w), 2.0, 1e-13);
}

TEST(Surface, rational_spline_holds_a_circle_exactly) {
    const model::Surface s = quarter_pipe();
    for (const double u : {0.0, 0.1, 0.37, 0.5, 0.99, 1.0}) {
        const SurfaceJet jet = evaluate(s, {u, 1.3});
        EXPECT_NEAR(std::hypot(jet.position.x, jet.position.y), 1.0, 1e-15);
        EXPECT_NEAR(jet.position.z, 1.3, 1e-15);
        EXPECT_NEAR(glm::distance(jet.normal, Vec3{jet.position.x, jet.position.y, 0.0}), 0.0, 1e-14);
    }
}

TEST(Surface, spline_with_inner_knots_reproduces_a_parabola) {
    // The quadratic with poles at the blossoms of u^2 for the knots 0 0 0 1 3 3 3.
    model::Surface s = quarter_pipe();
    s.bspline.weights.clear();
    s.bspline.count_u = 4;
    s.bspline.knots_u = {0.0, 0.0, 0.0, 1.0, 3.0, 3.0, 3.0};
    s.bspline.poles.clear();
    for (const double y : {0.0, 1.0}) {
        const std::vector<Vec2> arguments{{0.0, 0.0}, {0.0, 1.0}, {1.0, 3.0}, {3.0, 3.0}};
        for (const Vec2& a : arguments) s.bspline.poles.push_back({0.5 * (a.x + a.y), y, a.x * a.y});
    }
    for (const double u : {0.0, 0.5, 1.0, 1.7, 3.0}) {
        const Vec3 x = evaluate(s, {u, 1.0}).position;
        EXPECT_NEAR(x.x, u, 1e-14);
        EXPECT_NEAR(x.z, u * u, 1e-14);
    }
}

TEST(Surface, orientation_turns_the_normal) {
    model::Surface s = surface_of(model::SurfaceType::Torus);
    const Vec3 front = evaluate(s, {1.0, 1.0}).normal;
    s.orientation = -1.0;
    EXPECT_EQ(evaluate(s, {1.0, 1.0}).normal, -front);
}

TEST(Surface, plane_parameters_invert_the_plane) {
    const model::Surface s = surface_of(model::SurfaceType::Plane);
    const Vec3 x = evaluate(s, {3.0, -4.0}).position + 7.0 * s.axis_w;
    EXPECT_NEAR(plane_parameters(s, x).x, 3.0, 1e-14);
    EXPECT_NEAR(plane_parameters(s, x).y, -4.0, 1e-14);
}

model::Patch over(const model::Surface& surface, const Vec2& low, const Vec2& high) {
    model::Patch patch;
    patch.surface = surface;
    patch.points = {low, {high.x, low.y}, high, {low.x, high.y}};
    patch.triangles = {{0, 1, 2}, {0, 2, 3}};
    return patch;
}

TEST(Surface, areas_agree_with_their_closed_forms) {
    using model::SurfaceType;
    using std::numbers::pi;
    const double slope = std::tan(0.3);
    const auto at = [](SurfaceType type) { return surface_of(type); };
    EXPECT_NEAR(area(over(at(SurfaceType::Plane), {0, 1}, {2, 4})), 6.0, 1e-13);
    EXPECT_NEAR(area(over(at(SurfaceType::Cylinder), {0, -1}, {2 * pi, 2})), 12.0 * pi, 1e-12);
    EXPECT_NEAR(area(over(at(SurfaceType::Cone), {0, 0}, {pi, 3})), pi * (6.0 + 4.5 * slope) / std::cos(0.3),
                1e-12);
    EXPECT_NEAR(area(over(at(SurfaceType::Sphere), {0, -pi / 2}, {2 * pi, pi / 2})), 16.0 * pi, 1e-11);
    EXPECT_NEAR(area(over(at(SurfaceType::Torus), {0, 0}, {2 * pi, pi})), 4.0 * pi * pi * 0.5, 1e-11);
    EXPECT_NEAR(area(over(quarter_pipe(), {0, 0}, {1, 2})), pi, 1e-9);
}

TEST(Surface, bilinear_area_of_a_saddle_is_its_closed_form) {
    // z = x y over the unit square: the integral of sqrt(1 + x^2 + y^2), along y in closed form, along x by 32 nodes.
    model::Surface saddle;
    saddle.type = model::SurfaceType::Bilinear;
    saddle.corners = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 1), Vec3(0, 1, 0)};
    double exact = 0.0;
    const GaussRule& gauss = gauss_rule(32);
    for (std::size_t i = 0; i < gauss.nodes.size(); ++i) {
        const double c2 = 1.0 + gauss.nodes[i] * gauss.nodes[i];
        exact += gauss.weights[i] * 0.5 * (std::sqrt(c2 + 1.0) + c2 * std::asinh(1.0 / std::sqrt(c2)));
    }
    EXPECT_NEAR(area(over(saddle, {0, 0}, {1, 1})), exact, 1e-12);
}

TEST(Surface, points_without_normal_and_misfit_splines_are_refused) {
    model::Surface cone = surface_of(model::SurfaceType::Cone);
    cone.radius = 0.0;
    EXPECT_THROW(evaluate(cone, {1.0, 0.0}), core::GeometryError);
    model::Surface spline = quarter_pipe();
    spline.bspline.knots_u.pop_back();
    EXPECT_THROW(evaluate(spline, {0.5, 0.5}), core::GeometryError);
}

} // namespace
} // namespace kinelux::geometry
