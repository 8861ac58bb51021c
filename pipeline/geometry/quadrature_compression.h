// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/legendre_frame.h"

namespace kinelux::geometry {

/// A node kept by compress_quadrature.
struct KeptNode {
    std::size_t index; ///< into the rule given
    double weight;     ///< new weight [m2], > 0
};

/// A rule with a subset of the nodes and new positive weights that integrates every polynomial of total degree
/// <= degree like the one given: at most basis_size(degree) nodes (Tchakaloff). Elements of many small triangles get as
/// cheap as elements of two.
/// @param degree  0..LegendreFrame::max_degree
/// @return  nothing where the rule given is short already (less than 1.5 times that many nodes)
/// @cite Piazzon, Sommariva, Vianello, Caratheodory-Tchakaloff subsampling, Dolomites Res. Notes Approx. 10 (2017)
std::optional<std::vector<KeptNode>> compress_quadrature(std::span<const DomainPoint> rule, int degree);

} // namespace kinelux::geometry
