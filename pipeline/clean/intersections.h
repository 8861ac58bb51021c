// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::clean {

/// Number of pairs of faces that touch or cross each other beside the corners and edges they share.
std::uint64_t count_self_intersections(std::span<const Vec3> points,
                                       std::span<const model::Triangle> triangles);

} // namespace kinelux::clean
