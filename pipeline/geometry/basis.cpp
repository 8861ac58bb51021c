// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"

namespace kinelux::geometry {

namespace {

// A function whose part orthogonal to the earlier ones is below this share of it is not determined by the domain.
constexpr double rank_tolerance = 1e-6;
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

double dot(std::span<const double> a, std::span<const double> b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

} // namespace

Basis::Basis(std::span<const DomainPoint> domain, int degree) : degree_(degree) {
    if (degree < 0 || degree > max_degree)
        throw core::OptionError("basis degree " + std::to_string(degree) + " is not in 0.." +
                                std::to_string(max_degree));
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

    // The weighted Vandermonde matrix: column m holds sqrt(w) L_m at the points.
    const std::size_t n = size(), points = domain.size();
    std::vector<double> vandermonde(n * points), values(n);
    for (std::size_t p = 0; p < points; ++p) {
        legendre_products(domain[p].parameter, values);
        for (std::size_t m = 0; m < n; ++m)
            vandermonde[m * points + p] = std::sqrt(domain[p].weight) * values[m];
    }

    // Gram-Schmidt on its columns, twice over with the columns computed afresh from the coefficients in between.
    coefficients_.assign(n * n, 0.0);
    for (std::size_t k = 0; k < n; ++k) coefficients_[k * n + k] = 1.0;
    std::vector<double> q(n * points);
    for (int pass = 0; pass < 2; ++pass)
        for (std::size_t k = 0; k < n; ++k) {
            const std::span<double> column(&q[k * points], points);
            std::fill(column.begin(), column.end(), 0.0);
            for (std::size_t m = 0; m <= k; ++m)
                for (std::size_t p = 0; p < points; ++p)
                    column[p] += coefficients_[k * n + m] * vandermonde[m * points + p];
            const double before = std::sqrt(dot(column, column));
            for (std::size_t j = 0; j < k; ++j) {
                const std::span<const double> earlier(&q[j * points], points);
                const double overlap = dot(column, earlier);
                for (std::size_t p = 0; p < points; ++p) column[p] -= overlap * earlier[p];
                for (std::size_t m = 0; m <= j; ++m)
                    coefficients_[k * n + m] -= overlap * coefficients_[j * n + m];
            }
            const double length = std::sqrt(dot(column, column));
            if (!(length > rank_tolerance * before)) {
                *this = Basis(domain, degree - 1);
                return;
            }
            for (double& x : column) x /= length;
            for (std::size_t m = 0; m <= k; ++m) coefficients_[k * n + m] /= length;
        }
}

void Basis::legendre_products(const Vec2& parameter, std::span<double> values) const {
    const Vec2 d = parameter - centre_;
    const double x = glm::dot(d, axis_u_) * inverse_half_extent_.x;
    const double y = glm::dot(d, axis_v_) * inverse_half_extent_.y;
    std::array<double, max_degree + 1> px{1.0, x}, py{1.0, y};
    for (int k = 2; k <= degree_; ++k) {
        const auto i = static_cast<std::size_t>(k);
        px[i] = ((2 * k - 1) * x * px[i - 1] - (k - 1) * px[i - 2]) / k;
        py[i] = ((2 * k - 1) * y * py[i - 1] - (k - 1) * py[i - 2]) / k;
    }
    std::size_t m = 0;
    for (int total = 0; total <= degree_; ++total)
        for (int j = 0; j <= total; ++j)
            values[m++] = px[static_cast<std::size_t>(total - j)] * py[static_cast<std::size_t>(j)];
}

void Basis::evaluate(const Vec2& parameter, std::span<double> values) const {
    std::array<double, basis_size(max_degree)> products;
    legendre_products(parameter, products);
    const std::size_t n = size();
    for (std::size_t k = 0; k < n; ++k) {
        double sum = 0.0;
        for (std::size_t m = 0; m <= k; ++m) sum += coefficients_[k * n + m] * products[m];
        values[k] = sum;
    }
}

} // namespace kinelux::geometry
