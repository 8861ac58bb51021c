// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"

namespace kinelux::kernel {

/// A form factor with what it may be off.
struct PolygonFormFactor {
    double value = 0.0; ///< [1]
    double error = 0.0; ///< quadrature and rounding, not a strict bound [1]
};

/// The share of what leaves a planar polygon uniformly that reaches another, nothing standing between: by the double
/// contour integral of ln r, one contour in closed form, the other by Gauss on panels that shrink towards what is close.
/// Each polygon is first clipped at the other's plane; a polygon in the other's plane, or behind it, gives 0. Polygons
/// may share edges and corners, cross each other, or be apart by any gap: relative error about 1e-12. From three sizes
/// apart the contours would cancel; there a Gauss product takes over. Between sizes of ratio q rounding costs about q.
/// @param from, to  3 or more corners each, planar, counter-clockwise seen from the front, need not be convex [m]
/// @cite Sparrow, J. Heat Transfer 85 (1963), eq. (12); Schroeder and Hanrahan, Siggraph '93
PolygonFormFactor polygon_form_factor(std::span<const Vec3> from, std::span<const Vec3> to);

/// The same of polygons with holes, to any accuracy. @param from, to  loops: the outline first, holes clockwise
/// @param tolerance  relative [1], 1e-12..0.1; from 1e-9 on fewer nodes are taken and the error is foretold
PolygonFormFactor polygon_form_factor(std::span<const std::vector<Vec3>> from,
                                      std::span<const std::vector<Vec3>> to, double tolerance = 1e-12);

} // namespace kinelux::kernel
