// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "core/error.h"
#include "geometry/quadrature.h"

namespace kinelux::geometry {

namespace {

SurfaceTangents plane(const model::Surface& s, const Vec2& uv) {
    return {s.origin + uv.x * s.axis_u + uv.y * s.axis_v, s.axis_u, s.axis_v};
}

SurfaceTangents bilinear(const model::Surface& s, const Vec2& uv) {
    const auto& [a, b, c, d] = s.corners;
    const double u = uv.x, v = uv.y;
    return {(1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * d + u * c),
            (1.0 - v) * (b - a) + v * (c - d), (1.0 - u) * (d - a) + u * (c - b)};
}

// Cylinders and cones: a circle of radius r(v) = radius + slope v, moved along axis_w.
SurfaceTangents lathed_line(const model::Surface& s, const Vec2& uv, double slope) {
    const Vec3 e = std::cos(uv.x) * s.axis_u + std::sin(uv.x) * s.axis_v;
    const Vec3 e_u = std::cos(uv.x) * s.axis_v - std::sin(uv.x) * s.axis_u;
    const double r = s.radius + slope * uv.y;
    return {s.origin + r * e + uv.y * s.axis_w, r * e_u, slope * e + s.axis_w};
}

// Spheres and tori: a circle of radius `minor` about the point `major` e(u).
SurfaceTangents lathed_circle(const model::Surface& s, const Vec2& uv, double major, double minor) {
    const Vec3 e = std::cos(uv.x) * s.axis_u + std::sin(uv.x) * s.axis_v;
    const Vec3 e_u = std::cos(uv.x) * s.axis_v - std::sin(uv.x) * s.axis_u;
    const double r = major + minor * std::cos(uv.y);
    return {s.origin + r * e + minor * std::sin(uv.y) * s.axis_w, r * e_u,
            minor * (std::cos(uv.y) * s.axis_w - std::sin(uv.y) * e)};
}

// The B-spline functions of one direction that are not zero at a parameter, with their derivatives.
struct SplineFunctions {
    std::size_t first = 0; // number of the first of degree + 1 functions
    std::vector<double> values, derivatives;
};

// Cox and de Boor: functions of degree d from those of degree d - 1. At index i of `lower` stands the function
// first + i of degree d - 1, counted from the span's left end.
std::vector<double> raise_degree(const std::vector<double>& knots, std::size_t span, std::size_t d, double t,
                                 const std::vector<double>& lower) {
    std::vector<double> raised(d + 1, 0.0);
    for (std::size_t i = 0; i < d; ++i) {
        const double low = knots[span - d + 1 + i];
        const double high = knots[span + 1 + i];
        const double share = lower[i] / (high - low);
        raised[i] += (high - t) * share;
        raised[i + 1] += (t - low) * share;
    }
    return raised;
}

SplineFunctions spline_functions(const std::vector<double>& knots, std::size_t degree, std::size_t count,
                                 double t) {
    t = std::clamp(t, knots[degree], knots[count]);
    // The last span that is not empty and starts at or before t.
    std::size_t span = degree;
    for (std::size_t i = degree; i < count; ++i) {
        if (knots[i] <= t && knots[i] < knots[i + 1]) span = i;
    }
    SplineFunctions result;
    result.first = span - degree;
    std::vector<double> lower;
    result.values = {1.0};
    for (std::size_t d = 1; d <= degree; ++d) {
        lower = result.values;
        result.values = raise_degree(knots, span, d, t, lower);
    }
    result.derivatives.assign(degree + 1, 0.0);
    for (std::size_t i = 0; i < degree; ++i) {
        const double share =
            static_cast<double>(degree) * lower[i] / (knots[span + 1 + i] - knots[span - degree + 1 + i]);
        result.derivatives[i] -= share;
        result.derivatives[i + 1] += share;
    }
    return result;
}

void check_spline(const model::BSpline& s) {
    const std::size_t poles = std::size_t{s.count_u} * s.count_v;
    const bool fits = s.count_u > s.degree_u && s.count_v > s.degree_v && s.poles.size() == poles &&
                      s.knots_u.size() == std::size_t{s.count_u} + s.degree_u + 1 &&
                      s.knots_v.size() == std::size_t{s.count_v} + s.degree_v + 1 &&
                      (s.weights.empty() || s.weights.size() == poles);
    if (!fits) throw core::GeometryError("a B-spline surface's poles, knots and weights do not fit together");
    if (!(s.knots_u[s.degree_u] < s.knots_u[s.count_u]) || !(s.knots_v[s.degree_v] < s.knots_v[s.count_v])) {
        throw core::GeometryError("a B-spline surface's knots span no parameter range");
    }
}

SurfaceTangents spline(const model::BSpline& s, const Vec2& uv) {
    check_spline(s);
    const SplineFunctions along_u = spline_functions(s.knots_u, s.degree_u, s.count_u, uv.x);
    const SplineFunctions along_v = spline_functions(s.knots_v, s.degree_v, s.count_v, uv.y);
    // Homogeneous sums: numerators (weight times pole) and the weight itself, each with both derivatives.
    Vec3 top{0.0}, top_u{0.0}, top_v{0.0};
    double weight = 0.0, weight_u = 0.0, weight_v = 0.0;
    for (std::size_t j = 0; j < along_v.values.size(); ++j) {
        for (std::size_t i = 0; i < along_u.values.size(); ++i) {
            const std::size_t pole = (along_v.first + j) * s.count_u + along_u.first + i;
            const double w = s.weights.empty() ? 1.0 : s.weights[pole];
            const double b = w * along_u.values[i] * along_v.values[j];
            const double b_u = w * along_u.derivatives[i] * along_v.values[j];
            const double b_v = w * along_u.values[i] * along_v.derivatives[j];
            top += b * s.poles[pole];
            top_u += b_u * s.poles[pole];
            top_v += b_v * s.poles[pole];
            weight += b;
            weight_u += b_u;
            weight_v += b_v;
        }
    }
    const Vec3 x = top / weight;
    return {x, (top_u - weight_u * x) / weight, (top_v - weight_v * x) / weight};
}

} // namespace

SurfaceTangents surface_tangents(const model::Surface& s, const Vec2& uv) {
    switch (s.type) {
    case model::SurfaceType::Plane: return plane(s, uv);
    case model::SurfaceType::Cylinder: return lathed_line(s, uv, 0.0);
    case model::SurfaceType::Cone: return lathed_line(s, uv, std::tan(s.half_angle_rad));
    case model::SurfaceType::Sphere: return lathed_circle(s, uv, 0.0, s.radius);
    case model::SurfaceType::Torus: return lathed_circle(s, uv, s.radius, s.minor_radius);
    case model::SurfaceType::BSpline: return spline(s.bspline, uv);
    case model::SurfaceType::Bilinear: return bilinear(s, uv);
    }
    throw core::GeometryError("a surface of unknown type");
}

SurfaceJet evaluate(const model::Surface& surface, const Vec2& uv) {
    const SurfaceTangents d = surface_tangents(surface, uv);
    const Vec3 across = glm::cross(d.along_u, d.along_v);
    const double area_factor = glm::length(across);
    if (!(area_factor > 0.0) || !std::isfinite(area_factor)) {
        throw core::GeometryError("a surface has no normal at u = " + std::to_string(uv.x) + ", v = " +
                                  std::to_string(uv.y) + "; keep its domain away from poles and tips");
    }
    return {d.position, (surface.orientation / area_factor) * across, area_factor};
}

SurfaceJet evaluate_towards(const model::Surface& surface, const Vec2& uv, const Vec2& inside) {
    constexpr double way = 1e-6;
    try {
        return evaluate(surface, uv);
    } catch (const core::GeometryError&) {
        return evaluate(surface, uv + way * (inside - uv));
    }
}

Vec3 position(const model::Surface& surface, const Vec2& uv) {
    return surface_tangents(surface, uv).position;
}

model::Surface moved(const model::Surface& surface, const Pose& pose) {
    model::Surface result = surface;
    result.origin = pose.point(surface.origin);
    for (Vec3 model::Surface::*axis :
         {&model::Surface::axis_u, &model::Surface::axis_v, &model::Surface::axis_w})
        result.*axis = pose.direction(surface.*axis);
    for (Vec3& pole : result.bspline.poles) pole = pose.point(pole);
    for (Vec3& corner : result.corners) corner = pose.point(corner);
    return result;
}

Vec2 plane_parameters(const model::Surface& surface, const Vec3& x) {
    const Vec3 offset = x - surface.origin;
    return {glm::dot(offset, surface.axis_u), glm::dot(offset, surface.axis_v)};
}

namespace {

// Degree of a triangle's rule for the area factor: constant on planes and cylinders, linear on cones; over half a turn of
// v the cosine of spheres and tori is as good as a polynomial of degree 20.
int area_degree(const model::Surface& surface) {
    switch (surface.type) {
    case model::SurfaceType::Plane:
    case model::SurfaceType::Cylinder: return 0;
    case model::SurfaceType::Cone: return 1;
    default: return 20;
    }
}

} // namespace

double area(const model::Patch& patch) {
    double sum = 0.0;
    for (const model::Triangle& t : patch.triangles) {
        const Vec2 &p = patch.points[t[0]], a = patch.points[t[1]] - p, b = patch.points[t[2]] - p;
        double mean = 0.0;
        for (const TriangleNode& node : triangle_rule(area_degree(patch.surface)))
            mean +=
                node.weight *
                evaluate(patch.surface, p + node.barycentric[1] * a + node.barycentric[2] * b).area_factor;
        sum += 0.5 * std::abs(a.x * b.y - a.y * b.x) * mean;
    }
    return sum;
}

double area(const model::SmallTriangles& small) {
    double sum = 0.0;
    for (const auto& [a, b, c] : small.triangles) {
        const Vec3& p = small.points[a];
        sum += 0.5 * glm::length(glm::cross(small.points[b] - p, small.points[c] - p));
    }
    return sum;
}

} // namespace kinelux::geometry
