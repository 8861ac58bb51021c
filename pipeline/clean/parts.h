// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::clean {

/// Faces that hang together by edges.
struct Part {
    std::vector<std::uint32_t> faces; ///< ascending
    std::uint64_t boundary_edges = 0; ///< with a face on one side only
    bool closed = false;
    double gap_length = 0.0;  ///< of all boundary edges that lie on no other of the part [m]
    double longest_gap = 0.0; ///< of the longest of them [m]; 0 = there is none
    Vec3 gap_place{0.0};      ///< its middle
};

/// Connected parts of consistently oriented triangles, in order of their first face.
/// @param origin  of each point: points of equal origin are the same place. A part whose boundary edges lie on each
///                other in pairs is closed: it was slit where other parts meet it.
std::vector<Part> find_parts(std::span<const Vec3> points, std::span<const model::Triangle> triangles,
                             std::span<const std::uint32_t> origin);

} // namespace kinelux::clean
