// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "geometry/basis.h"
#include "geometry/pose.h"
#include "model/cluster_tree.h"
#include "model/patch_set.h"

namespace kinelux::geometry {

/// A flat piece of an element with the parameters of its corners.
struct Facet {
    std::array<Vec3, 3> corners;    ///< [m]
    std::array<Vec2, 3> parameters; ///< what the basis is evaluated at; linear on the facet
    Vec3 normal;                    ///< unit, to the front
    double area;                    ///< [m2]
};

/// A node of an element's quadrature.
struct SurfaceNode {
    Vec3 position; ///< [m]
    Vec3 normal;   ///< unit
    double weight; ///< [m2]
};

/// A quadrature of an element together with its basis there.
struct NodeSet {
    std::vector<SurfaceNode> nodes;
    std::vector<double> basis; ///< nodes x basis size: basis values at the nodes [1/m]
};

/// An element as the transport kernel sees it: facets, basis and a ready quadrature, in world position.
struct ElementShape {
    ElementId id;
    ObjectId object;
    MaterialId material;
    bool planar = true;     ///< all facets in one plane: no exchange with itself
    bool from_patch = true; ///< else a cluster
    std::vector<Facet> facets;
    Basis basis;
    double area = 0.0;                ///< [m2]
    Vec3 centre{0.0};                 ///< of the bounding sphere
    double radius = 0.0;              ///< of the bounding sphere [m]
    Vec3 box_low{0.0}, box_high{0.0}; ///< axis-aligned bounds
    Vec3 mean_normal{0.0};            ///< axis of the normal cone, unit
    double cone_cosine = 1.0;         ///< of the cone's half angle; 1 = flat, -1 = any direction
    NodeSet nodes;                    ///< exact to degree 2 `degree` on patches; for distant partners
    NodeSet fine_nodes;               ///< exact to degree 6 or more; for partners about one element away
};

/// All elements at rest, in order of ElementId.
/// @param degree          of the bases on patches, 0..max_degree
/// @param cluster_degree  of the bases on clusters
/// @throws GeometryError  an element without area (carries its number)
std::vector<ElementShape> element_shapes(const model::PatchSet& patches, const model::ClusterTree& tree,
                                         int degree, int cluster_degree);

/// The same element elsewhere: positions, normals and bounds moved, parameters and basis untouched.
ElementShape moved(const ElementShape& rest, const Pose& pose);

/// The basis parameter at a point of a facet, interpolated between its corners.
Vec2 facet_parameter(const Facet& facet, const Vec3& point);

/// Whether a sphere can touch any segment between two elements; may say yes where it cannot, never the reverse.
bool may_pass_between(const ElementShape& a, const ElementShape& b, const Vec3& centre, double radius);

} // namespace kinelux::geometry
