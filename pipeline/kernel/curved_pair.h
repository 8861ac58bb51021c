// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/element_shape.h"

namespace kinelux::kernel {

struct PairIntegral {
    std::vector<double> values; ///< size(a) x size(b), row-major [1]
    double error = 0.0;         ///< estimated Frobenius norm of their error [1]
};

/// The block of two elements, one of which at least is curved or a cluster, with nothing in between; also of such an
/// element with itself. Elements inside one sphere: closed form, for the kernel is 1 / (4 pi R^2) there. Else adaptive
/// quadrature over one element (the cluster, or the one along which the other's integral is the smoother) around the
/// other's integral at each point: PolygonMoments above the point's horizon, SurfaceCells, or FacetSum. Clusters are
/// summed over their nodes instead where two sets of nodes agree, or have more facets than are worth it.
/// @param tolerance  relative to the block, or to `floor` where that is larger [1], 1e-9..0.1
/// @param floor      norm of a block that nobody asks for more of [1]
/// @cite Howell, A Catalog of Radiation Heat Transfer Configuration Factors, section on spheres, for the closed form
PairIntegral curved_pair(const geometry::ElementShape& a, const geometry::ElementShape& b, double tolerance,
                         double floor);

} // namespace kinelux::kernel
