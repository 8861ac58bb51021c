// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "core/vec.h"
#include "visibility/loops.h"

namespace kinelux::kernel {

/// Symmetric elements make equal candidates: the first is taken unless another is better by more than rounding, so that
/// an element's place does not choose.
constexpr double clearly = 1.0 + 1e-6;

/// Where the inner integral over a flat polygon, as a function of the outer point, is not analytic: at the polygon's
/// edges and corners, and weakly in its plane.
struct InnerPolygon {
    const visibility::Loops3& loops; ///< [m]
    Vec3 origin, normal;             ///< of its plane
};

/// The nearest singularity of the inner integral as seen along a line through a cell, from 0 to 1.
struct Singularity {
    double rate =
        1e9; ///< by which Gauss errors fall per degree, >= 1; none = finite, for quotients of logarithms
    double place = 0.5;                                        ///< its real part, in 0..1
    double distance = std::numeric_limits<double>::infinity(); ///< of the singular point from the line [m]
    double layer = std::numeric_limits<double>::infinity();    ///< its imaginary part, >= 0
};

/// Takes the nearest singularity along the straight line from a to b where it is nearer than what is known.
void foretell_along(const InnerPolygon& polygon, const Vec3& a, const Vec3& b, Singularity& nearest);

} // namespace kinelux::kernel
