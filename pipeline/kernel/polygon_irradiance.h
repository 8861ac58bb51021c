// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "core/vec.h"

namespace kinelux::kernel {

/// Configuration factor of a point receiver to a planar polygon: the share of what leaves a small flat piece at `x`
/// facing `normal` that reaches the polygon's front, unoccluded; times the polygon's exitance it is the irradiance.
/// The part of the polygon below the receiver's horizon is clipped away; a polygon seen from behind gives 0.
/// @param normal   unit
/// @param corners  3 or more, planar, counter-clockwise seen from the polygon's front [m]
/// @return  [1], in [0, 1]; 0 where the point lies in the polygon's plane
/// @cite Lambert, Photometria (1760), contour formula as in Baum et al., Siggraph '89, eq. (7)
double point_to_polygon(const Vec3& x, const Vec3& normal, std::span<const Vec3> corners);

} // namespace kinelux::kernel
