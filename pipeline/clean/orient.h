// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::clean {

struct OrientedSoup {
    std::vector<Vec3> points;               ///< the given ones, then doubled ones
    std::vector<std::uint32_t> origin;      ///< of each point: the given point it is or doubles
    std::vector<model::Triangle> triangles; ///< in the given order; a turned face has two corners exchanged
    std::uint64_t non_manifold_edges = 0;   ///< with more than two faces; their points are doubled
};

/// Turns triangles such that neighbours agree, and doubles points where that or more than two faces at an edge leave
/// no surface. Which way a connected part faces is left open.
OrientedSoup orient_soup(const std::vector<Vec3>& points, const std::vector<model::Triangle>& triangles);

} // namespace kinelux::clean
