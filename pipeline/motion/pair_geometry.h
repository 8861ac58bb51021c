// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/element_shape.h"

namespace kinelux::motion {

/// A lower bound of the distance between two elements [m], 0 where none better is known: the gap between their spheres,
/// between their boxes, or of one from the plane of the other, the largest.
double least_distance(const geometry::ElementShape& a, const geometry::ElementShape& b);

/// Whether every point of each element lies in front of every point of the other, so that no clamp of the kernel acts
/// between them; may say no where they do, never the reverse but for 1e-10 of the smaller one's size.
bool wholly_facing(const geometry::ElementShape& a, const geometry::ElementShape& b);

} // namespace kinelux::motion
