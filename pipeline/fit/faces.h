// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "model/scene.h"

namespace kinelux::fit {

struct Face {
    model::Triangle corners; ///< into Body::points
    MaterialId material;
    bool two_sided = false;
    Vec3 normal{0.0};    ///< unit
    double area = 0.0;   ///< [m2]
    double height = 0.0; ///< over the longest edge [m]
};

/// One object as the fit works on it: equal points are one point, so that faces meet wherever they touch along an edge;
/// faces without area are left out.
struct Body {
    ObjectId object;
    std::vector<Vec3> points;
    std::vector<Face> faces;

    /// Faces that run along the edge from corner k to corner k + 1 of a face in the opposite direction.
    std::span<const std::uint32_t> across(std::size_t face, std::size_t k) const;

    std::vector<std::uint32_t> across_first; ///< 3 per face and one more: starts in across_faces
    std::vector<std::uint32_t> across_faces;
};

Body make_body(const model::Object& object, ObjectId id);

} // namespace kinelux::fit
