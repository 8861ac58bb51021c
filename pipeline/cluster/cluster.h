// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "model/cluster_tree.h"
#include "model/patch_set.h"
#include "model/scene.h"

namespace kinelux::cluster {

struct ClusterOptions {
    double element_size = 0.0;       ///< largest edge of a piece of a patch [m], > 0
    double cluster_size = 0.0;       ///< largest edge of a cluster's bounds [m], > 0
    double normal_spread_deg = 40.0; ///< largest angle to a cluster's mean normal [deg], 1..90
    std::vector<MaterialId>
        emitters; ///< materials whose patches stay whole up to two elements' size: their exitance is
                  ///< constant and known, and lamps are summed over more often than walls
};

/// Sizes for an accuracy: elements as small as the target needs, relative to the scene's extent (a tenth of it at 3 %,
/// less as the square root of the target), or the scene's own accuracy.element_size. The extent is the longest edge of
/// the bounds of what is at rest.
ClusterOptions cluster_options_for(const model::Scene& scene, const model::PatchSet& patches);

/// Cuts patches into elements by a grid along their principal axes, and gathers the small triangles of each object and
/// material into clusters by position and normal. Deterministic; every small triangle is in exactly one cluster.
/// @throws GeometryError  a size that is not positive
model::ClusterTree build_clusters(const model::PatchSet& patches, const ClusterOptions& options);

} // namespace kinelux::cluster
