// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/pair_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kinelux::motion {

namespace {

using geometry::ElementShape;

// Least signed distance of an element from the plane of a planar one, > 0 in front [m].
double lowest_point(const ElementShape& planar, const ElementShape& other) {
    const Vec3 normal = planar.facets.front().normal, origin = planar.facets.front().corners[0];
    const double of_sphere = glm::dot(other.centre - origin, normal) - other.radius;
    if (of_sphere > 0.0) return of_sphere;
    if (other.surface) {
        const Vec3 low = glm::min(normal * (other.box_low - origin), normal * (other.box_high - origin));
        return std::max(of_sphere, low.x + low.y + low.z);
    }
    double lowest = std::numeric_limits<double>::infinity();
    for (const geometry::Facet& facet : other.facets)
        for (const Vec3& corner : facet.corners) lowest = std::min(lowest, glm::dot(corner - origin, normal));
    return lowest;
}

// Whether all normals of a's cone make acute angles with all directions from a to b.
bool cone_faces(const ElementShape& a, const ElementShape& b) {
    const Vec3 axis = b.centre - a.centre;
    const double distance = glm::length(axis), radii = a.radius + b.radius;
    if (distance <= radii) return false;
    const double spread = std::asin(radii / distance) + std::acos(std::clamp(a.cone_cosine, -1.0, 1.0));
    return std::acos(std::clamp(glm::dot(a.mean_normal, axis) / distance, -1.0, 1.0)) + spread <
           0.5 * std::numbers::pi;
}

} // namespace

double least_distance(const ElementShape& a, const ElementShape& b) {
    const Vec3 gap = glm::max(glm::max(a.box_low - b.box_high, b.box_low - a.box_high), Vec3(0.0));
    double distance = std::max(glm::length(gap), glm::distance(a.centre, b.centre) - a.radius - b.radius);
    if (a.planar) distance = std::max(distance, lowest_point(a, b));
    if (b.planar) distance = std::max(distance, lowest_point(b, a));
    return std::max(distance, 0.0);
}

bool wholly_facing(const ElementShape& a, const ElementShape& b) {
    constexpr double rounding =
        1e-10; // of the smaller element: neighbours that meet at an edge face each other
    const double slack = rounding * std::min(a.radius, b.radius);
    return (a.planar ? lowest_point(a, b) >= -slack : cone_faces(a, b)) &&
           (b.planar ? lowest_point(b, a) >= -slack : cone_faces(b, a));
}

} // namespace kinelux::motion
