// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solve/solve.h"

// Methods that need the rows of G. Each improves solution.radiosity until `estimate` is within options.tolerance or the
// sweeps run out; solution.irradiance is G B before and after; solution.sweeps grows by the work.
namespace kinelux::solve {

/// Gauss-Seidel sweeps in the order of the elements, each followed by a correction in the slowest mode (deflation).
/// @cite Nicolaides, SIAM J. Numer. Anal. 24 (1987)
void gauss_seidel(const System& system, const RowOperator& rows, const SolveOptions& options,
                  const ErrorEstimate& estimate, SystemSolution& solution);

/// Progressive refinement: the element with the most unshot flux shoots it all, again and again.
/// @cite Cohen, Chen, Wallace, Greenberg, SIGGRAPH 1988; for polynomial bases Zatz, SIGGRAPH 1993
void shoot(const System& system, const RowOperator& rows, const SolveOptions& options,
           const ErrorEstimate& estimate, SystemSolution& solution);

/// r = M + rho E - B, with the irradiance E = G B.
std::vector<double> residual_of(const System& system, std::span<const double> radiosity,
                                std::span<const double> irradiance);

} // namespace kinelux::solve
