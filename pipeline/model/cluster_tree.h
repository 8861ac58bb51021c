// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "model/patch_set.h"

namespace kinelux::model {

/// Small triangles of one object and material that lie and look alike: they exchange light as one surface.
struct Cluster {
    ObjectId object;
    MaterialId material;
    std::vector<std::uint32_t> triangles; ///< into PatchSet::small.triangles
    double normal_spread_deg = 0.0;       ///< largest angle between a triangle's normal and the mean normal
};

/// What carries one polynomial basis: a piece of a patch, or a whole cluster.
struct Element {
    std::optional<PatchId> patch;     ///< set for a piece of a patch,
    std::optional<ClusterId> cluster; ///< else this is set
    ObjectId object;
    MaterialId material;
    std::uint32_t first_triangle = 0,
                  triangle_count = 0; ///< into ClusterTree::domain_triangles; patch pieces only
};

using DomainTriangle = std::array<Vec2, 3>; ///< corners (u,v) on the patch's surface, counter-clockwise

/// How the patches are cut and the small triangles gathered. Every domain point of a patch is in exactly one of its
/// elements, every small triangle in exactly one cluster.
struct ClusterTree {
    std::vector<Cluster> clusters;
    std::vector<Element> elements; ///< sorted by object, then patch, then cluster
    std::vector<DomainTriangle> domain_triangles;
    double element_size = 0.0; ///< largest edge of a patch's piece that was aimed at [m]
};

/// @throws GeometryError  a small triangle in no cluster or in two, ids or ranges out of bounds
void check(const ClusterTree& tree, const PatchSet& patches);

} // namespace kinelux::model
