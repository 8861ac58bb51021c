// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "model/cluster_tree.h"
#include "model/patch_set.h"

namespace kinelux::hard_cases {

/// A closed room that breaks careless code, and what its rows of form factors sum to.
struct HardRoom {
    std::string name;
    model::PatchSet set;
    model::ClusterTree tree;      ///< one element per patch, and one cluster of all small triangles
    int degree = 2;               ///< of the bases
    std::vector<double> row_sums; ///< one per element [1]
    double bound = 0.0;           ///< of their deviation [1]
};

/// High degrees, T-junctions, sizes from 1e-4 to 1, duplicates, contacts, a cluster around a patch.
std::vector<HardRoom> hard_rooms();

} // namespace kinelux::hard_cases
