// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "core/vec.h"

namespace kinelux::geometry {

/// A point of a parameter domain with its share of the area.
struct DomainPoint {
    Vec2 parameter;
    double weight; ///< [m2], > 0
};

/// Polynomials of total degree <= degree in two parameters: (degree + 1)(degree + 2) / 2.
constexpr std::size_t basis_size(int degree) {
    return static_cast<std::size_t>((degree + 1) * (degree + 2) / 2);
}

/// Products of Legendre polynomials in the principal axes of a domain's area, scaled to its extent there: well
/// conditioned on slivers in any direction, where products in the parameters themselves are not.
class LegendreFrame {
public:
    static constexpr int max_degree = 18; ///< of the products

    LegendreFrame() = default;
    /// @param domain  a quadrature of the domain that is exact for polynomials of degree 2
    /// @throws GeometryError  the domain has no area
    explicit LegendreFrame(std::span<const DomainPoint> domain);

    /// All products of total degree <= degree at a parameter point, by total degree.
    /// @param values  basis_size(degree) or more values [1]
    void products(const Vec2& parameter, int degree, std::span<double> values) const;

    /// The coordinates the products are made of: affine in the parameter, [-1, 1]^2 on the domain's bounding box.
    Vec2 scaled(const Vec2& parameter) const;

private:
    Vec2 centre_{0.0};
    Vec2 axis_u_{1.0, 0.0}, axis_v_{0.0, 1.0};
    Vec2 inverse_half_extent_{1.0};
};

} // namespace kinelux::geometry
