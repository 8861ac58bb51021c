// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "model/patch_set.h"

namespace kinelux::hard_cases {

/// Two patches in a position that breaks careless code, and what leaves the first for the second.
struct HardPair {
    std::string name;
    model::PatchSet set;   ///< the pair, then what else is there
    double expected = 0.0; ///< F_01, by a closed form [1]
    double bound = 0.0;    ///< of |F - expected| / expected, of |F| where 0 is expected [1]
};

/// Contacts, narrow gaps, crossing and coplanar patches, slivers, specks, horizons, T-junctions.
std::vector<HardPair> hard_pairs();

} // namespace kinelux::hard_cases
