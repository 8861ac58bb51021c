// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/element_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/element_quadrature.h"
#include "geometry/facet_loops.h"
#include "geometry/surface.h"
#include "geometry/tessellation.h"

namespace kinelux::geometry {

namespace {

constexpr double planar_tolerance = 1e-7; ///< of the element's radius
constexpr int samples = 8;                ///< per facet edge, to find the bounds of a curved patch

bool is_curved(const model::Surface& surface) { return surface.type != model::SurfaceType::Plane; }

Facet make_facet(const std::array<Vec3, 3>& corners, const std::array<Vec2, 3>& parameters) {
    const Vec3 cross = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double length = glm::length(cross);
    return {corners, parameters, length > 0.0 ? cross / length : Vec3(0.0), 0.5 * length};
}

std::vector<Facet> patch_facets(const model::Patch& patch, const model::ClusterTree& tree,
                                const model::Element& element) {
    std::vector<Facet> facets;
    for (std::uint32_t t = 0; t < element.triangle_count; ++t) {
        const Facet facet = facet_of(patch.surface, tree.domain_triangles[element.first_triangle + t]);
        if (facet.area > 0.0 || is_curved(patch.surface)) facets.push_back(facet);
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

// Points that an element lies between, and how far it may reach beyond them.
struct Extent {
    std::vector<Vec3> points;
    double margin = 0.0;
};

// Points of the true surface over a facet, at equal steps of its parameters, row by row.
std::vector<std::vector<Vec3>> surface_grid(const model::Surface& surface, const Facet& facet) {
    std::vector<std::vector<Vec3>> rows;
    const Vec2 step_1 = (facet.parameters[1] - facet.parameters[0]) / static_cast<double>(samples);
    const Vec2 step_2 = (facet.parameters[2] - facet.parameters[0]) / static_cast<double>(samples);
    for (int i = 0; i <= samples; ++i) {
        rows.emplace_back();
        for (int j = 0; i + j <= samples; ++j)
            rows.back().push_back(position(surface, facet.parameters[0] + static_cast<double>(i) * step_1 +
                                                        static_cast<double>(j) * step_2));
    }
    return rows;
}

// Between samples a surface leaves their chords by an eighth of its second differences along each of two directions and
// mixed; four eighths of the largest bounds their sum.
Extent extent_of(const ElementShape& shape) {
    Extent extent;
    for (const Facet& facet : shape.facets) {
        if (!shape.surface) {
            extent.points.insert(extent.points.end(), facet.corners.begin(), facet.corners.end());
            continue;
        }
        const auto rows = surface_grid(*shape.surface, facet);
        const auto second_difference = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
            extent.margin = std::max(extent.margin, 0.5 * glm::length(a - 2.0 * b + c));
        };
        for (std::size_t i = 0; i < rows.size(); ++i) {
            extent.points.insert(extent.points.end(), rows[i].begin(), rows[i].end());
            for (std::size_t j = 1; j + 1 < rows[i].size(); ++j)
                second_difference(rows[i][j - 1], rows[i][j], rows[i][j + 1]);
            for (std::size_t j = 0; i > 0 && j < rows[i].size() && i + j < samples; ++j)
                second_difference(rows[i - 1][j], rows[i][j], rows[i + 1][j]);
        }
    }
    return extent;
}

void set_box(ElementShape& shape, const Extent& extent) {
    shape.box_low = Vec3(std::numeric_limits<double>::infinity());
    shape.box_high = -shape.box_low;
    for (const Vec3& point : extent.points) {
        shape.box_low = glm::min(shape.box_low, point);
        shape.box_high = glm::max(shape.box_high, point);
    }
    shape.box_low -= extent.margin;
    shape.box_high += extent.margin;
}

double angle_between(const Vec3& a, const Vec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// The cosine of the largest angle between the true normals and the mean one. Outside the samples a normal turns by no
// more than between samples two steps apart.
double curved_cone_cosine(const ElementShape& shape) {
    double widest = 0.0, largest_turn = 0.0;
    for (const Facet& facet : shape.facets) {
        std::vector<Vec3> row, previous_row;
        for (int i = 0; i < samples; ++i, previous_row = std::exchange(row, {}))
            for (int j = 0; i + j < samples; ++j) {
                // Inside the facet: at its corners a pole may have no normal.
                const double b1 = (i + 1.0 / 3.0) / samples, b2 = (j + 1.0 / 3.0) / samples;
                Vec2 parameter;
                const Vec3 normal = node_at(shape, facet, {1.0 - b1 - b2, b1, b2}, parameter).normal;
                widest = std::max(widest, angle_between(normal, shape.mean_normal));
                if (j > 0) largest_turn = std::max(largest_turn, angle_between(normal, row.back()));
                if (i > 0)
                    largest_turn = std::max(largest_turn,
                                            angle_between(normal, previous_row[static_cast<std::size_t>(j)]));
                row.push_back(normal);
            }
    }
    return std::cos(std::min(widest + 2.0 * largest_turn, std::numbers::pi));
}

// Any direction where the normals cancel.
Vec3 mean_direction(const Vec3& normal_area, double area) {
    constexpr double cancelled = 1e-9; // of the area
    return glm::length(normal_area) > cancelled * area ? glm::normalize(normal_area) : Vec3(0.0, 0.0, 1.0);
}

void set_bounds(ElementShape& shape) {
    const Extent extent = extent_of(shape);
    set_box(shape, extent);
    shape.centre = 0.5 * (shape.box_low + shape.box_high);
    for (const Vec3& point : extent.points)
        shape.radius = std::max(shape.radius, glm::distance(point, shape.centre) + extent.margin);
}

// Normals and planarity of the facets; those of a curved patch follow with its quadrature.
void set_normals(ElementShape& shape) {
    Vec3 mean(0.0);
    double area = 0.0;
    for (const Facet& facet : shape.facets) {
        mean += facet.area * facet.normal;
        area += facet.area;
    }
    shape.mean_normal = mean_direction(mean, area);
    for (const Facet& facet : shape.facets)
        shape.cone_cosine = std::min(shape.cone_cosine, glm::dot(facet.normal, shape.mean_normal));
    const Vec3 origin = shape.facets.front().corners[0];
    for (const Facet& facet : shape.facets)
        for (const Vec3& corner : facet.corners)
            if (std::abs(glm::dot(corner - origin, shape.mean_normal)) > planar_tolerance * shape.radius)
                shape.planar = false;
    shape.planar = shape.planar && shape.cone_cosine > 0.5 && !shape.surface;
}

std::vector<std::vector<Vec3>> outline_of(std::span<const Facet> facets) {
    std::vector<std::array<Vec3, 3>> triangles;
    for (const Facet& facet : facets) triangles.push_back(facet.corners);
    std::vector<std::vector<Vec3>> outline;
    for (const auto& loop : boundary_loops(triangles)) {
        std::vector<Vec3> points, turns;
        for (const TriangleCorner& at : loop) points.push_back(triangles[at.triangle][at.corner]);
        for (const std::size_t i : turning_points(points, 0.0)) turns.push_back(points[i]);
        if (turns.size() > 2) outline.push_back(turns);
    }
    return outline;
}

void set_quadrature(ElementShape& shape, int degree) {
    ElementQuadrature quadrature = element_quadrature(shape, degree);
    shape.area = quadrature.area;
    shape.basis = std::move(quadrature.basis);
    shape.rules = std::move(quadrature.rules);
    if (!shape.surface) return;
    shape.mean_normal = mean_direction(quadrature.normal_area, shape.area);
    shape.cone_cosine = curved_cone_cosine(shape);
}

} // namespace

Facet facet_of(const model::Surface& surface, const model::DomainTriangle& piece) {
    const auto& [a, b, c] = piece;
    Facet facet = make_facet({position(surface, a), position(surface, b), position(surface, c)}, piece);
    if (surface.orientation < 0.0) {
        std::swap(facet.corners[1], facet.corners[2]);
        std::swap(facet.parameters[1], facet.parameters[2]);
        facet.normal = -facet.normal;
    }
    return facet;
}

std::vector<ElementShape> element_shapes(const model::PatchSet& patches, const model::ClusterTree& tree,
                                         int degree, int cluster_degree) {
    std::vector<double> chord_heights;
    for (const model::Patch& patch : patches.patches) chord_heights.push_back(chord_height(patch));
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
        if (element.patch && is_curved(patches.patches[element.patch->value].surface)) {
            shape.surface = patches.patches[element.patch->value].surface;
            shape.chord_height = chord_heights[element.patch->value];
        }
        set_bounds(shape);
        set_normals(shape);
        if (shape.planar) shape.outline = outline_of(shape.facets);
        set_quadrature(shape, element.patch ? degree : cluster_degree);
    });
    return shapes;
}

ElementShape moved(const ElementShape& rest, const Pose& pose) {
    ElementShape shape = rest;
    for (Facet& facet : shape.facets) {
        for (Vec3& corner : facet.corners) corner = pose.point(corner);
        facet.normal = pose.direction(facet.normal);
    }
    for (std::vector<Vec3>& loop : shape.outline)
        for (Vec3& point : loop) point = pose.point(point);
    if (rest.surface) shape.surface = moved(*rest.surface, pose);
    for (NodeSet& set : shape.rules)
        for (SurfaceNode& node : set.nodes) {
            node.position = pose.point(node.position);
            node.normal = pose.direction(node.normal);
        }
    shape.mean_normal = pose.direction(rest.mean_normal);
    shape.centre = pose.point(rest.centre);
    set_box(shape, extent_of(shape));
    return shape;
}

SurfaceNode node_at(const ElementShape& element, const Facet& facet, const std::array<double, 3>& barycentric,
                    Vec2& parameter) {
    const auto& p = facet.parameters;
    parameter = barycentric[0] * p[0] + barycentric[1] * p[1] + barycentric[2] * p[2];
    if (!element.surface) {
        const auto& x = facet.corners;
        return {barycentric[0] * x[0] + barycentric[1] * x[1] + barycentric[2] * x[2], facet.normal,
                facet.area};
    }
    const SurfaceJet jet = evaluate(*element.surface, parameter);
    const Vec2 e1 = p[1] - p[0], e2 = p[2] - p[0];
    return {jet.position, jet.normal, 0.5 * jet.area_factor * std::abs(e1.x * e2.y - e1.y * e2.x),
            element.chord_height};
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
