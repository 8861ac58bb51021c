// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/element_shape.h"

namespace kinelux::support {

/// A convex polygon in a plane's own coordinates, counter-clockwise seen from the front [m].
using Polygon = std::vector<Vec2>;

/// A side of a polygon, or a straight line through two points.
struct Line {
    Vec2 from, to; ///< [m]
};

/// A plane with coordinates in it, and the basis parameters of the element that lies in it.
struct Plane {
    Vec3 origin, axis_u, axis_v, normal;         ///< right-handed, orthonormal; the normal to the front
    Vec2 parameter0, parameter_du, parameter_dv; ///< parameter(p) = parameter0 + p.x du + p.y dv
    Vec3 point(const Vec2& p) const { return origin + p.x * axis_u + p.y * axis_v; }
    Vec2 local(const Vec3& x) const { return {glm::dot(x - origin, axis_u), glm::dot(x - origin, axis_v)}; }
    double height(const Vec3& x) const { return glm::dot(x - origin, normal); }
    Vec2 parameter(const Vec2& p) const { return parameter0 + p.x * parameter_du + p.y * parameter_dv; }
};

/// The facets of an element that lie in one plane.
struct FlatPiece {
    Plane plane;
    std::vector<Polygon> parts; ///< do not overlap
    std::vector<Line> outline;  ///< sides that belong to one facet only
};

/// One piece for a planar element, one per facet for any other.
std::vector<FlatPiece> flat_pieces(const geometry::ElementShape& shape);

/// What of a piece lies in front of a plane. Heights below 1e-14 of the coordinates' size count as none.
FlatPiece in_front(const FlatPiece& piece, const Plane& plane);

/// Both parts of a polygon on either side of a line; one part where the line does not cross it.
std::vector<Polygon> cut(const Polygon& polygon, const Line& line);

/// Twice the signed area of a triangle.
inline double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

/// The largest distance of two corners [m].
double diameter(std::span<const Vec2> polygon);

} // namespace kinelux::support
