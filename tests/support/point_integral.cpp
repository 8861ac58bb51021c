// SPDX-License-Identifier: GPL-3.0-or-later
// u: coordinate along a side from the foot of the perpendicular, d: distance of the side's line from the receiver's
// foot in the plane, h: height of the receiver, g = sqrt(d^2 + h^2), u = g sinh v. tau: from the foot (0) to the side (1).
#include "support/point_integral.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <Eigen/Dense>

#include "geometry/quadrature.h"

namespace kinelux::support {

namespace {

constexpr double far_ratio = 1.0; ///< distance / longest side from which the Gauss product is exact to 1e-10
/// Longest side of a triangle fit for polar integration, in area / size of the piece: its functions grow no faster
/// than by the piece's width.
constexpr double compact_ratio = 10.0;
constexpr double hollow_ratio = 60.0;   ///< size^2 / area of a piece with holes that is taken whole
constexpr double smallest_part = 1e-12; ///< of the piece: a part as small is never bisected
constexpr int gauss_nodes = 9;          ///< per direction of the far product at degree 0
constexpr int side_nodes = 11;          ///< per panel of a side at degree 0
constexpr double panel_length = 2.0;    ///< in v; the integrand's nearest poles lie at +-i pi/2
constexpr int radial_nodes = 15;        ///< where the closed radial form would cancel
constexpr double radial_limit = 0.5;    ///< h / R from which it would
constexpr std::size_t most_moments = geometry::max_degree + 2;

using Moments = std::array<double, most_moments>;

// j_m = integral from 0 to 1 of tau^(m+1) / (tau^2 + eta^2)^2, for m < count.
Moments radial_moments(double eta, std::size_t count) {
    Moments j{};
    if (eta > radial_limit) {
        const auto& rule = geometry::gauss_rule(radial_nodes);
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double tau = rule.nodes[i], denominator = tau * tau + eta * eta;
            double term = rule.weights[i] * tau / (denominator * denominator);
            for (std::size_t m = 0; m < count; ++m, term *= tau) j[m] += term;
        }
        return j;
    }
    // By parts from l_k = integral of tau^k / (tau^2 + eta^2): j_m = l_{m-1} - eta^2 j_{m-2}.
    const double eta2 = eta * eta;
    Moments l{};
    l[0] = std::atan2(1.0, eta) / eta;
    l[1] = 0.5 * std::log1p(1.0 / eta2);
    for (std::size_t k = 2; k < count; ++k) l[k] = 1.0 / static_cast<double>(k - 1) - eta2 * l[k - 2];
    j[0] = 0.5 / (eta2 * (1.0 + eta2));
    j[1] = 0.5 * (l[0] - 1.0 / (1.0 + eta2));
    for (std::size_t m = 2; m < count; ++m) j[m] = l[m - 1] - eta2 * j[m - 2];
    return j;
}

// The Padua points: as many as there are polynomials of a total degree, and well apart for them.
std::vector<Vec2> padua_points(int degree) {
    if (degree == 0) return {Vec2(0.0)};
    std::vector<Vec2> points;
    for (int j = 0; j <= degree; ++j)
        for (int k = j % 2; k <= degree + 1; k += 2)
            points.emplace_back(std::cos(j * std::numbers::pi / degree),
                                std::cos(k * std::numbers::pi / (degree + 1)));
    return points;
}

// Monomials p^i q^j in the order of i + j, within it of j.
template <class Function>
void for_monomials(int degree, const Vec2& p, const Function& function) {
    std::size_t index = 0;
    double row = 1.0;
    std::array<double, most_moments> powers_q{1.0};
    for (int m = 0; m <= degree; ++m) {
        if (m > 0) powers_q[m] = powers_q[m - 1] * p.y;
        row = 1.0;
        for (int i = 0; i <= m; ++i, row *= p.x)
            function(index++, static_cast<std::size_t>(m), row * powers_q[m - i]);
    }
}

// From integrals of monomials to weights at the Padua points.
const Eigen::MatrixXd& padua_from_monomials(int degree) {
    static const auto matrices = [] {
        std::array<Eigen::MatrixXd, geometry::max_degree + 1> result;
        for (int d = 0; d <= geometry::max_degree; ++d) {
            const auto points = padua_points(d);
            Eigen::MatrixXd vandermonde(points.size(), points.size());
            for (std::size_t r = 0; r < points.size(); ++r)
                for_monomials(d, points[r],
                              [&](std::size_t k, std::size_t, double value) { vandermonde(r, k) = value; });
            result[d] = vandermonde.inverse().transpose();
        }
        return result;
    }();
    return matrices[degree];
}

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 e = b - a;
    const double t = std::clamp(glm::dot(p - a, e) / glm::dot(e, e), 0.0, 1.0);
    return glm::distance(p, a + t * e);
}

