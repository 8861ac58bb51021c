// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace kinelux::geometry {

/// A Gauss rule on [-1, 1] with the Kronrod rule that uses its nodes again: two values of an integral from one set of
/// values of the integrand.
struct KronrodRule {
    std::span<const double> nodes;         ///< ascending
    std::span<const double> weights;       ///< of the Kronrod rule
    std::span<const double> gauss_weights; ///< of the Gauss rule; 0 at nodes it has not
};

/// 7 nodes, exact to degree 11; the Gauss rule of 3 nodes in it to degree 5.
/// @cite Kronrod, Nodes and Weights of Quadrature Formulas (1965)
const KronrodRule& kronrod_7();
/// 15 nodes, exact to degree 23; the Gauss rule of 7 nodes in it to degree 13.
/// @cite Piessens et al., QUADPACK (1983)
const KronrodRule& kronrod_15();

/// Estimated error of a Kronrod rule, from the difference to its Gauss rule and the integral of the integrand's size.
/// @cite Piessens et al., QUADPACK (1983), section 2.2.4.1
double kronrod_error(double difference, double size);

} // namespace kinelux::geometry
