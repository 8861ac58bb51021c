// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"
#include "geometry/basis.h"
#include "geometry/element_shape.h"
#include "visibility/loops.h"

namespace kinelux::kernel {

/// Polynomial moments of the transport kernel over flat polygons of one plane, as seen from a point:
///   values_l = integral over the polygon of phi_l(y) cos+ cos' / (pi r^2) dA_y   [1/m].
/// The radial part of the integral from the foot of the point is in closed form, what remains along each edge is a
/// smooth integral by Gauss-Legendre after t = c sinh(s), which keeps the kernel's poles away however close the point
/// comes to the polygon, an edge or a corner. Moments beyond the constant have no elementary closed form.
/// @cite Lambert, Photometria (1760) for the constant; docs/quadrature.md
class PolygonMoments {
public:
    /// @param facet  any piece of the plane: gives its position, its front and the parameters of its points
    /// @param basis  the functions, polynomials of those parameters
    PolygonMoments(const geometry::Facet& facet, const geometry::Basis& basis);

    /// Loops in the plane by its own coordinates [m]. @param flat  overwritten; keeps its memory
    void to_plane(const visibility::Loops3& loops, visibility::Loops2& flat) const;
    Vec2 to_plane(const Vec3& point) const;

    /// @param x       the point; the result is zero where it is not in front of the plane
    /// @param normal  the point's, unit
    /// @param loops   boundaries of the polygon in the plane's coordinates; none of it may lie below the point's
    ///                horizon
    /// @param tolerance  relative to the edges' contributions [1], 1e-14..0.1
    /// @param values  basis size, overwritten
    /// @return  what values_0 may be off, over the function's value: the tolerance, or rounding, of the sum of what the
    ///          edges contribute, each without its sign [1]
    double gather(const Vec3& x, const Vec3& normal, const visibility::Loops2& loops, double tolerance,
                  std::span<double> values) const;

private:
    Vec3 origin_, axis_u_, axis_v_, front_;    ///< orthonormal frame of the plane
    Vec2 scaled_origin_, scaled_u_, scaled_v_; ///< the basis' scaled coordinates: origin + a u + b v
    int degree_;
    std::vector<double> monomials_; ///< Basis::monomial_coefficients
};

} // namespace kinelux::kernel
