// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/polygon_moments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/quadrature.h"

namespace kinelux::kernel {

namespace {

// The point x stands at height h over its foot O in the plane. Along the ray from O over s w, 0 <= s <= 1, to a point of
// the boundary at distance rho = |w|, the kernel times a monomial of degree m is
//   h (s n.w - h n.front) s^m / (pi (s^2 rho^2 + h^2)^2),
// and dA = s ds (w x dw). Its radial integrals are combinations of I_m = integral of s^(m+1) / (s^2 rho^2 + h^2)^2 ds.

constexpr std::size_t most_moments = geometry::max_degree + 2;

// h I_m and h^2 I_m for m = 0 .. count-1; h I_0 is infinite at h = 0 and not given.
struct RadialIntegrals {
    std::array<double, most_moments> h_times, h2_times;
};

// rho >= h/2: upwards by rho^2 I_(m+2) + h^2 I_m = J_m, rho^2 J_(m+2) + h^2 J_m = 1 / (m + 2).
RadialIntegrals radial_upwards(double rho2, double h, std::size_t count) {
    RadialIntegrals result;
    const double rho = std::sqrt(rho2), h2 = h * h, r2 = rho2 + h2;
    std::array<double, most_moments> i, j;         // h I_m, h J_m
    const double angle = std::atan2(rho, h) / rho; // h J_(-1)
    j[0] = h * std::log1p(rho2 / h2) / (2.0 * rho2);
    j[1] = (h - h2 * angle) / rho2;
    result.h2_times[0] = 0.5 / r2;
    i[1] = (angle - h / r2) / (2.0 * rho2);
    if (h2 > 0.0)
        i[2] = (j[0] - h * result.h2_times[0]) / rho2;
    else
        j[0] = i[2] = 0.0;
    for (std::size_t m = 2; m < count; ++m) j[m] = (h / static_cast<double>(m) - h2 * j[m - 2]) / rho2;
    for (std::size_t m = 3; m < count; ++m) i[m] = (j[m - 2] - h2 * i[m - 2]) / rho2;
    result.h_times[0] = 0.0;
    for (std::size_t m = 1; m < count; ++m) {
        result.h_times[m] = i[m];
        result.h2_times[m] = h * i[m];
    }
    return result;
}

// rho < h/2: the highest two by their series in z = rho^2 / h^2, then downwards.
RadialIntegrals radial_downwards(double rho2, double h, std::size_t count) {
    constexpr int terms = 24; // 0.25^24 is below the rounding error
    const double z = rho2 / (h * h);
    std::array<double, most_moments> i, j; // h^4 I_m, h^2 J_m
    for (std::size_t m = count < 2 ? 0 : count - 2; m < count; ++m) {
        i[m] = j[m] = 0.0;
        double power = 1.0;
        for (int k = 0; k < terms && std::abs(power) > 1e-17; ++k, power *= -z) {
            const double share = power / (static_cast<double>(m) + 2.0 + 2.0 * k);
            i[m] += (k + 1) * share;
            j[m] += share;
        }
    }
    for (std::size_t m = count; m-- > 2;) {
        j[m - 2] = 1.0 / static_cast<double>(m) - z * j[m];
        i[m - 2] = j[m - 2] - z * i[m];
    }
    RadialIntegrals result;
    for (std::size_t m = 0; m < count; ++m) {
        result.h2_times[m] = i[m] / (h * h);
        result.h_times[m] = result.h2_times[m] / h;
    }
    return result;
}

RadialIntegrals radial_integrals(double rho2, double h, std::size_t count) {
    return rho2 < 0.25 * h * h ? radial_downwards(rho2, h, count) : radial_upwards(rho2, h, count);
}

// Gauss nodes for a stretch of length `span` in s whose nearest poles are at +-i pi/2: the error falls by the square of
// the sum of half axes of the ellipse through them with each node.
int nodes_for(double span, double tolerance) {
    constexpr double safety = 30.0; // poles of second order, and the size of the integrand on the ellipse
    const double axis = std::numbers::pi / span;
    const double rate = 2.0 * std::log(axis + std::sqrt(axis * axis + 1.0));
    return std::clamp(static_cast<int>(std::ceil(std::log(safety / tolerance) / rate)), 2, 24);
}

constexpr std::size_t monomial(std::size_t x_power, std::size_t y_power) {
    const std::size_t total = x_power + y_power;
    return total * (total + 1) / 2 + y_power;
}

using Moments = std::array<double, geometry::basis_size(geometry::max_degree)>;

// One edge's share of the moments of the monomials of (x, y) = scaled coordinates from the foot O.
struct EdgeIntegrator {
    double h, normal_front;
    Vec2 normal_in_plane;
    Vec2 scaled_u, scaled_v;
    std::size_t degree;
    double tolerance;

