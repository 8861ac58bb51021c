// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/vec.h"

namespace kinelux::geometry {

/// A node of a rule on the reference triangle: barycentric coordinates and a share of the area (they sum to 1).
struct TriangleNode {
    std::array<double, 3> barycentric;
    double weight;
};

/// A symmetric rule with positive weights and inner nodes, exact for polynomials of the given total degree.
/// @param degree  0..8; more is served by the collapsed Gauss product of that degree
/// @cite Dunavant, Int. J. Numer. Meth. Eng. 21 (1985)
std::span<const TriangleNode> triangle_rule(int degree);

/// Nodes and weights of the n-point Gauss-Legendre rule on [0,1]. @param n  1..32
struct GaussRule {
    std::vector<double> nodes, weights;
};
const GaussRule& gauss_rule(int n);

} // namespace kinelux::geometry
