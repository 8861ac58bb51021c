// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "model/cluster_tree.h"
#include "model/patch_set.h"

namespace kinelux::geometry {

/// Cuts the domain of a curved patch, or of a part of it, into the triangles that stand for it where chords must do: 48
/// steps a turn, 16 along what is not round. The lines depend on the surface alone, so that parts cut on their own fit
/// together. Planes stay as they are.
std::vector<model::DomainTriangle> tessellated(const model::Surface& surface,
                                               std::span<const model::DomainTriangle> domain);

/// The triangles of a patch as such a domain.
std::vector<model::DomainTriangle> domain_of(const model::Patch& patch);

/// How far the chords of a patch's tessellation stand before its front: 0 on planes and where it bulges [m].
double chord_height(const model::Patch& patch);

} // namespace kinelux::geometry
