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

constexpr std::size_t most_nodes = 64;  ///< of a rule that is kept on the stack
constexpr std::size_t side_by_side = 2; ///< numbers that share an instruction

// Nodes of one end, each weighted by its height over the other end's plane.
struct Nodes {
    const double *x, *y, *z;
    std::size_t count, stride;
    std::array<double, most_nodes> weight;

    Nodes(const FlatEnd& end, std::size_t level, const Vec3& normal, double offset)
        : x(&end.nodes[end.rules[level].start]),
          y(x + end.rules[level].stride),
          z(y + end.rules[level].stride),
          count(end.rules[level].count),
          stride(end.rules[level].stride) {
        const double* area = z + stride;
        for (std::size_t i = 0; i < stride; ++i)
            weight[i] = area[i] * (normal.x * x[i] + normal.y * y[i] + normal.z * z[i] - offset);
    }
};

// Of constant functions the block is one number. Sums over y wait side by side, so that they share instructions, and two
// nodes of x share a division; the second of an odd number is a copy without weight.
double constant_product(const Nodes& xs, const Nodes& ys) {
    std::array<double, most_nodes> sums;
    std::fill_n(sums.begin(), ys.stride, 0.0);
    for (std::size_t i = 0; i < xs.count; i += 2)
        for (std::size_t j = 0; j < ys.stride; ++j) {
            const double dx = ys.x[j] - xs.x[i], dy = ys.y[j] - xs.y[i], dz = ys.z[j] - xs.z[i];
            const double ex = ys.x[j] - xs.x[i + 1], ey = ys.y[j] - xs.y[i + 1], ez = ys.z[j] - xs.z[i + 1];
            const double d2 = dx * dx + dy * dy + dz * dz, e2 = ex * ex + ey * ey + ez * ez;
            const double d4 = d2 * d2, e4 = e2 * e2;
            sums[j] += (xs.weight[i] * e4 + xs.weight[i + 1] * d4) / (d4 * e4);
        }
    double sum = 0.0;
    for (std::size_t j = 0; j < ys.count; ++j) sum += ys.weight[j] * sums[j];
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

FlatEnd::FlatEnd(const ElementShape& element) : shape(&element), planar(element.planar) {
    if (!planar) return;
    normal = element.facets[0].normal;
    offset = glm::dot(normal, element.facets[0].corners[0]);
    for (std::size_t level = 0; level < rules.size(); ++level) {
        const auto& list = element.rules[level].nodes;
        Rule& rule = rules[level];
        rule = {nodes.size(), list.size(), (list.size() + side_by_side - 1) / side_by_side * side_by_side};
        nodes.resize(nodes.size() + 4 * rule.stride, 0.0);
        for (std::size_t i = 0; i < rule.stride; ++i) {
            const geometry::SurfaceNode& node = list[std::min(i, list.size() - 1)];
            for (int axis = 0; axis < 3; ++axis)
                nodes[rule.start + static_cast<std::size_t>(axis) * rule.stride + i] = node.position[axis];
            if (i < list.size()) nodes[rule.start + 3 * rule.stride + i] = node.weight;
        }
    }
}

std::optional<double> clear_far_block(const FlatEnd& a, const FlatEnd& b, double tolerance,
                                      std::span<double> values) {
    if (!a.planar || !b.planar || !stands_before(*b.shape, a.normal, a.offset) ||
        !stands_before(*a.shape, b.normal, b.offset))
        return std::nullopt;
    const auto rule = far_rule(*a.shape, *b.shape, tolerance);
    if (!rule || a.rules[rule->level_a].stride > most_nodes || b.rules[rule->level_b].stride > most_nodes)
        return std::nullopt;
    const Nodes xs(a, rule->level_a, b.normal, b.offset), ys(b, rule->level_b, a.normal, a.offset);
    if (values.size() == 1) {
        values[0] = constant_product(xs, ys) / std::sqrt(a.shape->area * b.shape->area);
    } else {
        std::fill(values.begin(), values.end(), 0.0);
        basis_product(xs, a.shape->rules[rule->level_a], a.shape->basis.size(), ys,
                      b.shape->rules[rule->level_b], b.shape->basis.size(), values);
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
