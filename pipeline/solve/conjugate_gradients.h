// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solve/solve.h"

namespace kinelux::solve {

/// Improves solution.radiosity until `estimate` is within options.tolerance or the sweeps run out; solution.irradiance is
/// G B before and after; sweeps grow by one per product with G. B = M + S c with S = sqrt(rho) turns the system into
/// (I - S G S) c = S G M, symmetric, and positive definite as long as no bounce returns all light. Every channel takes
/// its own steps, in one product for all.
/// @cite Hestenes, Stiefel, J. Res. Nat. Bur. Stand. 49 (1952)
void conjugate_gradients(const System& system, const SolveOptions& options, const ErrorEstimate& estimate,
                         SystemSolution& solution);

} // namespace kinelux::solve
