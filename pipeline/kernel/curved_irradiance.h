// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>

#include "core/vec.h"
#include "geometry/element_shape.h"

namespace kinelux::kernel {

/// Whether a point is seen from the receiver.
using SeesPoint = std::function<bool(const Vec3&)>;

/// values_l = integral over an element of phi_l(y) cos+ cos'+ V / (pi r^2) dA on its true surface, for a receiver at any
/// distance from it or on it. Each facet's domain is divided into fans about the point nearest to the receiver; along a
/// ray of a fan the integrand is smooth between the crossings of the receiver's horizon and the surface's own, which are
/// found as roots, and over the rays after a sinh substitution of the scale of the distance. Both integrals are adaptive
/// Gauss-Kronrod rules.
/// @param normal     of the receiver, unit
/// @param tolerance  of the values, relative to their Euclidean norm [1], 1e-9..0.1
/// @param values     b.basis.size() values, set [1/m]
/// @param sees       V; empty: everything is seen. What it hides is sampled only, to 1e-2 at the best
/// @return  estimated Euclidean norm of the error of `values` [1/m]; above what `tolerance` asks for where the limit of
///          evaluations was met first
/// @cite Johnston and Elliott, A sinh transformation for evaluating nearly singular boundary element integrals, Int. J.
/// Numer. Meth. Eng. 62 (2005)
double curved_irradiance(const Vec3& x, const Vec3& normal, const geometry::ElementShape& b, double tolerance,
                         std::span<double> values, const SeesPoint& sees = {});

} // namespace kinelux::kernel
