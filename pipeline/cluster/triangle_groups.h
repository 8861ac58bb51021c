// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cluster/cluster.h"
#include "model/cluster_tree.h"
#include "model/patch_set.h"

namespace kinelux::cluster {

/// Gathers small triangles of one object and material until their bounds or the spread of their normals would pass the
/// options. Sorted by object, then material; every triangle is in exactly one cluster.
std::vector<model::Cluster> group_triangles(const model::SmallTriangles& small,
                                            const ClusterOptions& options);

} // namespace kinelux::cluster
