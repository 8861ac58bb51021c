// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "light_case.h"

// What computing a case will take, before it is computed.
namespace kinelux::stages {

/// A prediction with what it may be off, from the scatter of the sample [same unit].
struct Predicted {
    double value = 0.0, error = 0.0;
};

struct Cost {
    std::size_t rows = 0, of_rows = 0; ///< block rows that were computed to predict the rest
    Predicted coefficients_s;          ///< wall time of the stage on all threads [s]
    Predicted solve_s;                 ///< the same, motion included [s]
    Predicted blocks, memory_mib;      ///< static transport blocks stored
    double blocks_per_frame = 0.0;     ///< that change and would be integrated by the exact engine
};

/// Computes a fiftieth of the block rows (32 to 64 of them), and what changes of these in three frames.
/// @param light  up to its plan, without groups: at most GroupingOptions::most_elements elements
Cost predict_cost(LightCase& light, std::uint64_t seed);

} // namespace kinelux::stages
