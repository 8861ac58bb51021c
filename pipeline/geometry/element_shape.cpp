// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/element_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/quadrature.h"
#include "geometry/quadrature_compression.h"
#include "geometry/surface.h"

namespace kinelux::geometry {

namespace {

constexpr double planar_tolerance = 1e-7; ///< of the element's radius
constexpr std::size_t cluster_nodes = 16; ///< of a cluster's coarse quadrature at the most
constexpr std::size_t few_facets = 3;     ///< an element of so few needs no compressed quadrature

Facet make_facet(const std::array<Vec3, 3>& corners, const std::array<Vec2, 3>& parameters) {
    const Vec3 cross = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double length = glm::length(cross);
    return {corners, parameters, length > 0.0 ? cross / length : Vec3(0.0), 0.5 * length};
}

std::vector<Facet> patch_facets(const model::Patch& patch, const model::ClusterTree& tree,
                                const model::Element& element) {
    std::vector<Facet> facets;
    for (std::uint32_t t = 0; t < element.triangle_count; ++t) {
        const model::DomainTriangle& uv = tree.domain_triangles[element.first_triangle + t];
        std::array<Vec3, 3> corners;
        for (std::size_t c = 0; c < 3; ++c) corners[c] = evaluate(patch.surface, uv[c]).position;
        Facet facet = make_facet(corners, uv);
        if (patch.surface.orientation < 0.0) {
            std::swap(facet.corners[1], facet.corners[2]);
            std::swap(facet.parameters[1], facet.parameters[2]);
            facet.normal = -facet.normal;
        }
        if (facet.area > 0.0) facets.push_back(facet);
    }
    return facets;
}

// A cluster's basis lives on the plane through its mean normal (or across its longest extent where normals cancel).
std::vector<Facet> cluster_facets(const model::SmallTriangles& small, const model::Cluster& cluster) {
    std::vector<Facet> facets;
    Vec3 mean(0.0), centre(0.0);
    double area = 0.0;
    for (const std::uint32_t t : cluster.triangles) {
        const model::Triangle& triangle = small.triangles[t];
        const Facet facet =
            make_facet({small.points[triangle[0]], small.points[triangle[1]], small.points[triangle[2]]}, {});
        if (!(facet.area > 0.0)) continue;
        facets.push_back(facet);
        mean += facet.area * facet.normal;
        centre += facet.area / 3.0 * (facet.corners[0] + facet.corners[1] + facet.corners[2]);
        area += facet.area;
    }
    centre /= std::max(area, std::numeric_limits<double>::min());
    const Vec3 normal = glm::length(mean) > 1e-3 * area ? glm::normalize(mean) : Vec3(0.0, 0.0, 1.0);
    const Vec3 helper = std::abs(normal.x) < 0.6 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
    const Vec3 u = glm::normalize(glm::cross(helper, normal));
    const Vec3 v = glm::cross(normal, u);
    for (Facet& facet : facets)
        for (std::size_t c = 0; c < 3; ++c)
            facet.parameters[c] = {glm::dot(facet.corners[c] - centre, u),
                                   glm::dot(facet.corners[c] - centre, v)};
    return facets;
}

void set_bounds(ElementShape& shape) {
    shape.box_low = Vec3(std::numeric_limits<double>::infinity());
    shape.box_high = -shape.box_low;
    Vec3 mean(0.0);
    for (const Facet& facet : shape.facets) {
        for (const Vec3& corner : facet.corners) {
            shape.box_low = glm::min(shape.box_low, corner);
            shape.box_high = glm::max(shape.box_high, corner);
        }
        mean += facet.area * facet.normal;
        shape.area += facet.area;
    }
    shape.centre = 0.5 * (shape.box_low + shape.box_high);
    shape.mean_normal = glm::length(mean) > 1e-9 * shape.area ? glm::normalize(mean) : Vec3(0.0, 0.0, 1.0);
    for (const Facet& facet : shape.facets) {
        for (const Vec3& corner : facet.corners)
            shape.radius = std::max(shape.radius, glm::distance(corner, shape.centre));
        shape.cone_cosine = std::min(shape.cone_cosine, glm::dot(facet.normal, shape.mean_normal));
    }
    const Vec3 origin = shape.facets.front().corners[0];
    for (const Facet& facet : shape.facets)
        for (const Vec3& corner : facet.corners)
            if (std::abs(glm::dot(corner - origin, shape.mean_normal)) > planar_tolerance * shape.radius)
                shape.planar = false;
    shape.planar = shape.planar && shape.cone_cosine > 0.5;
}

struct RawNode {
    SurfaceNode node;
    Vec2 parameter;
};

std::vector<RawNode> facet_nodes(std::span<const Facet> facets, int degree) {
    std::vector<RawNode> nodes;
    for (const Facet& facet : facets)
        for (const TriangleNode& t : triangle_rule(degree)) {
            RawNode raw{{Vec3(0.0), facet.normal, t.weight * facet.area}, Vec2(0.0)};
            for (std::size_t c = 0; c < 3; ++c) {
                raw.node.position += t.barycentric[c] * facet.corners[c];
                raw.parameter += t.barycentric[c] * facet.parameters[c];
            }
            nodes.push_back(raw);
        }
    return nodes;
}

std::vector<DomainPoint> domain_points(std::span<const RawNode> nodes) {
    std::vector<DomainPoint> points;
    points.reserve(nodes.size());
    for (const RawNode& raw : nodes) points.push_back({raw.parameter, raw.node.weight});
    return points;
}

// `count` nodes of equal weight at equal steps of the area of the facets.
std::vector<RawNode> systematic_nodes(const ElementShape& shape, std::size_t count) {
    std::vector<RawNode> all = facet_nodes(shape.facets, shape.facets.size() >= count ? 1 : 2);
    if (all.size() <= count) return all;
    std::vector<RawNode> chosen;
    const double step = shape.area / static_cast<double>(count);
    double sum = 0.0;
    for (const RawNode& raw : all)
        for (sum += raw.node.weight;
             chosen.size() < count && sum > (static_cast<double>(chosen.size()) + 0.5) * step;) {
            chosen.push_back(raw);
            chosen.back().node.weight = step;
        }
    return chosen;
}

// A rule on a patch's element that is exact to `degree`, with few nodes however many facets there are.
std::vector<RawNode> patch_nodes(const ElementShape& shape, int degree) {
    std::vector<RawNode> exact = facet_nodes(shape.facets, degree);
    const auto kept = compress_quadrature(domain_points(exact), degree);
    if (!kept) return exact;
    std::vector<RawNode> nodes;
    for (const auto& [index, weight] : *kept) {
        nodes.push_back(exact[index]);
        nodes.back().node.weight = weight;
    }
    return nodes;
}

NodeSet node_set(const Basis& basis, std::span<const RawNode> raw) {
    NodeSet set;
    set.basis.resize(raw.size() * basis.size());
    for (std::size_t i = 0; i < raw.size(); ++i) {
        set.nodes.push_back(raw[i].node);
        basis.evaluate(raw[i].parameter, std::span(set.basis).subspan(i * basis.size(), basis.size()));
    }
    return set;
}

void set_basis_and_nodes(ElementShape& shape, int degree) {
    shape.basis = Basis(domain_points(facet_nodes(shape.facets, 2 * degree)), degree);
    if (shape.from_patch) {
        const int fine_degree = shape.facets.size() <= few_facets ? 8 : 6;
        shape.nodes = node_set(shape.basis, patch_nodes(shape, 2 * degree));
        shape.fine_nodes = node_set(shape.basis, patch_nodes(shape, fine_degree));
    } else {
        shape.nodes = node_set(shape.basis, systematic_nodes(shape, cluster_nodes));
        shape.fine_nodes = node_set(shape.basis, systematic_nodes(shape, 4 * cluster_nodes));
    }
}

} // namespace

std::vector<ElementShape> element_shapes(const model::PatchSet& patches, const model::ClusterTree& tree,
                                         int degree, int cluster_degree) {
    std::vector<ElementShape> shapes(tree.elements.size());
    core::parallel_for(shapes.size(), [&](std::size_t e) {
        const model::Element& element = tree.elements[e];
        ElementShape& shape = shapes[e];
        shape.id = ElementId(e);
        shape.object = element.object;
        shape.material = element.material;
        shape.from_patch = element.patch.has_value();
        shape.facets = element.patch ? patch_facets(patches.patches[element.patch->value], tree, element)
                                     : cluster_facets(patches.small, tree.clusters[element.cluster->value]);
        if (shape.facets.empty())
            throw core::GeometryError("element " + std::to_string(e) +
                                      " has no area; run kinelux-clean first");
        set_bounds(shape);
        set_basis_and_nodes(shape, element.patch ? degree : cluster_degree);
    });
    return shapes;
}

ElementShape moved(const ElementShape& rest, const Pose& pose) {
    ElementShape shape = rest;
    for (Facet& facet : shape.facets) {
        for (Vec3& corner : facet.corners) corner = pose.point(corner);
        facet.normal = pose.direction(facet.normal);
    }
    for (NodeSet* set : {&shape.nodes, &shape.fine_nodes})
        for (SurfaceNode& node : set->nodes) {
            node.position = pose.point(node.position);
            node.normal = pose.direction(node.normal);
        }
    shape.mean_normal = pose.direction(rest.mean_normal);
    shape.centre = pose.point(rest.centre);
    shape.box_low = Vec3(std::numeric_limits<double>::infinity());
    shape.box_high = -shape.box_low;
    for (const Facet& facet : shape.facets)
        for (const Vec3& corner : facet.corners) {
            shape.box_low = glm::min(shape.box_low, corner);
            shape.box_high = glm::max(shape.box_high, corner);
        }
    return shape;
}

Vec2 facet_parameter(const Facet& facet, const Vec3& point) {
    const Vec3 e1 = facet.corners[1] - facet.corners[0], e2 = facet.corners[2] - facet.corners[0];
    const Vec3 d = point - facet.corners[0];
    const double b1 = glm::dot(glm::cross(d, e2), facet.normal) / (2.0 * facet.area);
    const double b2 = glm::dot(glm::cross(e1, d), facet.normal) / (2.0 * facet.area);
    return (1.0 - b1 - b2) * facet.parameters[0] + b1 * facet.parameters[1] + b2 * facet.parameters[2];
}

bool may_pass_between(const ElementShape& a, const ElementShape& b, const Vec3& centre, double radius) {
    // All segments between two balls lie in their hull, whose radius varies linearly along the axis.
    const Vec3 axis = b.centre - a.centre;
    const double length2 = glm::dot(axis, axis);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(centre - a.centre, axis) / length2, 0.0, 1.0) : 0.0;
    const double reach = radius + std::max(a.radius, b.radius);
    if (glm::distance(centre, a.centre + t * axis) > reach) return false;
    const Vec3 low = glm::min(a.box_low, b.box_low) - radius,
               high = glm::max(a.box_high, b.box_high) + radius;
    return glm::all(glm::lessThanEqual(low, centre)) && glm::all(glm::lessThanEqual(centre, high));
}

} // namespace kinelux::geometry
