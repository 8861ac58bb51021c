// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/pair_nodes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/far_pair.h"

namespace kinelux::motion {

using geometry::ElementShape;
using geometry::SurfaceNode;

bool face_each_other(const SurfaceNode& x, const SurfaceNode& y) {
    const Vec3 r = y.position - x.position;
    return glm::dot(x.normal, r) > 0.0 && glm::dot(y.normal, r) < 0.0;
}

double facing_kernel(const SurfaceNode& x, const SurfaceNode& y) {
    const Vec3 r = y.position - x.position;
    const double r2 = glm::dot(r, r);
    return -glm::dot(x.normal, r) * glm::dot(y.normal, r) / (std::numbers::pi * r2 * r2);
}

PairNodes::PairNodes(const ElementShape& a, const ElementShape& b, double tolerance)
    : na_(a.basis.size()), nb_(b.basis.size()) {
    constexpr std::size_t finest = geometry::rule_levels - 1;
    const auto rule = kernel::far_rule(a, b, tolerance);
    xs_ = &a.rules[rule ? rule->level_a : finest];
    ys_ = &b.rules[rule ? rule->level_b : finest];
    error_.excess = std::max(xs_->exactness - a.basis.degree(), ys_->exactness - b.basis.degree());
    if (rule) {
        error_.kernel = rule->error;
        return;
    }
    const auto kernel = [](const SurfaceNode& x, const SurfaceNode& y, std::span<double> value) {
        value[0] = facing_kernel(x, y);
    };
    const auto fine = project(1, kernel),
               coarse = project(a.rules[finest - 1], b.rules[finest - 1], 1, kernel);
    double square = 0.0;
    for (std::size_t v = 0; v < fine.size(); ++v) square += (fine[v] - coarse[v]) * (fine[v] - coarse[v]);
    error_.kernel = std::sqrt(square);
}

double NodeError::of_move(double t) const {
    // The remainder ratio^(excess + 1) / r^2 with every distance shortened by p, less what it is without a move: as a
    // power series in p this majorises the errors of the terms.
    return kernel * (std::pow(1.0 - t, -(excess + 3)) - 1.0);
}

} // namespace kinelux::motion