double distance_to_triangle(const Vec2& p, const std::array<Vec2, 3>& corners) {
    bool inside = true;
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < 3; ++c) {
        const Vec2 &a = corners[c], &b = corners[(c + 1) % 3];
        inside = inside && cross(b - a, p - a) >= 0.0;
        distance = std::min(distance, distance_to_segment(p, a, b));
    }
    return inside ? 0.0 : distance;
}

} // namespace

PointIntegral::PointIntegral(const FlatPiece& piece, const geometry::Basis& basis)
    : plane_(piece.plane), basis_(basis) {
    for (const Polygon& polygon : piece.parts)
        for (std::size_t i = 2; i < polygon.size(); ++i)
            if (Part part = make_part({polygon[0], polygon[i - 1], polygon[i]}); part.area > 0.0)
                parts_.push_back(std::move(part));
    roots_ = parts_.size();
    Vec2 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const Polygon& loop : piece.loops)
        for (std::size_t i = 0; i < loop.size(); ++i) {
            sides_.push_back({loop[i], loop[(i + 1) % loop.size()]});
            low = glm::min(low, loop[i]);
            high = glm::max(high, loop[i]);
        }
    size_ = glm::distance(low, high);
    // Bounds along one side of the piece: of a long one they are thin, or it lies across and is bisected.
    const double area = std::accumulate(parts_.begin(), parts_.end(), 0.0,
                                        [](double sum, const Part& part) { return sum + part.area; });
    compact_size_ = compact_ratio * area / size_;
    const bool thin = std::min(high.x - low.x, high.y - low.y) * compact_ratio < size_;
    if (thin || area * hollow_ratio < size_ * size_) sides_.clear();
}

PointIntegral::Part PointIntegral::make_part(const std::array<Vec2, 3>& corners) {
    return {
        corners, diameter(corners), 0.5 * cross(corners[1] - corners[0], corners[2] - corners[0]), 0, {}, {},
        {}};
}

void PointIntegral::add(const Vec3& x, const Vec3& normal, std::span<double> sums) {
    const Receiver receiver{x,
                            normal,
                            plane_.local(x),
                            plane_.height(x),
                            -glm::dot(normal, plane_.normal),
                            {glm::dot(normal, plane_.axis_u), glm::dot(normal, plane_.axis_v)},
                            sums};
    if (!(receiver.height > 0.0)) return;
    if (!sides_.empty() && distance_to_parts(receiver) <= far_ratio * size_) {
        add_polar(receiver, sides_);
        return;
    }
    for (std::size_t root = 0; root < roots_; ++root) add_part(receiver, root);
}

double PointIntegral::distance_to_parts(const Receiver& receiver) const {
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t root = 0; root < roots_; ++root)
        distance = std::min(distance, distance_to_triangle(receiver.foot, parts_[root].corners));
    return std::hypot(receiver.height, distance);
}

void PointIntegral::add_part(const Receiver& receiver, std::size_t index) {
    Part& part = parts_[index];
    const double distance = std::hypot(receiver.height, distance_to_triangle(receiver.foot, part.corners));
    if (distance > far_ratio * part.size) {
        add_gauss(receiver, part);
    } else if (part.size < compact_size_ || part.size < smallest_part * parts_[0].size) {
        const auto& c = part.corners;
        add_polar(receiver, std::array{Line{c[0], c[1]}, Line{c[1], c[2]}, Line{c[2], c[0]}});
    } else {
        if (part.first_child == 0) bisect(index);
        const std::size_t child = parts_[index].first_child;
        add_part(receiver, child);
        add_part(receiver, child + 1);
    }
}

void PointIntegral::bisect(std::size_t index) {
    const std::array<Vec2, 3> c = parts_[index].corners;
    std::size_t longest = 0;
    for (std::size_t s = 1; s < 3; ++s)
        if (glm::distance(c[s], c[(s + 1) % 3]) > glm::distance(c[longest], c[(longest + 1) % 3]))
            longest = s;
    const Vec2 &p = c[longest], &q = c[(longest + 1) % 3], &apex = c[(longest + 2) % 3];
    const Vec2 middle = 0.5 * (p + q);
    parts_[index].first_child = parts_.size();
    parts_.push_back(make_part({p, middle, apex}));
    parts_.push_back(make_part({middle, q, apex}));
}

