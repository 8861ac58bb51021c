// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/element_shape.h"

namespace kinelux::support {

/// The transport block of a pair as a judge computes it, nothing standing between.
struct PairReference {
    std::vector<double> values; ///< size(a) x size(b), row-major, zeros where nothing is exchanged [1]
    double norm = 0.0;          ///< Frobenius norm of `values` [1]
    double disagreement = 0.0;  ///< of the blocks computed from a's and from b's side, Frobenius norm [1]
};

/// G_ab^kl = integral integral phi_k(x) phi_l(y) cos+ cos'+ / (pi r^2) dA dA of flat facets, independent of
/// kernel::transport: both elements are clipped at each other's plane, so that no clamp is left; the outer integral is
/// adaptive over pieces cut along the other element's projected sides; the inner one is polar about the foot of the
/// outer point, closed along the radius, by Gauss in asinh(u / distance) along each side, or a Gauss product far away.
/// Computed twice, once with the roles exchanged: the difference is the error that can be seen from outside.
/// @param tolerance  of one outer cell, relative to the block's norm, 1e-12..1e-2
PairReference pair_reference(const geometry::ElementShape& a, const geometry::ElementShape& b,
                             double tolerance = 1e-9);

/// integral over b of phi_l(y) cos+ cos'+ / (pi r^2) dA at a point that faces `normal`, for all l; all of b in front.
/// @param x  [m] @param normal  unit
std::vector<double> point_reference(const Vec3& x, const Vec3& normal, const geometry::ElementShape& b);

} // namespace kinelux::support
