// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "model/patch_set.h"

namespace kinelux::support {

/// A closed polyhedron whose faces look inwards: every row of its form factors sums to 1.
struct ClosedRoom {
    std::string name;
    model::PatchSet set;
    double longest_edge; ///< [m]
};

/// Eleven rooms: boxes to the extreme, tetrahedra, a pyramid, prisms, one with a corner that hides, one with a box in it.
std::vector<ClosedRoom> closed_rooms();

/// The faces of an upright prism, inwards. @param outline  counter-clockwise from above; every corner is seen from the
/// first one [m]
std::vector<model::Patch> prism(std::span<const Vec2> outline, double height);

/// The faces over the sides of a polygon up to an apex, and the polygon itself, inwards. @param base  as of prism
std::vector<model::Patch> pyramid(std::span<const Vec2> base, const Vec3& apex);

} // namespace kinelux::support
