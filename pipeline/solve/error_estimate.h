// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "model/solution.h"
#include "solve/transport_operator.h"

namespace kinelux::solve {

struct System;

using model::DominantMode;

/// The share of the mode that a bounce returns, per channel: <z, rho G rho z> / <z, rho z> + margin, at most 0.9999.
std::vector<double> returned_shares(const System& system, const DominantMode& mode);

/// Power iteration on rho G until the eigenvalue q is known to a twentieth of 1 - q.
/// @param from  a shape to begin with; empty: light that is the same everywhere
/// @param products  incremented by the products with G that it took
DominantMode dominant_mode(const System& system, std::vector<double> from, std::size_t& products);

/// Estimates the error of a radiosity by its residual: (I - rho G)^-1 r = a u / (1 - q) + rest, where u is the dominant
/// mode, q its eigenvalue and a its part of r; the rest grows by at most 1 / (1 - second eigenvalue).
class ErrorEstimate {
public:
    /// Both must outlive it.
    ErrorEstimate(const System& system, const DominantMode& mode);

    /// The relative L2 error of B over the elements that do not emit (over all, where all emit), all channels together.
    /// Less than a millionth of ||M|| counts as that.
    /// @param residual  M + rho G B - B
    double of(std::span<const double> residual, std::span<const double> radiosity) const;
    /// The largest share of light that a bounce returns, over the channels [1].
    double slowest() const;

private:
    const System& system_;
    const DominantMode& mode_;
    std::vector<double> returned_, mode_square_, mode_size_; ///< q, <z, rho z>, ||rho z|| where it counts
    std::vector<bool> counts_;                               ///< per element
    double least_size_ = 0.0;
};

} // namespace kinelux::solve
