// SPDX-License-Identifier: GPL-3.0-or-later
// s: place on the edge that is integrated by Gauss; u, d: place along the other edge's line and distance from it.
#include "kernel/polygon_form_factor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "geometry/quadrature.h"

namespace kinelux::kernel {

namespace {

using Loop = std::vector<Vec3>;
using Loops = std::vector<Loop>;

constexpr double plane_rounding = 1e-14; ///< of the polygons' coordinates: less height is none
constexpr double far_ratio = 3.0;        ///< distance / size from which the Gauss product is used
constexpr int far_nodes = 10, far_coarse_nodes = 8;
constexpr int panel_nodes = 14, panel_coarse_nodes = 10;
constexpr double finest_tolerance =
    1e-9;                           ///< of fewer nodes than those; their error is not measured but foretold
constexpr double panel_ratio = 2.0; ///< length of a panel / distance to the nearest branch point
constexpr double smallest_panel = 1e-14; ///< of the edge: there s ln s has nothing left to give
constexpr double rounding_steps = 4.0;   ///< machine epsilons by which one term of a sum may be off

// Twice the area of a set of loops along their common normal.
Vec3 area_vector(std::span<const Loop> loops) {
    Vec3 sum(0.0);
    for (const Loop& loop : loops)
        for (std::size_t i = 2; i < loop.size(); ++i)
            sum += glm::cross(loop[i - 1] - loop[0], loop[i] - loop[0]);
    return sum;
}

struct Plane {
    Vec3 origin, normal;
    double rounding;
};

std::optional<Plane> plane_of(std::span<const Loop> loops, double coordinates) {
    const Vec3 area = area_vector(loops);
    const double length = glm::length(area);
    if (!(length > 0.0)) return std::nullopt;
    return Plane{loops[0][0], area / length, plane_rounding * coordinates};
}

double height(const Plane& plane, const Vec3& x) {
    const double value = glm::dot(plane.normal, x - plane.origin);
    return std::abs(value) < plane.rounding ? 0.0 : value;
}

// What of the loops lies in front of a plane. Pieces of a loop that the plane parts stay joined along the plane by edges
// that run there and back, which no contour integral notices.
Loops in_front(std::span<const Loop> loops, const Plane& plane) {
    Loops kept;
    for (const Loop& loop : loops) {
        Loop front;
        bool above = false;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Vec3 &p = loop[i], &q = loop[(i + 1) % loop.size()];
            const double hp = height(plane, p), hq = height(plane, q);
            above = above || hp > 0.0;
            if (hp >= 0.0) front.push_back(p);
            if (hp * hq < 0.0) front.push_back(p + (q - p) * (hp / (hp - hq)));
        }
        if (above && front.size() >= 3) kept.push_back(std::move(front));
    }
    return kept;
}

struct Ball {
    Vec3 centre{0.0};
    double radius = 0.0;
};

Ball ball_about(std::span<const Loop> loops) {
    Vec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const Loop& loop : loops)
        for (const Vec3& p : loop) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    return {0.5 * (low + high), 0.5 * glm::distance(low, high)};
}

// Gauss nodes of the rule that counts and of the one that tells its error; 0: none does.
struct Rule {
    int fine, coarse;
};

Rule panel_rule(double tolerance) {
    // On a panel twice as long as the distance of the nearest branch point errors fall by (1 + sqrt 2)^2 per node; the
    // contours cancel by up to the square of far_ratio and what it is counted in.
    constexpr double amplitude = 30.0, fall = 5.83;
    if (tolerance < finest_tolerance) return {panel_nodes, panel_coarse_nodes};
    return {std::clamp(static_cast<int>(std::ceil(std::log(amplitude / tolerance) / std::log(fall))), 3,
                       panel_nodes),
            0};
}

Rule far_rule_nodes(double tolerance) {
    // From the bounds' distance on, errors fall by more than a hundred per node.
    if (tolerance < finest_tolerance) return {far_nodes, far_coarse_nodes};
    return {tolerance < 1e-5 ? 5 : 4, 0};
}

// A sum with the sum of its terms' sizes, which bounds its rounding.
struct Sum {
    double value = 0.0, size = 0.0;
    void add(double term) {
        value += term;
        size += std::abs(term);
    }
    double rounding() const { return rounding_steps * std::numeric_limits<double>::epsilon() * size; }
};

