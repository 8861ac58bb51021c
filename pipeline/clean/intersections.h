// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::clean {

struct SelfIntersections {
    std::uint64_t pairs = 0;          ///< of faces that touch or cross each other
    std::vector<std::uint32_t> faces; ///< those in any pair, each once, in rising order
};

/// Faces that touch or cross each other beside the corners and edges they share. Exact predicates; the time grows like
/// n log n with the number of faces, plus the number of pairs whose boxes meet.
SelfIntersections find_self_intersections(std::span<const Vec3> points,
                                          std::span<const model::Triangle> triangles);

} // namespace kinelux::clean
