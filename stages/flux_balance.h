// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "cli/stage.h"
#include "model/coefficients.h"
#include "model/scene.h"
#include "model/solution.h"

// What the light of a frame has to obey in any scene.
namespace kinelux::stages {

/// Where the light of a frame goes, all channels together.
struct FluxBalance {
    double emitted = 0.0;  ///< [W or lm]
    double absorbed = 0.0; ///< by surfaces [W or lm]
    double lost =
        0.0; ///< leaves the scene or meets the back of a one-sided face [W or lm]; below 0: made of nothing
    double unsolved = 0.0; ///< emitted - absorbed - lost: what the solver left [W or lm]
    double negative =
        0.0; ///< leaves elements whose mean radiosity is below 0, which cannot be [W or lm], >= 0
};

/// @param materials  of the elements
/// @param areas      of the elements [m2]
FluxBalance flux_balance(const model::Scene& scene, std::span<const MaterialId> materials,
                         std::span<const double> areas, const model::UnknownLayout& layout,
                         const model::FrameSolution& frame);

/// Puts the balances of all frames into the record, "frames/N/emitted_flux" and so on, and warns of frames in which the
/// solver left, or nothing made, or negative radiosity amounts to more than the accuracy asked for.
void report_balances(const model::Scene& scene, std::span<const MaterialId> materials,
                     std::span<const double> areas, const model::Solution& solution, cli::Stage& stage);

} // namespace kinelux::stages