// Integral of ln(r / scale) along a line at distance d, from 0 to u; at d = 0 its limit.
double log_integral(double u, double d, double scale) {
    const double r = std::hypot(u, d);
    if (r == 0.0) return 0.0;
    return u * (std::log(r / scale) - 1.0) + d * std::atan2(u, d);
}

struct Edge {
    Vec3 from, direction;
    double length;
};

std::vector<Edge> edges_of(std::span<const Loop> loops) {
    std::vector<Edge> edges;
    for (const Loop& loop : loops)
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Vec3 along = loop[(i + 1) % loop.size()] - loop[i];
            const double length = glm::length(along);
            if (length > 0.0) edges.push_back({loop[i], along / length, length});
        }
    return edges;
}

// A place near an edge's line: how far along and how far off. The integrand branches at along +- i off.
struct BranchPoint {
    double along, off;
};

BranchPoint branch_at(const Edge& edge, const Vec3& point) {
    const double along = glm::dot(point - edge.from, edge.direction);
    return {along, glm::distance(point, edge.from + along * edge.direction)};
}

// Where the line of one edge passes closest to the line of another: the distance to it branches there.
BranchPoint branch_at_crossing(const Edge& edge, const Edge& other) {
    const double cosine = glm::dot(edge.direction, other.direction);
    const Vec3 normal = glm::cross(edge.direction, other.direction);
    const double sine2 = glm::dot(normal, normal);
    if (!(sine2 > 0.0)) return {std::numeric_limits<double>::infinity(), 0.0};
    const Vec3 gap = other.from - edge.from;
    const double along = (glm::dot(gap, edge.direction) - cosine * glm::dot(gap, other.direction)) / sine2;
    return {along, std::abs(glm::dot(gap, normal)) / sine2};
}

// integral integral ln(r / scale) over two edges, with two Gauss rules on the same panels.
class EdgePair {
public:
    EdgePair(const Edge& outer, const Edge& inner, double scale, const Rule& rule)
        : outer_(outer),
          inner_(inner),
          scale_(scale),
          rule_(rule),
          branches_{branch_at(outer, inner.from),
                    branch_at(outer, inner.from + inner.length * inner.direction),
                    branch_at_crossing(outer, inner)} {}

    void add_to(Sum& fine, Sum& coarse) const { add_panel(0.0, outer_.length, fine, coarse); }

private:
    double distance_to_branches(double low, double high) const {
        double distance = std::numeric_limits<double>::infinity();
        for (const BranchPoint& branch : branches_)
            distance = std::min(
                distance, std::hypot(std::max({low - branch.along, branch.along - high, 0.0}), branch.off));
        return distance;
    }

    void add_panel(double low, double high, Sum& fine, Sum& coarse) const {
        const double length = high - low;
        if (length > panel_ratio * distance_to_branches(low, high) &&
            length > smallest_panel * outer_.length) {
            const double middle = 0.5 * (low + high);
            add_panel(low, middle, fine, coarse);
            add_panel(middle, high, fine, coarse);
            return;
        }
        add_rule(rule_.fine, low, length, fine);
        if (rule_.coarse > 0) add_rule(rule_.coarse, low, length, coarse);
    }

    void add_rule(int nodes, double low, double length, Sum& sum) const {
        const geometry::GaussRule& rule = geometry::gauss_rule(nodes);
        const double cosine = glm::dot(outer_.direction, inner_.direction);
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const Vec3 x = outer_.from + (low + length * rule.nodes[i]) * outer_.direction;
            const double u = glm::dot(inner_.from - x, inner_.direction);
            const double d = glm::length(inner_.from - x - u * inner_.direction);
            sum.add(cosine * length * rule.weights[i] *
                    (log_integral(u + inner_.length, d, scale_) - log_integral(u, d, scale_)));
        }
    }

    const Edge& outer_;
    const Edge& inner_;
    double scale_;
    Rule rule_;
    std::array<BranchPoint, 3> branches_;
};

