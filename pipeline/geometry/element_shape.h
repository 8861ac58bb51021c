// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "geometry/basis.h"
#include "geometry/pose.h"
#include "model/cluster_tree.h"
#include "model/patch_set.h"

namespace kinelux::geometry {

/// A flat piece of an element with the parameters of its corners; on a curved patch the triangle between three points
/// of the surface.
struct Facet {
    std::array<Vec3, 3> corners;    ///< [m]
    std::array<Vec2, 3> parameters; ///< what the basis is evaluated at; linear on the facet
    Vec3 normal;                    ///< unit, to the front
    double area;                    ///< of the flat triangle [m2]
};

/// A node of an element's quadrature.
struct SurfaceNode {
    Vec3 position; ///< [m]
    Vec3 normal;   ///< unit
    double weight; ///< [m2]
    double lift =
        0.0; ///< sight begins this far above it: over the chords that occlude for a hollow surface [m]

    /// Where rays from here start and rays to here end.
    Vec3 sight_point() const { return position + lift * normal; }
};

/// A quadrature of an element together with its basis there.
struct NodeSet {
    std::vector<SurfaceNode> nodes;
    std::vector<double> basis; ///< nodes x basis size: basis values at the nodes [1/m]
    int exactness = 0; ///< total degree in the parameters up to which it is exact, with the area factor
};

/// Rules of different exactness that every element has.
constexpr std::size_t rule_levels = 3;

/// An element as the transport kernel sees it: facets, basis and ready quadratures, in world position. Bounds and normal
/// cone hold for the true surface.
struct ElementShape {
    ElementId id;
    ObjectId object;
    MaterialId material;
    bool planar = true;     ///< all in one plane: no exchange with itself
    bool from_patch = true; ///< else a cluster
    std::vector<Facet> facets;
    /// Boundary of a planar element: closed loops, counter-clockwise seen from the front, holes clockwise; empty where
    /// the element is not planar [m]
    std::vector<std::vector<Vec3>> outline;
    std::optional<model::Surface> surface; ///< of a curved patch, in the position of the element
    double chord_height = 0.0;             ///< how far the patch's tessellation stands before its front [m]
    Basis basis;
    double area = 0.0;                ///< [m2]; of the true surface
    Vec3 centre{0.0};                 ///< of the bounding sphere
    double radius = 0.0;              ///< of the bounding sphere [m]
    Vec3 box_low{0.0}, box_high{0.0}; ///< axis-aligned bounds
    Vec3 mean_normal{0.0};            ///< axis of the normal cone, unit
    double cone_cosine = 1.0;         ///< of the cone's half angle; 1 = flat, -1 = any direction
    /// On patches exact for polynomials of degree max(1, 2 d), 2 d + 3 and 2 d + 6, d = basis.degree(); on curved ones
    /// the nodes lie on the true surface.
    std::array<NodeSet, rule_levels> rules;
};

/// The flat triangle between the points of a surface at the corners of a piece of its domain.
Facet facet_of(const model::Surface& surface, const model::DomainTriangle& piece);

/// All elements at rest, in order of ElementId.
/// @param degree          of the bases on patches, 0..max_degree
/// @param cluster_degree  of the bases on clusters
/// @throws GeometryError  an element without area (carries its number)
std::vector<ElementShape> element_shapes(const model::PatchSet& patches, const model::ClusterTree& tree,
                                         int degree, int cluster_degree);

/// The same element elsewhere: positions, normals and bounds moved, parameters and basis untouched.
ElementShape moved(const ElementShape& rest, const Pose& pose);

/// A point of an element's true surface on or over a facet.
/// @param barycentric  of the point in the facet's parameters, sum 1
/// @param parameter    is set to what the basis is evaluated at
/// @return  position, true normal, and as weight the area per share of the facet: the mean of the weight over the facet
///          is the true area of its part of the element [m2]
/// @throws GeometryError  a point where the surface has no normal
SurfaceNode node_at(const ElementShape& element, const Facet& facet, const std::array<double, 3>& barycentric,
                    Vec2& parameter);

/// The basis parameter at a point of a facet, interpolated between its corners.
Vec2 facet_parameter(const Facet& facet, const Vec3& point);

/// Whether a sphere can touch any segment between two elements; may say yes where it cannot, never the reverse.
bool may_pass_between(const ElementShape& a, const ElementShape& b, const Vec3& centre, double radius);

} // namespace kinelux::geometry
