// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/polygon_irradiance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace kinelux::kernel {

namespace {

// The part of a polygon above the receiver's horizon, as vectors from the receiver.
void clip_to_horizon(const Vec3& x, const Vec3& normal, std::span<const Vec3> corners,
                     std::vector<Vec3>& clipped) {
    clipped.clear();
    Vec3 previous = corners.back() - x;
    double previous_height = glm::dot(normal, previous);
    for (const Vec3& corner : corners) {
        const Vec3 current = corner - x;
        const double height = glm::dot(normal, current);
        if ((height > 0.0) != (previous_height > 0.0))
            clipped.push_back(previous +
                              (current - previous) * (previous_height / (previous_height - height)));
        if (height > 0.0) clipped.push_back(current);
        previous = current;
        previous_height = height;
    }
}

} // namespace

double point_to_polygon(const Vec3& x, const Vec3& normal, std::span<const Vec3> corners) {
    // Behind the polygon nothing arrives.
    const Vec3 front = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (!(glm::dot(front, x - corners[0]) > 0.0)) return 0.0;
    thread_local std::vector<Vec3> polygon;
    clip_to_horizon(x, normal, corners, polygon);
    if (polygon.size() < 3) return 0.0;

    // Lambert: the sum over the edges of the angle each subtends times the receiver's cosine to the edge's plane.
    double sum = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3& a = polygon[i];
        const Vec3& b = polygon[(i + 1) % polygon.size()];
        const Vec3 cross = glm::cross(b, a);
        const double sine = glm::length(cross);
        if (sine > 0.0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(normal, cross) / sine;
    }
    return std::clamp(sum / (2.0 * std::numbers::pi), 0.0, 1.0);
}

} // namespace kinelux::kernel
