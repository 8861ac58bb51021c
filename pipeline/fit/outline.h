// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "fit/contacts.h"
#include "fit/domain.h"
#include "fit/regions.h"
#include "model/patch_set.h"

namespace kinelux::fit {

/// What became of one chart.
struct ChartPatches {
    std::vector<model::Patch> patches;
    bool divided = false;      ///< along lines of contact
    bool kept_whole = false;   ///< its outline overlaps itself: taken as it is, without lines of contact
    std::uint64_t covered = 0; ///< patches left out because another surface lies in their place
    double covered_area = 0.0; ///< of those [m2]
};

/// Turns a chart into patches: one for each region that other bodies' lines of contact separate, both sides of
/// two-sided charts, without what other charts in the same plane cover.
/// @param contact_tolerance  corners this near to the plane lie in it, points this near to each other are one [m]
ChartPatches patches_of_chart(const std::vector<PlacedChart>& charts, std::size_t chart,
                              const FlatChart& flat, const Contacts& contacts, double contact_tolerance);

} // namespace kinelux::fit
