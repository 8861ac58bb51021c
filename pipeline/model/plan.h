// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/ids.h"

namespace kinelux::model {

/// One thing that could be simulated, and what was decided about it.
struct Effect {
    std::string name; ///< "interreflection", "colour", "static occlusion", "moving occlusion", "motion", ...
    bool simulated = true;
    std::string reason; ///< one sentence with the figures it rests on
    double risked_error =
        0.0; ///< relative error of radiosity risked by leaving it out [1]; 0 when simulated or exact
    bool overridden = false; ///< the scene said so
};

/// Which effects the scene calls for, and what computing them will take.
struct Plan {
    std::vector<Effect> effects;
    int degree = 2;              ///< of the bases on patches, 0..3
    int cluster_degree = 0;      ///< of the bases on clusters
    std::uint32_t bounces = 0;   ///< interreflections above the accuracy; 0 = direct light only
    bool single_channel = false; ///< all channels are proportional: computed once
    bool static_occlusion = true;
    bool moving_occlusion = true;
    std::vector<ObjectId> moving_objects; ///< bodies whose pose really changes over the frames
    std::uint64_t unknowns = 0;           ///< basis functions in all
    std::uint64_t predicted_blocks = 0;   ///< upper bound of transport blocks stored
    double predicted_memory_mib = 0.0;
};

} // namespace kinelux::model
