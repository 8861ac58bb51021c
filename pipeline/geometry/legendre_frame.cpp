// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/legendre_frame.h"

#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "core/error.h"

namespace kinelux::geometry {

namespace {

// Domains rounder than this ratio of principal moments keep their parameter axes: principal axes would be arbitrary.
constexpr double isotropic_ratio = 1.5;

struct Inertia {
    double area = 0.0;
    Vec2 centre{0.0};
    double uu = 0.0, uv = 0.0, vv = 0.0; ///< central second moments per area
};

Inertia inertia_of(std::span<const DomainPoint> domain) {
    Inertia result;
    for (const DomainPoint& p : domain) {
        result.area += p.weight;
        result.centre += p.weight * p.parameter;
    }
    if (!(result.area > 0.0))
        throw core::GeometryError("an element has no area; clean the mesh of degenerate faces");
    result.centre /= result.area;
    for (const DomainPoint& p : domain) {
        const Vec2 d = p.parameter - result.centre;
        result.uu += p.weight / result.area * d.x * d.x;
        result.uv += p.weight / result.area * d.x * d.y;
        result.vv += p.weight / result.area * d.y * d.y;
    }
    return result;
}

Vec2 principal_axis(const Inertia& inertia) {
    const double mean = 0.5 * (inertia.uu + inertia.vv);
    const double spread = std::hypot(0.5 * (inertia.uu - inertia.vv), inertia.uv);
    if (mean + spread <= isotropic_ratio * (mean - spread)) return {1.0, 0.0};
    const double angle = 0.5 * std::atan2(2.0 * inertia.uv, inertia.uu - inertia.vv);
    return {std::cos(angle), std::sin(angle)};
}

} // namespace

LegendreFrame::LegendreFrame(std::span<const DomainPoint> domain) {
    const Inertia inertia = inertia_of(domain);
    centre_ = inertia.centre;
    axis_u_ = principal_axis(inertia);
    axis_v_ = {-axis_u_.y, axis_u_.x};
    Vec2 half_extent(0.0);
    for (const DomainPoint& p : domain) {
        const Vec2 d = p.parameter - centre_;
        half_extent = glm::max(half_extent, glm::abs(Vec2(glm::dot(d, axis_u_), glm::dot(d, axis_v_))));
    }
    inverse_half_extent_ = 1.0 / glm::max(half_extent, Vec2(std::numeric_limits<double>::min() * 1e20));
}

Vec2 LegendreFrame::scaled(const Vec2& parameter) const {
    const Vec2 d = parameter - centre_;
    return Vec2(glm::dot(d, axis_u_), glm::dot(d, axis_v_)) * inverse_half_extent_;
}

void LegendreFrame::products(const Vec2& parameter, int degree, std::span<double> values) const {
    const Vec2 at = scaled(parameter);
    const double x = at.x, y = at.y;
    std::array<double, max_degree + 1> px{1.0, x}, py{1.0, y};
    for (int k = 2; k <= degree; ++k) {
        const auto i = static_cast<std::size_t>(k);
        px[i] = ((2 * k - 1) * x * px[i - 1] - (k - 1) * px[i - 2]) / k;
        py[i] = ((2 * k - 1) * y * py[i - 1] - (k - 1) * py[i - 2]) / k;
    }
    std::size_t m = 0;
    for (int total = 0; total <= degree; ++total)
        for (int j = 0; j <= total; ++j)
            values[m++] = px[static_cast<std::size_t>(total - j)] * py[static_cast<std::size_t>(j)];
}

} // namespace kinelux::geometry
