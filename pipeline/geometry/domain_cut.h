// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "model/cluster_tree.h"

namespace kinelux::geometry {

/// One cell of a cut domain.
struct DomainCell {
    std::uint32_t column = 0, row = 0;
    std::vector<model::DomainTriangle> triangles; ///< of positive area, inside the cell
};

/// Cuts a triangulated domain along the lines u = u_lines[c] and v = v_lines[r] (strictly increasing, covering the
/// domain). Neighbouring pieces share their corners to the last bit, so that a mesh made of them is conforming after
/// merging equal corners. Cells without area are left out; the areas of all pieces sum to the domain's.
std::vector<DomainCell> cut_domain(std::span<const model::DomainTriangle> domain,
                                   std::span<const double> u_lines, std::span<const double> v_lines);

/// Lines that divide [low, high] into the fewest equal parts not wider than `step`; both ends included.
std::vector<double> grid_lines(double low, double high, double step);

} // namespace kinelux::geometry
