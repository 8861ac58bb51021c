// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "core/vec.h"

namespace kinelux::fit {

struct Plane {
    Vec3 point{0.0};
    Vec3 normal{0.0, 0.0, 1.0}; ///< unit

    double distance(const Vec3& x) const; ///< signed, positive on the front [m]
};

/// The plane nearest to triangles in the least-squares sense, weighted by area. Its normal's sign is arbitrary.
Plane nearest_plane(std::span<const std::array<Vec3, 3>> triangles);

} // namespace kinelux::fit
