// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "model/coefficients.h"

// Vectors over elements and vectors over all nodes of a hierarchy: unknowns x channels, channel fastest.
namespace kinelux::model {

/// The coefficients of all nodes, from those of the elements. @param x  elements' unknowns x channels
std::vector<double> gather_groups(const Hierarchy& hierarchy, std::size_t channels,
                                  std::span<const double> x);

/// Adds what has arrived at groups to the elements below them.
/// @param arrived  all nodes' unknowns x channels; used up
/// @param y        elements' unknowns x channels
void spread_groups(const Hierarchy& hierarchy, std::size_t channels, std::span<double> arrived,
                   std::span<double> y);

/// y += what the links carry of x. @param x, y  elements' unknowns x channels
void add_link_transport(const Hierarchy& hierarchy, std::size_t channels, std::span<const double> x,
                        std::span<double> y);

} // namespace kinelux::model
