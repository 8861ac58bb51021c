// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/tessellation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/domain_cut.h"
#include "geometry/surface.h"

namespace kinelux::geometry {

namespace {

using model::DomainTriangle;
using model::Surface;
using model::SurfaceType;

constexpr double steps_a_turn = 48.0, steps_a_span = 16.0;

// Distance of the lines along u or v; 0: none are needed.
Vec2 steps_of(const Surface& s) {
    constexpr double round = 2.0 * std::numbers::pi / steps_a_turn;
    switch (s.type) {
    case SurfaceType::Plane: return {0.0, 0.0};
    case SurfaceType::Cylinder:
    case SurfaceType::Cone: return {round, 0.0};
    case SurfaceType::Sphere:
    case SurfaceType::Torus: return {round, round};
    case SurfaceType::BSpline: {
        const auto span = [](const std::vector<double>& knots) {
            return (knots.back() - knots.front()) / steps_a_span;
        };
        return {span(s.bspline.knots_u), span(s.bspline.knots_v)};
    }
    case SurfaceType::Bilinear: return Vec2{1.0 / steps_a_span};
    }
    return {0.0, 0.0};
}

// Both ends and the multiples of a step between them.
std::vector<double> lines(double low, double high, double step) {
    constexpr double apart = 1e-6; // of a step: what is nearer to an end is the end
    std::vector<double> result{low};
    if (step > 0.0) {
        for (double k = std::floor(low / step + apart) + 1.0; k * step < high - apart * step; k += 1.0)
            result.push_back(k * step);
    }
    result.push_back(high);
    return result;
}

} // namespace

std::vector<DomainTriangle> tessellated(const Surface& surface, std::span<const DomainTriangle> domain) {
    const Vec2 step = steps_of(surface);
    std::vector<DomainTriangle> result(domain.begin(), domain.end());
    if (domain.empty() || (step.x == 0.0 && step.y == 0.0)) return result;
    Vec2 low = domain.front()[0], high = low;
    for (const DomainTriangle& t : domain)
        for (const Vec2& p : t) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    result.clear();
    for (const DomainCell& cell :
         cut_domain(domain, lines(low.x, high.x, step.x), lines(low.y, high.y, step.y)))
        result.insert(result.end(), cell.triangles.begin(), cell.triangles.end());
    return result;
}

std::vector<DomainTriangle> domain_of(const model::Patch& patch) {
    std::vector<DomainTriangle> domain;
    for (const model::Triangle& t : patch.triangles)
        domain.push_back({patch.points[t[0]], patch.points[t[1]], patch.points[t[2]]});
    return domain;
}

double chord_height(const model::Patch& patch) {
    if (patch.surface.type == SurfaceType::Plane) return 0.0;
    // Middles of edges, and the centroid.
    constexpr std::array<std::array<double, 3>, 4> places{
        {{0.5, 0.5, 0.0}, {0.0, 0.5, 0.5}, {0.5, 0.0, 0.5}, {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}}};
    double height = 0.0;
    for (const DomainTriangle& t : tessellated(patch.surface, domain_of(patch))) {
        const std::array<Vec3, 3> x{position(patch.surface, t[0]), position(patch.surface, t[1]),
                                    position(patch.surface, t[2])};
        for (const auto& [a, b, c] : places) {
            const SurfaceTangents at = surface_tangents(patch.surface, a * t[0] + b * t[1] + c * t[2]);
            const Vec3 across = patch.surface.orientation * glm::cross(at.along_u, at.along_v);
            const double length = glm::length(across);
            if (!(length > 0.0)) continue; // a pole
            height =
                std::max(height, glm::dot(a * x[0] + b * x[1] + c * x[2] - at.position, across) / length);
        }
    }
    return height;
}

} // namespace kinelux::geometry
