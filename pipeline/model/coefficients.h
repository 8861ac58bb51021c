// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.h"

namespace kinelux::model {

/// Where each element's unknowns start: element e owns [offsets[e], offsets[e+1]) of every coefficient vector.
struct UnknownLayout {
    std::vector<std::uint32_t> offsets; ///< elements + 1

    std::size_t elements() const { return offsets.empty() ? 0 : offsets.size() - 1; }
    std::size_t unknowns() const { return offsets.empty() ? 0 : offsets.back(); }
    std::size_t count(std::size_t element) const { return offsets[element + 1] - offsets[element]; }
};

/// One stored transport block G_ij, i <= j; G_ji is its transpose.
struct BlockEntry {
    std::uint32_t i = 0, j = 0;
    std::uint64_t offset = 0; ///< of its count(i) x count(j) row-major values
    float error = 0.0f;       ///< estimated Frobenius norm of its error, same unit as the values [1]
};

/// A sparse symmetric set of transport blocks
///   G_ij^kl = integral integral phi_k(x) phi_l(y) cos cos' V / (pi r^2) dA dA   [1],
/// phi orthonormal with respect to area (phi_0 = 1/sqrt(A)).
struct BlockSet {
    std::vector<BlockEntry> entries; ///< sorted by (i, j), each pair once
    std::vector<float> values;
};

/// An index pair i <= j of elements.
struct ElementPair {
    std::uint32_t i = 0, j = 0;
    auto operator<=>(const ElementPair&) const = default;
};

/// The system B = M + rho G B of one scene: blocks that never change, and the pairs whose blocks change with time.
struct Coefficients {
    UnknownLayout layout;
    int degree = 0;
    BlockSet static_blocks;
    std::vector<ElementPair> moving_pairs; ///< bodies move relative to each other; recomputed in every frame
    std::vector<ElementPair>
        crossed_pairs;         ///< at rest, but a moving body may enter between them in some frame
    double pairs_examined = 0; ///< of static pairs [1]
    double rays_cast = 0;      ///< for static blocks [1]
};

/// @throws GeometryError  unsorted or out-of-range entries, value offsets beyond the end, not-a-number values
void check(const Coefficients& coefficients);

} // namespace kinelux::model
