// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/sequence.h"
#include "reference/reference.h"
#include "reference/world.h"

namespace kinelux::reference {

namespace {

constexpr double shrink =
    1e-4; ///< towards the centroid: no sensor on an edge, where the side of a wall is ambiguous

enum Stream : std::uint64_t { OffsetStream, PlaceStream, SideStream };

constexpr double same_plane =
    1e-5; ///< of the size of all points: more than clean lifts a lamp or a moving panel out of the plane it lies in

bool covers(const WorldTriangle& triangle, const SensorPoint& point, double slack) {
    constexpr double parallel = 0.9999;
    if (triangle.object == point.object || !(triangle.area > 0.0)) return false;
    const double turned = glm::dot(triangle.normal, point.normal);
    if ((triangle.both_sides ? std::abs(turned) : turned) < parallel) return false;
    const Vec3 d = point.position - triangle.corner;
    if (std::abs(glm::dot(d, triangle.normal)) > slack) return false;
    const double v = glm::dot(glm::cross(triangle.edge1, d), triangle.normal) / (2.0 * triangle.area);
    const double u = glm::dot(glm::cross(d, triangle.edge2), triangle.normal) / (2.0 * triangle.area);
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0;
}

SensorPoint sensor_on(const WorldTriangle& triangle, std::uint32_t index, std::uint64_t seed) {
    const Vec3 centroid = triangle.corner + (triangle.edge1 + triangle.edge2) / 3.0;
    const Vec3 x = triangle.point(core::sobol_2d(index, core::mix(seed, PlaceStream)));
    SensorPoint point{triangle.object, triangle.triangle, x + shrink * (centroid - x), triangle.normal};
    if (triangle.both_sides && (core::mix(core::mix(seed, SideStream), index) & 1u) != 0)
        point.normal = -point.normal;
    return point;
}

// Takes out the points on which another object's triangle lies in the same plane and looks the same way.
void drop_covered(const World& world, std::vector<SensorPoint>& points) {
    std::vector<std::size_t> along_x(points.size());
    std::iota(along_x.begin(), along_x.end(), std::size_t{0});
    const auto x = [&](std::size_t p) { return points[p].position.x; };
    std::sort(along_x.begin(), along_x.end(), [&](std::size_t a, std::size_t b) { return x(a) < x(b); });
    Vec3 low(points.front().position), high(low);
    for (const SensorPoint& point : points) {
        low = glm::min(low, point.position);
        high = glm::max(high, point.position);
    }
    const double slack = same_plane * glm::length(high - low);
    std::vector<std::uint8_t> covered(points.size(), 0);
    for (const WorldTriangle& triangle : world.triangles) {
        const double left = triangle.corner.x + std::min({0.0, triangle.edge1.x, triangle.edge2.x}) - slack;
        const double right = triangle.corner.x + std::max({0.0, triangle.edge1.x, triangle.edge2.x}) + slack;
        auto next = std::lower_bound(along_x.begin(), along_x.end(), left,
                                     [&](std::size_t p, double value) { return x(p) < value; });
        for (; next != along_x.end() && x(*next) <= right; ++next)
            if (covers(triangle, points[*next], slack)) covered[*next] = 1;
    }
    std::size_t kept = 0;
    for (std::size_t p = 0; p < points.size(); ++p)
        if (covered[p] == 0) points[kept++] = points[p];
    points.resize(kept);
}

} // namespace

std::vector<SensorPoint> sensor_points(const model::Scene& scene, double time_s, std::uint32_t count,
                                       std::uint64_t seed) {
    const World world(scene, time_s);
    double total = 0.0;
    for (const WorldTriangle& triangle : world.triangles)
        if (!scene.materials[triangle.material.value].emits()) total += triangle.area;
    std::vector<SensorPoint> points;
    if (!(total > 0.0) || count == 0) return points;

    // Systematic sampling: equal steps along the area laid end to end, with one random offset for all.
    points.reserve(count);
    const double offset = core::Random(core::mix(seed, OffsetStream)).next();
    const double step = total / count;
    double before = 0.0;
    for (const WorldTriangle& triangle : world.triangles) {
        if (scene.materials[triangle.material.value].emits()) continue;
        before += triangle.area;
        while (points.size() < count && (static_cast<double>(points.size()) + offset) * step < before)
            points.push_back(sensor_on(triangle, static_cast<std::uint32_t>(points.size()), seed));
    }
    drop_covered(world, points);
    return points;
}

} // namespace kinelux::reference
