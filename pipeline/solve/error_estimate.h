// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "model/solution.h"
#include "solve/transport_operator.h"

namespace kinelux::solve {

struct System;
struct SystemSolution;

using model::DominantMode;

/// The share of the mode that a bounce returns, per channel: <z, rho G rho z> / <z, rho z> + margin, at most 0.9999.
std::vector<double> returned_shares(const System& system, const DominantMode& mode);

/// Orthogonal iteration on rho G with two vectors, until the Rayleigh quotient of either changes by less than a twentieth
/// of 1 less itself.
/// @param mode  to begin with; empty: light that is the same everywhere
/// @param products  incremented by the products with G that it took, 6 to 40
DominantMode dominant_mode(const System& system, DominantMode mode, std::size_t& products);

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
    /// The same without the mode's part of the residual.
    double of_rest(std::span<const double> residual, std::span<const double> radiosity) const;

    /// Adds the multiple of the dominant mode that takes its part out of the residual, per channel: the projection
    /// <z, r> = 0, which needs no product, since <z, rho G B> = <G rho z, B>. Radiosity and irradiance both change.
    void take_mode_out(SystemSolution& solution) const;

    /// The largest share of light that a bounce returns, over the channels [1]; and that of the modes but the slowest.
    double slowest() const;
    double second_slowest() const;

private:
    struct Parts {
        double of_mode = 0.0, of_rest = 0.0; ///< squared errors
        double size = 0.0;                   ///< ||B||
    };
    Parts parts(std::span<const double> residual, std::span<const double> radiosity) const;

    const System& system_;
    const DominantMode& mode_;
    std::vector<double> returned_, mode_square_, mode_size_; ///< q, <z, rho z>, ||rho z|| where it counts
    std::vector<double> kept_;                               ///< <z, rho z> - <z, rho G rho z>
    std::vector<bool> counts_;                               ///< per element
    double least_size_ = 0.0;
};

} // namespace kinelux::solve
