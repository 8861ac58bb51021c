// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "geometry/element_shape.h"

namespace kinelux::kernel {

/// K = cos+ cos'+ / (pi r^2) between two nodes [1/m2].
double kernel_value(const geometry::SurfaceNode& x, const geometry::SurfaceNode& y);

/// The same with the areas that the nodes stand for, of which neither can receive more than all that leaves the other:
/// at most 1 / (the larger weight), however close the nodes [1/m2].
double bounded_kernel(const geometry::SurfaceNode& x, const geometry::SurfaceNode& y);

/// Which of the elements' ready rules resolve the kernel between them.
struct FarRule {
    std::size_t level_a = 0, level_b = 0; ///< into ElementShape::rules
    double error = 0.0; ///< bound of the block's Frobenius error where no horizon crosses the pair [1]
};

/// The cheapest rules whose error stays below a tolerance, or nothing where the elements are too close for any.
/// @param tolerance  relative to what the block would be if its centres spoke for all of it [1]
std::optional<FarRule> far_rule(const geometry::ElementShape& a, const geometry::ElementShape& b,
                                double tolerance);

/// values(k,l) += sum over node pairs of w_x phi_k(x) kernel(x,y) w_y phi_l(y).
/// @param kernel  nodes of xs x nodes of ys [1/m2]
/// @param na, nb  basis sizes
void add_node_product(const geometry::NodeSet& xs, std::size_t na, const geometry::NodeSet& ys,
                      std::size_t nb, std::span<const double> kernel, std::span<double> values);

} // namespace kinelux::kernel
