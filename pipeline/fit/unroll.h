// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "fit/round_charts.h"
#include "model/patch_set.h"

namespace kinelux::fit {

/// The patches of a round chart: its faces laid into the parameters of its surface, cut open where they close around the
/// axis (at a gap of the chart, if it has one) and spread out at poles and tips; boundaries follow the mesh's. Two-sided
/// charts give each domain twice, back to back.
/// @return  nothing where the faces cover parts of the surface twice or the domain's area is not theirs
std::vector<model::Patch> patches_of_round_chart(const Body& body, const RoundChart& chart);

} // namespace kinelux::fit
