// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/element_shape.h"
#include "visibility/occluders.h"

namespace kinelux::kernel {

/// How blocks are integrated.
enum class Integration : std::uint8_t {
    Automatic, ///< by the rule that suits the pair (docs/theory.md, Blocks)
    Sobol,     ///< kernel::quasi_monte_carlo at scrambled Sobol points
    Random     ///< the same at independent points: Monte Carlo, as the publication has it
};

struct TransportOptions {
    double tolerance =
        1e-3; ///< of a block with nothing in between [1], 1e-9..0.1, relative to its size, or to 1e-3
              ///< of the largest block that elements of such areas can have
    double sight_tolerance =
        1e-2; ///< of a block with something in between [1], tolerance..0.1, relative to its size
    double sight_floor =
        1e-3; ///< or to this part of the largest block that elements of such areas can have [1], 0..1
    double curved_floor = 1e-3;    ///< or to this part, where an element is curved or a cluster [1], 0..1
    double own_floor = 1e-3;       ///< and of an element with itself [1], 0..1
    bool occlusion = true;         ///< false: nothing stands between any pair
    bool exact_sight = true;       ///< visible parts of polygons by clipping where few polygons can hide them
    std::size_t most_blockers = 6; ///< few, for exact_sight
    visibility::Among occluders = visibility::Among::All; ///< which bodies may stand between
    std::uint64_t seed = 1;
    Integration integration = Integration::Automatic;
    std::uint32_t samples = 128; ///< of the other integrations: points per scrambling, of 8; 1..2^28
};

/// Transport between two elements in world position.
struct TransportBlock {
    std::vector<double> values; ///< size(a) x size(b), row-major; empty = zero [1]
    double error = 0.0;         ///< estimated Frobenius norm of the error of `values` [1]
    std::uint32_t rays = 0;     ///< cast for visibility
};

/// G_ab^kl = integral integral phi_k(x) phi_l(y) cos+ cos'+ V / (pi r^2) dA dA, by Gauss products where the elements are
/// far from each other, else by an exact inner integral over planar facets inside adaptive quadrature; zero, and not
/// computed, where the elements face away from each other. Deterministic. @cite equation (7) of Biri et al. 2003, with
/// bases orthonormal in area (docs/theory.md)
TransportBlock transport(const geometry::ElementShape& a, const geometry::ElementShape& b,
                         const visibility::Occluders& occluders, const TransportOptions& options);

/// Whether any point of a can face any point of b at all (normal cones and half spaces).
bool may_exchange(const geometry::ElementShape& a, const geometry::ElementShape& b);

/// Whether the plane of one of two planar elements cuts the other: where it moves on, their block has a bend in time.
bool cut_by_horizon(const geometry::ElementShape& a, const geometry::ElementShape& b);

} // namespace kinelux::kernel
