// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::clean {

struct DividedCaps {
    std::vector<model::Triangle> triangles; ///< none of them lower than the height asked for
    std::vector<std::uint32_t> source;      ///< of each: the given triangle it is, or is a piece of
    std::uint64_t dropped = 0;              ///< triangles that were too low
};

/// Drops triangles without area. One whose corners are three different points closes a gap between a long edge and two
/// short ones: the neighbour at its long edge is divided there instead, so that the surface stays connected.
/// @param least_height  over the longest edge; a triangle not higher has no area [m]
DividedCaps divide_at_caps(std::span<const Vec3> points, const std::vector<model::Triangle>& triangles,
                           double least_height);

} // namespace kinelux::clean