void PointIntegral::fill_nodes(Part& part) const {
    const auto& rule = geometry::gauss_rule(gauss_nodes + basis_.degree() / 2);
    const std::size_t n = rule.nodes.size(), size = basis_.size();
    part.basis.resize(n * n * size);
    for (std::size_t i = 0; i < n * n; ++i) {
        const double s = rule.nodes[i / n], t = rule.nodes[i % n];
        part.nodes.push_back(part.corners[0] + s * ((1.0 - t) * (part.corners[1] - part.corners[0]) +
                                                    t * (part.corners[2] - part.corners[0])));
        part.weights.push_back(2.0 * part.area * s * rule.weights[i / n] * rule.weights[i % n]);
        basis_.evaluate(plane_.parameter(part.nodes.back()), std::span(part.basis).subspan(i * size, size));
    }
}

void PointIntegral::add_gauss(const Receiver& receiver, Part& part) const {
    if (part.nodes.empty()) fill_nodes(part);
    const std::size_t size = basis_.size();
    const double h = receiver.height;
    for (std::size_t i = 0; i < part.nodes.size(); ++i) {
        const Vec2 along = part.nodes[i] - receiver.foot;
        const double r2 = glm::dot(along, along) + h * h;
        const double kernel =
            h * (h * receiver.facing + glm::dot(receiver.slope, along)) / (std::numbers::pi * r2 * r2);
        for (std::size_t l = 0; l < size; ++l)
            receiver.sums[l] += part.weights[i] * kernel * part.basis[i * size + l];
    }
}

void PointIntegral::add_polar(const Receiver& receiver, std::span<const Line> sides) const {
    const int degree = basis_.degree();
    const std::size_t size = basis_.size();
    const double h = receiver.height;
    double reach = 0.0;
    for (const Line& line : sides) reach = std::max(reach, glm::distance(line.from, receiver.foot));
    Eigen::VectorXd monomials = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(size));
    const auto& rule = geometry::gauss_rule(side_nodes + degree / 2);
    for (const Line& line : sides) {
        const Vec2 from = line.from - receiver.foot, side = line.to - line.from;
        if (side == Vec2(0.0)) continue;
        const Vec2 e = glm::normalize(side);
        const double d = cross(from, e), u0 = glm::dot(from, e), u1 = u0 + glm::length(side);
        if (d == 0.0) continue;
        const double g = std::hypot(d, h), v0 = std::asinh(u0 / g), v1 = std::asinh(u1 / g);
        const Vec2 base = from - u0 * e;
        const int panels = 1 + static_cast<int>((v1 - v0) / panel_length);
        for (int panel = 0; panel < panels; ++panel)
            for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
                const double v = v0 + (v1 - v0) * (panel + rule.nodes[i]) / panels;
                const double growth = std::exp(v); // sinh and cosh share it
                const Vec2 y = base + 0.5 * g * (growth - 1.0 / growth) * e;
                const double radius2 = glm::dot(y, y);
                const Moments j = radial_moments(h / std::sqrt(radius2), degree + 2);
                const double weight = rule.weights[i] * (v1 - v0) / panels * 0.5 * g *
                                      (growth + 1.0 / growth) * d * h /
                                      (std::numbers::pi * radius2 * radius2);
                const double normal_part = h * receiver.facing, slope_part = glm::dot(receiver.slope, y);
                for_monomials(degree, y / reach, [&](std::size_t k, std::size_t m, double value) {
                    monomials[static_cast<Eigen::Index>(k)] +=
                        weight * value * (normal_part * j[m] + slope_part * j[m + 1]);
                });
            }
    }
    const Eigen::VectorXd weights = padua_from_monomials(degree) * monomials;
    const auto points = padua_points(degree);
    std::array<double, geometry::basis_size(geometry::max_degree)> phi;
    for (std::size_t a = 0; a < points.size(); ++a) {
        basis_.evaluate(plane_.parameter(receiver.foot + reach * points[a]), std::span(phi).first(size));
        for (std::size_t l = 0; l < size; ++l)
            receiver.sums[l] += weights[static_cast<Eigen::Index>(a)] * phi[l];
    }
}

} // namespace kinelux::support
