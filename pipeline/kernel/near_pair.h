// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "kernel/singularity.h"

namespace kinelux::kernel {

/// The inner integral of a transport block: what a point receives from each basis function of one element.
class PointGather {
public:
    virtual ~PointGather() = default;
    /// values_l = integral of phi_l(y) K(x, y) V(x, y) dA_y over the element. @param x  the point, its normal; the
    /// weight is ignored @param values  basis size, overwritten [1/m]
    virtual void gather(const geometry::SurfaceNode& x, std::span<double> values) = 0;
};

/// A convex flat polygon of one facet's plane, or a part of a curved facet, by barycentric coordinates (of corners 1
/// and 2); counter-clockwise.
struct OuterPiece {
    const geometry::Facet* facet;
    std::vector<Vec2> corners;
};

struct OuterOptions {
    double tolerance = 1e-3;               ///< of the sum's Frobenius norm [1], 1e-10..0.1
    double floor = 0.0;                    ///< norm below which only tolerance times it is asked for [1]
    std::size_t most_points = 20000;       ///< evaluations of the inner integral
    const InnerPolygon* polygon = nullptr; ///< the first cells and their rules are planned from its edges
    bool refine =
        true; ///< false where the polygon says all there is to know: all of it is visible from everywhere
    bool settle =
        true; ///< without `refine`: errors are measured and plans amended; false where the inner integral is
              ///< sampled, so that measuring would find the noise
};

struct OuterResult {
    std::vector<double> values; ///< basis size of the outer element x `columns`, row-major [1]
    double error = 0.0;         ///< estimated Frobenius norm of their error [1]
    std::size_t points = 0;     ///< evaluations of the inner integral
};

/// The outer integral: sum over pieces of integral phi_k(x) gather_l(x) dA, by tensor Gauss products on quadrilateral
/// cells. Planned cells are cut until the distance of the nearest singularity of the integrand, real or complex, lets few
/// nodes resolve it in either direction. With `settle` their errors are measured, and cells that hold most of them are
/// planned anew until the sum is below the tolerance; else the error is the tolerance. With `refine` the cell with the
/// largest error is divided, across the direction in which the integrand is rougher, until their sum is below the
/// tolerance.
/// @param element  the pieces lie on
/// @param columns  basis size of the inner element
OuterResult integrate_outer(const geometry::ElementShape& element, std::span<const OuterPiece> pieces,
                            std::size_t columns, PointGather& inner, const OuterOptions& options);

} // namespace kinelux::kernel