    void add(const Vec2& a, const Vec2& b, Moments& moments) const {
        const double length = glm::distance(a, b);
        if (!(length > 0.0)) return;
        const Vec2 along = (b - a) / length;
        const double distance =
            a.x * along.y - a.y * along.x; // of the edge's line from O, > 0: O to its left
        const double c = std::hypot(distance, h);
        const double t0 = glm::dot(a, along), t1 = t0 + length;
        if (std::abs(distance) < std::numeric_limits<double>::epsilon() * length) return;
        const double s0 = std::asinh(t0 / c), s1 = std::asinh(t1 / c);
        constexpr double longest_stretch = 2.0;
        const int stretches = std::max(1, static_cast<int>(std::ceil((s1 - s0) / longest_stretch)));
        const double span = (s1 - s0) / stretches;
        const geometry::GaussRule& gauss = geometry::gauss_rule(nodes_for(span, tolerance));
        const Vec2 foot = a - t0 * along;
        for (int k = 0; k < stretches; ++k)
            for (std::size_t i = 0; i < gauss.nodes.size(); ++i) {
                const double s = s0 + span * (k + gauss.nodes[i]);
                const double grown = std::exp(s), shrunk = 1.0 / grown;
                const double t = 0.5 * c * (grown - shrunk);
                const double weight = 0.5 * c * (grown + shrunk) * span * gauss.weights[i] * distance;
                add_ray(foot + t * along, distance * distance + t * t, weight, moments);
            }
    }

