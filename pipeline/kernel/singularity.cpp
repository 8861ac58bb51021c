// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/singularity.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

namespace kinelux::kernel {

namespace {

void consider(const std::complex<double>& z, double distance, Singularity& nearest) {
    const std::complex<double> x = 2.0 * z - 1.0;
    const std::complex<double> root = std::sqrt(x * x - 1.0);
    const double rate = std::max(std::abs(x + root), std::abs(x - root));
    if (clearly * rate < nearest.rate) nearest = {rate, std::clamp(z.real(), 0.0, 1.0), distance, z.imag()};
}

// |r0 + z d| = 0
void consider_corner(const Vec3& r0, const Vec3& d, Singularity& nearest) {
    const double d2 = glm::dot(d, d);
    if (!(d2 > 0.0)) return;
    const double real = -glm::dot(r0, d) / d2;
    const double distance = glm::length(r0 + real * d);
    consider({real, distance / std::sqrt(d2)}, distance, nearest);
}

// The distance from the line of the edge is 0, abreast of the edge itself.
void consider_edge(const Vec3& r0, const Vec3& d, const Vec3& edge, Singularity& nearest) {
    constexpr double parallel = 1e-12;
    const double length2 = glm::dot(edge, edge);
    if (!(length2 > 0.0)) return;
    const Vec3 r_across = r0 - glm::dot(r0, edge) / length2 * edge,
               d_across = d - glm::dot(d, edge) / length2 * edge;
    const double d2 = glm::dot(d_across, d_across);
    if (d2 <= parallel * glm::dot(d, d)) return;
    const double real = -glm::dot(r_across, d_across) / d2;
    const double abreast = glm::dot(r0 + real * d, edge) / length2;
    if (abreast < 0.0 || abreast > 1.0) return;
    const double distance = glm::length(r_across + real * d_across);
    consider({real, distance / std::sqrt(d2)}, distance, nearest);
}

void consider_plane(const InnerPolygon& polygon, const Vec3& a, const Vec3& d, Singularity& nearest) {
    const double h0 = glm::dot(polygon.normal, a - polygon.origin), slope = glm::dot(polygon.normal, d);
    if (std::abs(slope) > 0.0) consider({-h0 / slope, 0.0}, 0.0, nearest);
}

} // namespace

void foretell_along(const InnerPolygon& polygon, const Vec3& a, const Vec3& b, Singularity& nearest) {
    const Vec3 d = b - a;
    for (std::size_t l = 0; l < polygon.loops.size(); ++l) {
        const std::span<const Vec3> loop = polygon.loops[l];
        for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
            consider_corner(a - loop[j], d, nearest);
            consider_edge(a - loop[j], d, loop[i] - loop[j], nearest);
        }
    }
    consider_plane(polygon, a, d, nearest);
}

} // namespace kinelux::kernel
