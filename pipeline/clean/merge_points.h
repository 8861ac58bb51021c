// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::clean {

struct MergedPoints {
    std::vector<Vec3> points;          ///< those that are left, in the order of their first use
    std::vector<std::uint32_t> number; ///< of each old point among them
};

/// Makes one of points nearer to each other than a tolerance: each point joins the earliest one that is that near and
/// stands for itself. The kept points keep their coordinates; there are no chains. Equal points are always merged.
MergedPoints merge_points(std::span<const Vec3> points, double tolerance);

} // namespace kinelux::clean
