// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/sequence.h"
#include "reference/reference.h"
#include "reference/world.h"

namespace kinelux::reference {

namespace {

constexpr double shrink =
    1e-4; ///< towards the centroid: no sensor on an edge, where the side of a wall is ambiguous

enum Stream : std::uint64_t { OffsetStream, PlaceStream, SideStream };

SensorPoint sensor_on(const WorldTriangle& triangle, std::uint32_t index, std::uint64_t seed) {
    const Vec3 centroid = triangle.corner + (triangle.edge1 + triangle.edge2) / 3.0;
    const Vec3 x = triangle.point(core::sobol_2d(index, core::mix(seed, PlaceStream)));
    SensorPoint point{triangle.object, triangle.triangle, x + shrink * (centroid - x), triangle.normal};
    if (triangle.both_sides && (core::mix(core::mix(seed, SideStream), index) & 1u) != 0)
        point.normal = -point.normal;
    return point;
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
    return points;
}

} // namespace kinelux::reference
