// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"
#include "geometry/legendre_frame.h"

namespace kinelux::geometry {

constexpr int max_degree = 6; ///< of a basis

/// Polynomials orthonormal with respect to area on an element's real, trimmed domain; function 0 is 1/sqrt(area), and
/// function k has no component of the functions before it. Stable on slivers: principal axes of the area, scaled to
/// the bounding box, Legendre products, orthonormalised twice by modified Gram-Schmidt (a QR of the weighted
/// Vandermonde matrix).
class Basis {
public:
    Basis() = default;
    /// @param domain  a quadrature of the domain that is exact for polynomials of degree 2 `degree`
    /// @param degree  0..max_degree; lowered where the domain does not determine that many functions
    /// @throws GeometryError  the domain has no area
    Basis(std::span<const DomainPoint> domain, int degree);

    int degree() const { return degree_; }
    std::size_t size() const { return basis_size(degree_); }
    /// All functions at a parameter point. @param values  size() values [1/m]
    void evaluate(const Vec2& parameter, std::span<double> values) const;
    /// The coordinates (x, y) in which the domain fills [-1, 1]^2; affine in the parameter.
    Vec2 scaled(const Vec2& parameter) const { return frame_.scaled(parameter); }
    /// The functions as polynomials of the scaled coordinates: size() x size(), row k = function k, columns the
    /// monomials x^(t-j) y^j by total degree t, then by j [1/m].
    std::vector<double> monomial_coefficients() const;

private:
    int degree_ = 0;
    LegendreFrame frame_;
    std::vector<double> coefficients_; ///< lower triangular, size() x size(), row k = function k
};

} // namespace kinelux::geometry