PolygonFormFactor by_contours(std::span<const Loop> a, std::span<const Loop> b, double scale,
                              double tolerance) {
    const Rule rule = panel_rule(tolerance);
    Sum fine, coarse;
    const std::vector<Edge> edges_a = edges_of(a), edges_b = edges_of(b);
    for (const Edge& outer : edges_a)
        for (const Edge& inner : edges_b)
            if (glm::dot(outer.direction, inner.direction) != 0.0)
                EdgePair(outer, inner, scale, rule).add_to(fine, coarse);
    constexpr double turn = 2.0 * std::numbers::pi;
    const double change = rule.coarse > 0 ? std::abs(fine.value - coarse.value) : tolerance * fine.value;
    return {fine.value / turn, (change + fine.rounding()) / turn};
}

struct AreaNode {
    Vec3 position;
    double weight;
};

// Nodes on the fans of the loops' first corners; triangles that turn the other way count negative, which is right for
// any smooth integrand.
std::vector<AreaNode> fan_nodes(std::span<const Loop> loops, const Vec3& normal, int n) {
    const geometry::GaussRule& rule = geometry::gauss_rule(n);
    std::vector<AreaNode> nodes;
    for (const Loop& loop : loops)
        for (std::size_t c = 2; c < loop.size(); ++c) {
            const Vec3 e1 = loop[c - 1] - loop[0], e2 = loop[c] - loop[0];
            const double twice_area = glm::dot(glm::cross(e1, e2), normal);
            for (std::size_t i = 0; i < rule.nodes.size(); ++i)
                for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
                    const double s = rule.nodes[i], t = rule.nodes[j];
                    nodes.push_back({loop[0] + s * ((1.0 - t) * e1 + t * e2),
                                     twice_area * s * rule.weights[i] * rule.weights[j]});
                }
        }
    return nodes;
}

Sum product(std::span<const Loop> a, const Vec3& normal_a, std::span<const Loop> b, const Vec3& normal_b,
            int n) {
    Sum sum;
    const std::vector<AreaNode> nodes_b = fan_nodes(b, normal_b, n);
    for (const AreaNode& x : fan_nodes(a, normal_a, n))
        for (const AreaNode& y : nodes_b) {
            const Vec3 r = y.position - x.position;
            const double r2 = glm::dot(r, r);
            sum.add(-x.weight * y.weight * glm::dot(normal_a, r) * glm::dot(normal_b, r) /
                    (std::numbers::pi * r2 * r2));
        }
    return sum;
}

} // namespace

PolygonFormFactor polygon_form_factor(std::span<const std::vector<Vec3>> from,
                                      std::span<const std::vector<Vec3>> to, double tolerance) {
    const Ball whole_a = ball_about(from), whole_b = ball_about(to);
    const double coordinates =
        std::max({glm::length(whole_a.centre), glm::length(whole_b.centre), whole_a.radius, whole_b.radius});
    const auto plane_a = plane_of(from, coordinates), plane_b = plane_of(to, coordinates);
    if (!plane_a || !plane_b) return {};
    const Loops a = in_front(from, *plane_b), b = in_front(to, *plane_a);
    if (a.empty() || b.empty()) return {};

    const Ball ball_a = ball_about(a), ball_b = ball_about(b);
    const double distance = glm::distance(ball_a.centre, ball_b.centre) - ball_a.radius - ball_b.radius;
    PolygonFormFactor result;
    if (distance > far_ratio * 2.0 * std::max(ball_a.radius, ball_b.radius)) {
        const Rule rule = far_rule_nodes(tolerance);
        const Sum fine = product(a, plane_a->normal, b, plane_b->normal, rule.fine);
        const double change =
            rule.coarse > 0
                ? std::abs(fine.value - product(a, plane_a->normal, b, plane_b->normal, rule.coarse).value)
                : tolerance * fine.value;
        result = {fine.value, change + fine.rounding()};
    } else {
        result = by_contours(
            a, b, glm::distance(ball_a.centre, ball_b.centre) + ball_a.radius + ball_b.radius, tolerance);
    }
    const double area = 0.5 * glm::length(area_vector(from));
    return {std::max(0.0, result.value / area), result.error / area};
}

PolygonFormFactor polygon_form_factor(std::span<const Vec3> from, std::span<const Vec3> to) {
    const Loops loops_from{Loop(from.begin(), from.end())}, loops_to{Loop(to.begin(), to.end())};
    return polygon_form_factor(std::span<const Loop>(loops_from), std::span<const Loop>(loops_to));
}

} // namespace kinelux::kernel
