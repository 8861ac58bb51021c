// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "kernel/near_pair.h"
#include "visibility/loops.h"
#include "visibility/shaft.h"
#include "visibility/visible_polygon.h"

namespace kinelux::kernel {

/// Barycentric coordinates, of corners 1 and 2, of a point in a facet's plane [1].
Vec2 barycentric(const geometry::Facet& facet, const Vec3& point);

/// Convex pieces of a planar element in front of a plane. @param slack  what reaches less far over it is behind [m]
std::vector<OuterPiece> pieces_in_front(const geometry::ElementShape& a, const visibility::HalfSpace& front,
                                        double slack);

/// Where two elements face each other across a narrow gap the inner integral all but jumps below the inner polygon's
/// edges: cuts pieces along them, so that jumps lie between pieces.
/// @param loops  of the inner polygon [m]; @param front  its plane; @param size  of the outer element [m]
std::vector<OuterPiece> cut_below_edges(std::vector<OuterPiece> pieces, const visibility::Loops3& loops,
                                        const visibility::HalfSpace& front, double size);

/// Where a polygon that stands between meets the outer element's plane its shadow begins with a jump: cuts pieces along
/// the planes of those that cross it or stand on it.
/// @param front  the outer element's plane; @param size  of the outer element [m]
std::vector<OuterPiece> cut_at_blockers(std::vector<OuterPiece> pieces,
                                        std::span<const visibility::PlanarBlocker> blockers,
                                        const visibility::HalfSpace& front, double size);

double area_of(const OuterPiece& piece); ///< [m2], of the flat facet's share

/// A point of a piece, towards its corner of a number (any, counted around).
geometry::SurfaceNode probe(const geometry::ElementShape& outer, const OuterPiece& piece, std::size_t corner);

} // namespace kinelux::kernel
