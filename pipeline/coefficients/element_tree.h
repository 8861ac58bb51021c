// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "model/coefficients.h"
#include "visibility/occluders.h"

namespace kinelux::coefficients {

/// An element, or a group of elements, as links see it.
struct TreeNode {
    std::uint32_t first = 0, second = 0; ///< child nodes; equal for an element
    Vec3 box_low{0.0}, box_high{0.0};
    Vec3 centre{0.0}; ///< of a ball that holds the balls of both children
    double radius = 0.0;
    Vec3 mean_normal{0.0};    ///< axis of the normal cone, unit
    double cone_cosine = 1.0; ///< of the cone's half angle
    double area = 0.0;        ///< [m2]
    bool buried = false;      ///< all around it are back sides
    /// A quadrature with positive weights exact to degree 2 in position (clusters: of a few spread nodes), and the
    /// node's basis there: an element's own; of a group 1/sqrt(A) and up to three linear functions of position along
    /// the principal axes of its area, orthonormal in area.
    geometry::NodeSet rule;
    std::size_t basis_size = 0;

    bool is_element() const { return first == second; }
};

/// Binary tree over some elements.
struct ElementTree {
    std::vector<TreeNode> nodes; ///< all elements first, in order; then groups, children before parents
    std::size_t root = 0;        ///< the last node; meaningless where no element is in the tree
    model::Hierarchy hierarchy;  ///< layout, groups and restrictions; without links
};

/// Groups elements that lie inside of something apart from all others (below a box on the floor no light may leak in from
/// groups that reach below it): those from whose nodes only back sides are seen. Then by normal, until those of a group lie within about 60 degrees of each other, then by halves of
/// the longest side of their centres' box.
/// @param elements   in order of ElementId
/// @param members    numbers of those in the tree, increasing
/// @param occluders  of all bodies at rest
ElementTree build_element_tree(std::span<const geometry::ElementShape> elements,
                               std::span<const std::uint32_t> members,
                               const visibility::Occluders& occluders);

} // namespace kinelux::coefficients
