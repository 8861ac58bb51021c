// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "core/sequence.h"
#include "geometry/pose.h"
#include "visibility/visible_polygon.h"

namespace kinelux::test {

using Polygon = std::vector<Vec3>;

/// A rectangle at `corner`, facing edge_u x edge_v.
inline Polygon rectangle(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v) {
    return {corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v};
}

/// The square [-half, half]^2 about (x, y) at height z, facing up.
inline Polygon square(double half, double z, double x = 0.0, double y = 0.0) {
    return rectangle({x - half, y - half, z}, {2.0 * half, 0.0, 0.0}, {0.0, 2.0 * half, 0.0});
}

inline Polygon reversed(Polygon polygon) { return {polygon.rbegin(), polygon.rend()}; }

inline Vec3 normal_of(const Polygon& polygon) {
    return glm::normalize(visibility::twice_vector_area(polygon));
}

/// A convex polygon of 3 to 7 corners on an ellipse in a random plane.
inline Polygon random_polygon(core::Random& random, double size) {
    const auto signed_unit = [&] { return 2.0 * random.next() - 1.0; };
    Vec3 u(signed_unit(), signed_unit(), signed_unit()), v(signed_unit(), signed_unit(), signed_unit());
    const Vec3 centre(signed_unit(), signed_unit(), signed_unit());
    const auto corners = 3 + static_cast<std::size_t>(5.0 * random.next());
    Polygon polygon;
    for (std::size_t i = 0; i < corners; ++i) {
        const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.8 * random.next()) /
                             static_cast<double>(corners);
        polygon.push_back(centre + size * (std::cos(angle) * u + std::sin(angle) * v));
    }
    return polygon;
}

/// A random point of a convex polygon.
inline Vec3 point_in(const Polygon& polygon, core::Random& random) {
    Vec3 sum(0.0);
    double weights = 0.0;
    for (const Vec3& p : polygon) {
        const double weight = -std::log(1.0 - random.next());
        sum += weight * p;
        weights += weight;
    }
    return sum / weights;
}

/// A rigid motion after a scaling.
struct Similarity {
    double scale = 1.0;
    geometry::Pose pose;

    Vec3 operator()(const Vec3& x) const { return pose.point(scale * x); }
    Polygon operator()(Polygon polygon) const {
        for (Vec3& p : polygon) p = (*this)(p);
        return polygon;
    }
};

/// Turned, small, large, and far away: 1e4 sizes from the origin.
inline std::vector<Similarity> similarities() {
    const geometry::Pose turn{glm::angleAxis(0.9, glm::normalize(Vec3(1.0, -2.0, 0.7))), {0.3, -0.2, 0.6}};
    std::vector<Similarity> all{{1.0, turn}, {1e-3, turn}, {1e3, turn}};
    all.push_back({1.0, {turn.rotation, {1e4, -1e4, 1e4}}});
    return all;
}

} // namespace kinelux::test
