// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/rotation_series.h"

#include <cmath>
#include <numbers>

namespace kinelux::motion {

using geometry::SurfaceNode;

Vec3 turning_vector(const Vec3& r, const Vec3& n_i, const Vec3& n_j, Turning turning) {
    const double r2 = glm::dot(r, r);
    const Vec3& still = turning == Turning::Second ? n_i : n_j;
    return -glm::dot(still, r) / (std::numbers::pi * r2 * r2) * r;
}

std::vector<double> rotation_blocks(const PairNodes& nodes, Turning turning, bool planar) {
    return nodes.project(
        planar ? 3 : 9, [&](const SurfaceNode& x, const SurfaceNode& y, std::span<double> values) {
            const Vec3 k = turning_vector(y.position - x.position, x.normal, y.normal, turning);
            const Vec3& n = turning == Turning::Second ? y.normal : x.normal;
            for (int m = 0; m < static_cast<int>(values.size()); ++m)
                values[static_cast<std::size_t>(m)] = planar ? k[m] : n[m % 3] * k[m / 3];
        });
}

void add_rotation(std::span<const double> blocks, const Mat3& R, const Vec3& normal, double scale,
                  std::span<double> values) {
    const bool planar = blocks.size() == 3 * values.size();
    const Mat3 M = R - Mat3(1.0); // glm: M[column][row]
    const Vec3 turned = M * normal;
    for (int m = 0; m < (planar ? 3 : 9); ++m) {
        const double factor = scale * (planar ? turned[m] : M[m % 3][m / 3]);
        const std::size_t first = static_cast<std::size_t>(m) * values.size();
        for (std::size_t v = 0; v < values.size(); ++v) values[v] += factor * blocks[first + v];
    }
}

bool rotation_condition_printed(double r, double a, double angle, double S) {
    if (!(angle < 0.5 * std::numbers::pi)) return false;
    return std::sin(angle) < (r < 1.0 ? r * S / (4.0 * a) : S / (2.0 * a));
}

bool rotation_condition_scale_free(double r, double a, double angle, double S) {
    return 2.0 * a * std::abs(std::sin(0.5 * angle)) <= 0.5 * S * r;
}

} // namespace kinelux::motion
