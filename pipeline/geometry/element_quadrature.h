// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "geometry/element_shape.h"

namespace kinelux::geometry {

/// What an element integrates with.
struct ElementQuadrature {
    double area;      ///< [m2]; of the true surface on curved patches
    Vec3 normal_area; ///< integral of the unit normal [m2]
    Basis basis;      ///< orthonormal with respect to that area
    std::array<NodeSet, rule_levels> rules;
};

/// Basis and rules of an element from its facets and its surface. Planar elements: a tensor product of Gauss rules where
/// the outline is one parallelogram, else rules on the facets, thinned where that saves nodes. Curved patches: rules in
/// the parameters with the true area, refined until the area no longer changes, then thinned. Clusters that are not
/// planar: nodes of equal weight at equal steps of area.
/// @param shape   facets, planar, surface and from_patch are read
/// @param degree  of the basis, 0..max_degree
ElementQuadrature element_quadrature(const ElementShape& shape, int degree);

} // namespace kinelux::geometry