    void add_ray(const Vec2& w, double rho2, double weight, Moments& moments) const {
        const RadialIntegrals radial = radial_integrals(rho2, h, degree + 2);
        const double slope = glm::dot(normal_in_plane, w);
        const Vec2 direction = w.x * scaled_u + w.y * scaled_v;
        std::array<double, geometry::max_degree + 1> x{1.0}, y{1.0};
        for (std::size_t m = 1; m <= degree; ++m) {
            x[m] = x[m - 1] * direction.x;
            y[m] = y[m - 1] * direction.y;
        }
        for (std::size_t m = 0; m <= degree; ++m) {
            const double value = weight * (slope * radial.h_times[m + 1] - normal_front * radial.h2_times[m]);
            for (std::size_t j = 0; j <= m; ++j) moments[monomial(m - j, j)] += value * x[m - j] * y[j];
        }
    }
};

// Moments about O into moments about the origin of the scaled coordinates, where O is at `foot`.
Moments shifted(const Moments& moments, const Vec2& foot, std::size_t degree) {
    static constexpr auto binomial = [] {
        std::array<std::array<double, geometry::max_degree + 1>, geometry::max_degree + 1> b{};
        for (std::size_t n = 0; n <= geometry::max_degree; ++n) {
            b[n][0] = b[n][n] = 1.0;
            for (std::size_t k = 1; k < n; ++k) b[n][k] = b[n - 1][k - 1] + b[n - 1][k];
        }
        return b;
    }();
    // First along x, then along y.
    Moments along_x{}, result{};
    for (std::size_t total = 0; total <= degree; ++total)
        for (std::size_t j = 0; j <= total; ++j) {
            const std::size_t i = total - j;
            double power = 1.0;
            for (std::size_t p = i + 1; p-- > 0; power *= foot.x)
                along_x[monomial(i, j)] += binomial[i][p] * power * moments[monomial(p, j)];
        }
    for (std::size_t total = 0; total <= degree; ++total)
        for (std::size_t j = 0; j <= total; ++j) {
            const std::size_t i = total - j;
            double power = 1.0;
            for (std::size_t q = j + 1; q-- > 0; power *= foot.y)
                result[monomial(i, j)] += binomial[j][q] * power * along_x[monomial(i, q)];
        }
    return result;
}

// The moment of 1 by Lambert's formula: per edge the angle it subtends times the cosine between the normal and the plane
// through edge and point.
// @param turnover  is set to the sum of what the edges contribute, each without its sign
double constant_moment(const Vec3& normal, double h, const Vec2& foot, const visibility::Loops2& loops,
                       double& turnover) {
    double sum = 0.0, absolute = 0.0;
    for (std::size_t l = 0; l < loops.size(); ++l) {
        const std::span<const Vec2> loop = loops[l];
        Vec3 a(loop.back() - foot, -h);
        for (const Vec2& corner : loop) {
            const Vec3 b(corner - foot, -h);
            const Vec3 cross = glm::cross(b, a);
            const double sine = glm::length(cross);
            if (sine > 0.0) {
                const double edge = std::atan2(sine, glm::dot(a, b)) * glm::dot(normal, cross) / sine;
                sum += edge;
                absolute += std::abs(edge);
            }
            a = b;
        }
    }
    turnover = 0.5 * absolute;
    return 0.5 * sum;
}

} // namespace

PolygonMoments::PolygonMoments(const geometry::Facet& facet, const geometry::Basis& basis)
    : origin_(facet.corners[0]),
      front_(facet.normal),
      degree_(basis.degree()),
      monomials_(basis.monomial_coefficients()) {
    axis_u_ = glm::normalize(facet.corners[1] - facet.corners[0]);
    axis_v_ = glm::cross(front_, axis_u_);
    // The scaled coordinates at the facet's corners give their map from the plane's.
    const Vec2 e1 = to_plane(facet.corners[1]), e2 = to_plane(facet.corners[2]);
    scaled_origin_ = basis.scaled(facet.parameters[0]);
    scaled_u_ = (basis.scaled(facet.parameters[1]) - scaled_origin_) / e1.x;
    scaled_v_ = (basis.scaled(facet.parameters[2]) - scaled_origin_ - e2.x * scaled_u_) / e2.y;
}

Vec2 PolygonMoments::to_plane(const Vec3& point) const {
    return {glm::dot(point - origin_, axis_u_), glm::dot(point - origin_, axis_v_)};
}

void PolygonMoments::to_plane(const visibility::Loops3& loops, visibility::Loops2& flat) const {
    flat.points.resize(loops.points.size());
    std::transform(loops.points.begin(), loops.points.end(), flat.points.begin(),
                   [&](const Vec3& point) { return to_plane(point); });
    flat.ends = loops.ends;
}

double PolygonMoments::gather(const Vec3& x, const Vec3& normal, const visibility::Loops2& loops,
                              double tolerance, std::span<double> values) const {
    std::fill(values.begin(), values.end(), 0.0);
    const double h = glm::dot(front_, x - origin_);
    if (!(h > 0.0)) return 0.0;
    const Vec2 foot = to_plane(x);
    constexpr double closed_form = 1e-9; // its terms cancel where the polygon looks small
    if (degree_ == 0 && tolerance >= closed_form) {
        const Vec3 in_plane(glm::dot(normal, axis_u_), glm::dot(normal, axis_v_), glm::dot(normal, front_));
        double turnover = 0.0;
        values[0] = monomials_[0] * constant_moment(in_plane, h, foot, loops, turnover) / std::numbers::pi;
        return std::numeric_limits<double>::epsilon() * turnover / std::numbers::pi;
    }
    const Vec2 scaled_foot = scaled_origin_ + foot.x * scaled_u_ + foot.y * scaled_v_;
    // Moments about a foot far outside the domain cancel when they are taken about its centre.
    const double cancellation =
        std::pow(1.0 + std::max(std::abs(scaled_foot.x), std::abs(scaled_foot.y)), degree_);
    constexpr double finest = 1e-15;
    const EdgeIntegrator integrator{h,
                                    glm::dot(normal, front_),
                                    {glm::dot(normal, axis_u_), glm::dot(normal, axis_v_)},
                                    scaled_u_,
                                    scaled_v_,
                                    static_cast<std::size_t>(degree_),
                                    std::max(tolerance / cancellation, finest)};
    Moments moments{};
    double turnover = 0.0;
    for (std::size_t l = 0; l < loops.size(); ++l) {
        const std::span<const Vec2> loop = loops[l];
        for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
            const double before = moments[0];
            integrator.add(loop[j] - foot, loop[i] - foot, moments);
            turnover += std::abs(moments[0] - before);
        }
    }
    moments = shifted(moments, scaled_foot, static_cast<std::size_t>(degree_));
    for (std::size_t l = 0; l < values.size(); ++l) {
        double sum = 0.0;
        for (std::size_t m = 0; m < values.size(); ++m) sum += monomials_[l * values.size() + m] * moments[m];
        values[l] = sum / std::numbers::pi;
    }
    const double rounding = std::numeric_limits<double>::epsilon() * cancellation;
    return std::max(tolerance, rounding) * turnover / std::numbers::pi;
}

} // namespace kinelux::kernel
