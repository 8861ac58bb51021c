// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/far_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace kinelux::kernel {

namespace {

using geometry::ElementShape;
using geometry::NodeSet;
using geometry::SurfaceNode;

// Seen from one element, the kernel is singular no nearer than the far side of the other's bounding sphere: a rule that
// is exact to degree e leaves an error that falls by this ratio with each degree above that of the basis.
double ratio(double radius, double distance, double other_radius) {
    return radius / (distance - other_radius);
}

double remainder(const NodeSet& rule, int degree, double ratio) {
    double power = 1.0;
    for (int k = degree; k <= rule.exactness; ++k) power *= ratio;
    return power;
}

} // namespace

double kernel_value(const SurfaceNode& x, const SurfaceNode& y) {
    const Vec3 r = y.position - x.position;
    const double cos_x = glm::dot(x.normal, r), cos_y = -glm::dot(y.normal, r);
    if (!(cos_x > 0.0) || !(cos_y > 0.0)) return 0.0;
    const double r2 = glm::dot(r, r);
    return cos_x * cos_y / (std::numbers::pi * r2 * r2);
}

double bounded_kernel(const SurfaceNode& x, const SurfaceNode& y) {
    return std::min(kernel_value(x, y), 1.0 / std::max(x.weight, y.weight));
}

std::optional<FarRule> far_rule(const ElementShape& a, const ElementShape& b, double tolerance) {
    // Measured as the largest of (error / size without cosines) / ratio^(degrees) over random pairs, rounded up.
    const double amplitude = 2.0 + 2.0 * std::max(a.basis.degree(), b.basis.degree());
    constexpr double nearest_ratio = 0.6;
    const Vec3 axis = b.centre - a.centre;
    const double distance = glm::length(axis);
    const double ratio_a = ratio(a.radius, distance, b.radius), ratio_b = ratio(b.radius, distance, a.radius);
    if (!(distance > a.radius + b.radius) || std::max(ratio_a, ratio_b) > nearest_ratio) return std::nullopt;

    // Without the cosines, and with those at the centres (of nearly grazing pairs: with those at the spheres' ends).
    const double size = std::sqrt(a.area * b.area) / (std::numbers::pi * distance * distance);
    const double cosine_a = std::max(glm::dot(a.mean_normal, axis), 0.05 * b.radius) / distance;
    const double cosine_b = std::max(-glm::dot(b.mean_normal, axis), 0.05 * a.radius) / distance;
    const double wanted = 0.5 * tolerance * cosine_a * cosine_b;
    FarRule rule;
    const auto choose = [&](const ElementShape& element, double r, std::size_t& level) {
        for (level = 0; level < geometry::rule_levels; ++level)
            if (amplitude * remainder(element.rules[level], element.basis.degree(), r) <= wanted) return true;
        return false;
    };
    if (!choose(a, ratio_a, rule.level_a) || !choose(b, ratio_b, rule.level_b)) return std::nullopt;
    rule.error = amplitude * size *
                 (remainder(a.rules[rule.level_a], a.basis.degree(), ratio_a) +
                  remainder(b.rules[rule.level_b], b.basis.degree(), ratio_b));
    return rule;
}

void add_node_product(const NodeSet& xs, std::size_t na, const NodeSet& ys, std::size_t nb,
                      std::span<const double> kernel, std::span<double> values) {
    const std::size_t columns = ys.nodes.size();
    std::array<double, geometry::basis_size(geometry::max_degree)> gathered;
    for (std::size_t i = 0; i < xs.nodes.size(); ++i) {
        std::fill_n(gathered.begin(), nb, 0.0);
        for (std::size_t j = 0; j < columns; ++j) {
            const double weight = kernel[i * columns + j] * ys.nodes[j].weight;
            if (weight > 0.0)
                for (std::size_t l = 0; l < nb; ++l) gathered[l] += weight * ys.basis[j * nb + l];
        }
        for (std::size_t k = 0; k < na; ++k)
            for (std::size_t l = 0; l < nb; ++l)
                values[k * nb + l] += xs.nodes[i].weight * xs.basis[i * na + k] * gathered[l];
    }
}

} // namespace kinelux::kernel
