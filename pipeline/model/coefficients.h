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

/// A group of elements that exchange light with distant groups as one: a node of the hierarchy with two children.
struct ElementGroup {
    std::uint32_t first = 0, second = 0; ///< child nodes; each smaller than the group's own node
    std::uint64_t offset =
        0; ///< of its restrictions from the first child, then from the second: count(group) x
           ///< count(child) row-major values each
};

/// Binary trees over elements, and the transport between their nodes. Node n < elements is element n with its own
/// unknowns; node elements + g is group g, with a small orthonormal basis of its own. A group's coefficients are
///   x_group = P_first x_first + P_second x_second,     P_kl = integral over the child of psi_k(group) psi_l(child) dA,
/// and the light that a link brings to a group reaches its children by the transposes. Links and element blocks
/// together are G; no pair of elements is in both.
struct Hierarchy {
    UnknownLayout layout; ///< of all nodes; empty: there is no hierarchy, all pairs are element blocks
    std::vector<ElementGroup> groups;
    std::vector<double> restrictions;
    BlockSet links;              ///< between nodes
    double error_estimate = 0.0; ///< relative L2 error of irradiance that the links are expected to add [1]

    bool empty() const { return layout.offsets.empty(); }
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
    Hierarchy hierarchy; ///< transport between groups at rest that no moving body can come between
    std::vector<ElementPair> moving_pairs; ///< bodies move relative to each other; recomputed in every frame
    std::vector<ElementPair>
        crossed_pairs; ///< at rest relative to each other, but another body may enter between them in some frame
    double pairs_examined = 0; ///< of static pairs [1]
    double rays_cast = 0;      ///< for static blocks [1]
};

/// What an interrupted computation has left: the blocks and pairs (i, j) with i < rows, as the whole has them.
struct CoefficientsSoFar {
    Coefficients coefficients;
    std::uint64_t rows = 0;
};

/// @throws GeometryError  unsorted or out-of-range entries, groups that are no trees, value offsets beyond the end, not-a-number values
void check(const Coefficients& coefficients);

} // namespace kinelux::model
