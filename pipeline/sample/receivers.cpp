// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/receivers.h"

#include <algorithm>
#include <limits>

namespace kinelux::sample {

namespace {

constexpr double nudge =
    0.1; ///< of the way to the middle of the triangles around a point: past the gaps that fitting leaves
constexpr double bent = 1e-9; ///< 1 - cosine between a triangle and its point's normal, of 4.5e-5 rad
constexpr double least_cosine =
    0.1; ///< triangles seen more edge-on from their point's normal lift it no further

double squared_distance_to_edge(const Vec3& x, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a;
    const double length2 = glm::dot(along, along);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(x - a, along) / length2, 0.0, 1.0) : 0.0;
    const Vec3 way = a + t * along - x;
    return glm::dot(way, way);
}

double squared_distance(const Vec3& x, const geometry::Facet& facet) {
    double nearest = std::numeric_limits<double>::infinity();
    bool inside = true;
    for (std::size_t e = 0; e < 3; ++e) {
        const Vec3 &a = facet.corners[e], &b = facet.corners[(e + 1) % 3];
        inside = inside && glm::dot(glm::cross(b - a, x - a), facet.normal) >= 0.0;
        nearest = std::min(nearest, squared_distance_to_edge(x, a, b));
    }
    const double height = glm::dot(x - facet.corners[0], facet.normal);
    return inside ? height * height : nearest;
}

struct Plane {
    Vec3 point, normal;
};

// How far a receiver must go along its normal to stand this high above all planes.
double lift_above(std::span<const Plane> planes, const Receiver& receiver, double clearance) {
    double lift = 0.0;
    for (const Plane& plane : planes) {
        const double height = glm::dot(plane.normal, receiver.position - plane.point);
        lift = std::max(lift, (clearance - height) /
                                  std::max(glm::dot(plane.normal, receiver.normal), least_cosine));
    }
    return lift;
}

} // namespace

const geometry::Facet& facet_at(const geometry::ElementShape& element, const Vec3& x) {
    const auto better = [&](const geometry::Facet& a, const geometry::Facet& b) {
        return element.planar ? a.area > b.area : squared_distance(x, a) < squared_distance(x, b);
    };
    return *std::min_element(element.facets.begin(), element.facets.end(), better);
}

Receiver receiver_on(const model::DisplayMesh& mesh, std::span<const geometry::ElementShape> rest_elements,
                     const Vec3& x, const Vec3& normal, std::span<const std::uint32_t> around,
                     double clearance) {
    Receiver receiver{x, normal};
    if (around.empty()) return receiver;
    std::vector<Plane> planes;
    Vec3 middle(0.0);
    for (const std::uint32_t t : around) {
        const model::Triangle& c = mesh.triangles[t];
        const Vec3 a = mesh.points[c[0]], b = mesh.points[c[1]] - a, d = mesh.points[c[2]] - a;
        middle += a + (b + d) / 3.0;
        const Vec3 cross = glm::cross(b, d);
        if (glm::length(cross) > 0.0) planes.push_back({x, glm::normalize(cross)});
    }
    Receiver start{x + nudge * (middle / static_cast<double>(around.size()) - x), normal};
    receiver.ray_origin = start.position;
    const auto is_bent = [&](const Plane& plane) { return glm::dot(plane.normal, normal) < 1.0 - bent; };
    if (std::none_of(planes.begin(), planes.end(), is_bent)) return receiver;
    double chords = 0.0;
    for (const std::uint32_t t : around) {
        const geometry::ElementShape& element = rest_elements[mesh.elements[t].value];
        chords = std::max(chords, element.chord_height);
        if (element.surface) continue;
        const geometry::Facet& facet = facet_at(element, start.position);
        planes.push_back({facet.corners[0], facet.normal});
    }
    receiver.ray_origin = start.position + (chords + lift_above(planes, start, clearance)) * normal;
    return receiver;
}

Receiver moved(const Receiver& rest, const geometry::Pose& pose) {
    return {pose.point(rest.position), pose.direction(rest.normal),
            pose.point(rest.ray_origin.value_or(rest.position))};
}

std::vector<geometry::ElementShape> moved_sources(std::span<const geometry::ElementShape> rest_elements,
                                                  const model::Scene& scene,
                                                  std::span<const geometry::Pose> poses) {
    std::vector<geometry::ElementShape> sources;
    for (const geometry::ElementShape& element : rest_elements)
        if (scene.materials[element.material.value].emits())
            sources.push_back(geometry::moved(element, poses[element.object.value]));
    return sources;
}

} // namespace kinelux::sample
