// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/vec.h"
#include "geometry/element_shape.h"

namespace kinelux::geometry {

/// The part of an element's true surface that belongs to one facet, as a function of two local coordinates (s, t) on the
/// triangle s, t >= 0, s + t <= 1: corner 0 is (0,0), corner 1 (1,0), corner 2 (0,1).
class FacetSurface {
public:
    struct Point {
        Vec3 position;    ///< [m]
        Vec3 along_s;     ///< derivative of the position [m]
        Vec3 along_t;     ///< derivative of the position [m]
        Vec3 area_normal; ///< to the front; its length is dA / (ds dt) [m2], 0 at poles
        Vec2 parameter;   ///< what the basis is evaluated at
    };

    /// Both must outlive this object.
    FacetSurface(const ElementShape& element, const Facet& facet) : element_(&element), facet_(&facet) {}

    Point at(const Vec2& local) const;

    /// Local coordinates of the point of the facet's part nearest to x, found from samples by Gauss-Newton steps: to
    /// rounding where x is near compared with the surface's radii of curvature, else as near as the samples (four per
    /// edge) get. Where several points are as near as each other, one of them.
    Vec2 nearest(const Vec3& x) const;

private:
    double distance2(const Vec3& x, const Vec2& local) const;
    Vec2 nearest_sample(const Vec3& x) const;
    Vec2 nearest_on_edge(const Vec3& x, const Vec2& from, const Vec2& to, double start) const;

    const ElementShape* element_;
    const Facet* facet_;
};

} // namespace kinelux::geometry
