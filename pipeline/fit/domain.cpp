// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/domain.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace kinelux::fit {

namespace {

bool holds(const Chart& chart, std::uint32_t face) {
    return std::binary_search(chart.faces.begin(), chart.faces.end(), face);
}

// Any two axes that make a right-handed frame with the normal.
void choose_axes(const Vec3& normal, Vec3& axis_u, Vec3& axis_v) {
    const Vec3 size = glm::abs(normal);
    Vec3 other{1.0, 0.0, 0.0};
    if (size.x > 0.9) other = Vec3{0.0, 1.0, 0.0};
    axis_u = glm::normalize(glm::cross(other, normal));
    axis_v = glm::cross(normal, axis_u);
}

Vec2 quarter_turned(const Vec2& v, int quarters) {
    switch (quarters & 3) {
    case 1: return {v.y, -v.x};
    case 2: return {-v.x, -v.y};
    case 3: return {-v.y, v.x};
    default: return v;
    }
}

// The direction modulo a right angle that the most boundary length runs along: a histogram of one bin per degree.
Vec2 principal_direction(const std::vector<Vec2>& edges) {
    constexpr int bins = 90;
    std::vector<double> length(bins, 0.0);
    std::vector<Vec2> sum(bins, Vec2{0.0});
    for (const Vec2& edge : edges) {
        // Turned by quarters into (-45, 45] degrees from the u axis, so that a wall along u never straddles the ends.
        const double angle = std::atan2(edge.y, edge.x);
        const int quarters = static_cast<int>(std::lround(angle / (0.5 * std::numbers::pi)));
        const Vec2 turned = quarter_turned(edge, quarters);
        const double degrees = std::atan2(turned.y, turned.x) * 180.0 / std::numbers::pi;
        const int bin = static_cast<int>(std::lround(degrees + bins)) % bins;
        length[bin] += glm::length(edge);
        // A direction near 45 degrees comes from both ends of the range; the last bin takes the other end turned.
        sum[bin] += (bin == bins / 2 && turned.y < 0.0) ? quarter_turned(turned, 3) : turned;
    }
    const auto best = std::max_element(length.begin(), length.end()) - length.begin();
    return glm::normalize(sum[best]);
}

struct Bounds {
    Vec2 low{std::numeric_limits<double>::infinity()};
    Vec2 high{-std::numeric_limits<double>::infinity()};
};

Bounds bounds_of(const std::vector<Vec2>& points) {
    Bounds bounds;
    for (const Vec2& p : points) {
        bounds.low = glm::min(bounds.low, p);
        bounds.high = glm::max(bounds.high, p);
    }
    return bounds;
}

double twice_area(const std::vector<Vec2>& points, const model::Triangle& t) {
    const Vec2 ab = points[t[1]] - points[t[0]], ac = points[t[2]] - points[t[0]];
    return ab.x * ac.y - ab.y * ac.x;
}

// Turns the frame to the principal direction and moves its origin to the corner of the domain's bounds.
void align(const std::vector<Vec3>& corners, const std::vector<Edge>& boundary, model::Surface& surface) {
    const auto project = [&](const Vec3& x) {
        return Vec2{glm::dot(x - surface.origin, surface.axis_u),
                    glm::dot(x - surface.origin, surface.axis_v)};
    };
    std::vector<Vec2> edges;
    for (const Edge& edge : boundary) {
        const Vec2 run = project(corners[edge[1]]) - project(corners[edge[0]]);
        if (glm::length(run) > 0.0) edges.push_back(run);
    }
    if (!edges.empty()) {
        const Vec2 direction = principal_direction(edges);
        surface.axis_u = glm::normalize(direction.x * surface.axis_u + direction.y * surface.axis_v);
        surface.axis_v = glm::normalize(glm::cross(surface.axis_w, surface.axis_u));
    }
    std::vector<Vec2> points;
    points.reserve(corners.size());
    for (const Vec3& x : corners) points.push_back(project(x));
    Bounds bounds = bounds_of(points);
    const Vec2 size = bounds.high - bounds.low;
    constexpr double clearly = 1.0 + 1e-9;
    if (size.y > clearly * size.x) {
        const Vec3 old_u = surface.axis_u;
        surface.axis_u = surface.axis_v;
        surface.axis_v = -old_u;
        bounds = {{bounds.low.y, -bounds.high.x}, {bounds.high.y, -bounds.low.x}};
    }
    surface.origin += bounds.low.x * surface.axis_u + bounds.low.y * surface.axis_v;
}

} // namespace

std::vector<BoundaryEdge> boundary_edges(const Body& body, const Chart& chart) {
    std::vector<BoundaryEdge> edges;
    for (const std::uint32_t f : chart.faces) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            const auto others = body.across(f, k);
            const bool inner =
                std::any_of(others.begin(), others.end(), [&](std::uint32_t g) { return holds(chart, g); });
            if (!inner) edges.push_back({f, k});
        }
    }
    return edges;
}

FlatChart flatten(const Body& body, const Chart& chart) {
    FlatChart flat;
    std::vector<std::uint32_t> used;
    for (const std::uint32_t f : chart.faces) {
        used.insert(used.end(), body.faces[f].corners.begin(), body.faces[f].corners.end());
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto local = [&](std::uint32_t point) {
        return static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), point) - used.begin());
    };
    std::vector<Vec3> corners;
    corners.reserve(used.size());
    for (const std::uint32_t point : used) corners.push_back(body.points[point]);
    for (const std::uint32_t f : chart.faces) {
        const model::Triangle& t = body.faces[f].corners;
        flat.triangles.push_back({local(t[0]), local(t[1]), local(t[2])});
    }
    for (const BoundaryEdge& edge : boundary_edges(body, chart)) {
        const model::Triangle& t = body.faces[edge.face].corners;
        flat.boundary.push_back({local(t[edge.k]), local(t[(edge.k + 1) % 3])});
    }

    flat.surface.axis_w = chart.plane.normal;
    choose_axes(chart.plane.normal, flat.surface.axis_u, flat.surface.axis_v);
    flat.surface.origin = corners.front() - chart.plane.distance(corners.front()) * chart.plane.normal;
    align(corners, flat.boundary, flat.surface);
    for (const Vec3& x : corners) {
        const Vec3 offset = x - flat.surface.origin;
        flat.points.push_back({glm::dot(offset, flat.surface.axis_u), glm::dot(offset, flat.surface.axis_v)});
        flat.extent = glm::max(flat.extent, flat.points.back());
    }
    for (const model::Triangle& t : flat.triangles) flat.area += 0.5 * twice_area(flat.points, t);
    return flat;
}

} // namespace kinelux::fit
