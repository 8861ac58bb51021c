// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solve/solve.h"

namespace kinelux::solve {

/// Improves solution.radiosity until ||M + rho G B - B|| <= options.tolerance * scale; sets sweeps (one per product with
/// G) and irradiance. B = M + S c with S = sqrt(rho) turns the system into (I - S G S) c = S G M, symmetric, and positive
/// definite as long as no row of rho G sums to 1; every channel has its own.
/// @param scale  ||M||
/// @cite Hestenes, Stiefel, J. Res. Nat. Bur. Stand. 49 (1952)
void conjugate_gradients(const System& system, const SolveOptions& options, double scale,
                         SystemSolution& solution);

} // namespace kinelux::solve
