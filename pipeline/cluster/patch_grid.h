// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "model/cluster_tree.h"
#include "model/patch_set.h"

namespace kinelux::cluster {

using Piece = std::vector<model::DomainTriangle>; ///< the domain of one element

/// Cuts a patch's domain into the cells of a grid along u and v; cells that the trimming leaves a sliver of join a
/// neighbour. The pieces cover the domain once; none bends by more than a quarter turn about a surface's axes.
/// @param largest_edge  of a cell, measured on the surface [m], > 0
std::vector<Piece> cut_patch(const model::Patch& patch, double largest_edge);

/// Extent of the patch along u and v, measured on the surface [m].
Vec2 extent_on_surface(const model::Patch& patch);

} // namespace kinelux::cluster
