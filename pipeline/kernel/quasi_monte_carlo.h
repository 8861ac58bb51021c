// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "geometry/element_shape.h"
#include "kernel/transport.h"
#include "visibility/occluders.h"

namespace kinelux::kernel {

/// Where the samples of a block lie.
enum class Points : std::uint8_t {
    Sobol, ///< Owen-scrambled Sobol points in four dimensions
    Random ///< independent: plain Monte Carlo, for comparison
};

struct QuasiMonteCarloOptions {
    std::uint32_t samples = 1024;  ///< per scrambling, 1..2^31; powers of two are best for Sobol points
    std::uint32_t scramblings = 8; ///< independent repetitions, from whose spread the error comes, 2..1024
    Points points = Points::Sobol;
    bool occlusion = true;                                ///< false: nothing stands between any pair
    visibility::Among occluders = visibility::Among::All; ///< which bodies may stand between
    std::uint64_t seed = 1;                               ///< mixed with the numbers of both elements
};

/// The block of kernel::transport as the mean over pairs of points, spread evenly over both elements, with a shadow ray
/// each where they face each other. Unbiased, for curved and scattered elements as for planar ones. `error` is the
/// standard error of the block, Frobenius norm. Deterministic. When it pays: docs/quadrature.md.
/// @cite Owen, Scrambled net variance for integrals of smooth functions, Ann. Statist. 25 (1997)
TransportBlock quasi_monte_carlo(const geometry::ElementShape& a, const geometry::ElementShape& b,
                                 const visibility::Occluders& occluders,
                                 const QuasiMonteCarloOptions& options);

} // namespace kinelux::kernel
