// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/clear_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "kernel/far_pair.h"
#include "kernel/polygon_form_factor.h"

namespace kinelux::kernel {

namespace {

using geometry::ElementShape;
using geometry::NodeSet;

constexpr std::size_t most_nodes = 64; ///< of a rule that is kept in registers and on the stack

// Nodes of one end, each weighted by its height over the other end's plane.
struct Nodes {
    std::array<double, most_nodes> x, y, z, weight;

    void set(const NodeSet& rule, const Vec3& normal, double offset) {
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const Vec3& p = rule.nodes[i].position;
            x[i] = p.x;
            y[i] = p.y;
            z[i] = p.z;
            weight[i] = rule.nodes[i].weight * (glm::dot(normal, p) - offset);
        }
    }
};

// Of constant functions the block is one number. Sums over y wait side by side, so that they share instructions.
double constant_product(const Nodes& xs, std::size_t nx, const Nodes& ys, std::size_t ny) {
    std::array<double, most_nodes> sums;
    std::fill_n(sums.begin(), ny, 0.0);
    for (std::size_t i = 0; i < nx; ++i)
        for (std::size_t j = 0; j < ny; ++j) {
            const double dx = ys.x[j] - xs.x[i], dy = ys.y[j] - xs.y[i], dz = ys.z[j] - xs.z[i];
            const double r2 = dx * dx + dy * dy + dz * dz;
            sums[j] += xs.weight[i] / (r2 * r2);
        }
    double sum = 0.0;
    for (std::size_t j = 0; j < ny; ++j) sum += ys.weight[j] * sums[j];
    return sum / std::numbers::pi;
}

void basis_product(const Nodes& xs, const NodeSet& rule_x, std::size_t na, const Nodes& ys,
                   const NodeSet& rule_y, std::size_t nb, std::span<double> values) {
    std::array<double, geometry::basis_size(geometry::max_degree)> gathered;
    for (std::size_t i = 0; i < rule_x.nodes.size(); ++i) {
        std::fill_n(gathered.begin(), nb, 0.0);
        for (std::size_t j = 0; j < rule_y.nodes.size(); ++j) {
            const double dx = ys.x[j] - xs.x[i], dy = ys.y[j] - xs.y[i], dz = ys.z[j] - xs.z[i];
            const double r2 = dx * dx + dy * dy + dz * dz;
            const double kernel = ys.weight[j] / (std::numbers::pi * r2 * r2);
            for (std::size_t l = 0; l < nb; ++l) gathered[l] += kernel * rule_y.basis[j * nb + l];
        }
        for (std::size_t k = 0; k < na; ++k) {
            const double weight = xs.weight[i] * rule_x.basis[i * na + k];
            for (std::size_t l = 0; l < nb; ++l) values[k * nb + l] += weight * gathered[l];
        }
    }
}

// Whether no corner of an element lies behind a plane, and one clearly before it.
bool stands_before(const ElementShape& element, const Vec3& normal, double offset) {
    constexpr double behind = 1e-10, clearly = 1e-3; // of the element's radius
    const double height = glm::dot(normal, element.centre) - offset;
    if (height >= element.radius) return true;
    if (height <= -element.radius) return false;
    double lowest = 0.0, highest = 0.0;
    for (const geometry::Facet& facet : element.facets)
        for (const Vec3& corner : facet.corners) {
            lowest = std::min(lowest, glm::dot(normal, corner) - offset);
            highest = std::max(highest, glm::dot(normal, corner) - offset);
        }
    return lowest >= -behind * element.radius && highest > clearly * element.radius;
}

} // namespace

std::optional<double> clear_far_block(const ElementShape& a, const ElementShape& b, double tolerance,
                                      std::span<double> values) {
    if (!a.planar || !b.planar) return std::nullopt;
    const Vec3 &normal_a = a.facets[0].normal, &normal_b = b.facets[0].normal;
    const double offset_a = glm::dot(normal_a, a.facets[0].corners[0]),
                 offset_b = glm::dot(normal_b, b.facets[0].corners[0]);
    if (!stands_before(b, normal_a, offset_a) || !stands_before(a, normal_b, offset_b)) return std::nullopt;
    const auto rule = far_rule(a, b, tolerance);
    if (!rule) return std::nullopt;
    const NodeSet &rule_x = a.rules[rule->level_a], &rule_y = b.rules[rule->level_b];
    const std::size_t nx = rule_x.nodes.size(), ny = rule_y.nodes.size();
    if (nx > most_nodes || ny > most_nodes) return std::nullopt;
    Nodes xs, ys;
    xs.set(rule_x, normal_b, offset_b);
    ys.set(rule_y, normal_a, offset_a);
    if (values.size() == 1) {
        values[0] = rule_x.basis[0] * rule_y.basis[0] * constant_product(xs, nx, ys, ny);
    } else {
        std::fill(values.begin(), values.end(), 0.0);
        basis_product(xs, rule_x, a.basis.size(), ys, rule_y, b.basis.size(), values);
    }
    return rule->error;
}

std::optional<double> clear_near_block(const ElementShape& a, const ElementShape& b, double tolerance,
                                       double& value) {
    constexpr double share = 0.3;      // of the tolerance; the other errors of a row are not foretold
    constexpr double most_ratio = 1e3; // of sizes: rounding grows with it
    if (!a.planar || !b.planar || a.basis.size() != 1 || b.basis.size() != 1) return std::nullopt;
    if (std::max(a.radius, b.radius) > most_ratio * std::min(a.radius, b.radius)) return std::nullopt;
    const PolygonFormFactor factor = polygon_form_factor(a.outline, b.outline, share * tolerance);
    const double scale = std::sqrt(a.area / b.area);
    value = scale * factor.value;
    return scale * factor.error;
}

} // namespace kinelux::kernel
