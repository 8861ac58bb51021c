// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/facet_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "geometry/surface.h"

namespace kinelux::geometry {

namespace {

constexpr int samples = 4;        ///< per edge of a facet, to start from
constexpr int most_steps = 30;    ///< of an iteration
constexpr double settled = 1e-15; ///< step at which an iteration ends [1, of the facet]

bool inside(const Vec2& local) { return local.x >= 0.0 && local.y >= 0.0 && local.x + local.y <= 1.0; }

// The step that takes the tangent plane's point nearest to the offset; zero where the tangents are parallel.
Vec2 tangent_step(const FacetSurface::Point& p, const Vec3& offset) {
    const double ss = glm::dot(p.along_s, p.along_s), st = glm::dot(p.along_s, p.along_t),
                 tt = glm::dot(p.along_t, p.along_t);
    const double determinant = ss * tt - st * st;
    if (!(determinant > 0.0)) return Vec2(0.0);
    const double s = glm::dot(p.along_s, offset), t = glm::dot(p.along_t, offset);
    return Vec2(tt * s - st * t, ss * t - st * s) / determinant;
}

} // namespace

FacetSurface::Point FacetSurface::at(const Vec2& local) const {
    const auto& [x, p, normal, area] = *facet_;
    const Vec2 p_s = p[1] - p[0], p_t = p[2] - p[0];
    Point point;
    point.parameter = p[0] + local.x * p_s + local.y * p_t;
    if (!element_->surface) {
        point.along_s = x[1] - x[0];
        point.along_t = x[2] - x[0];
        point.position = x[0] + local.x * point.along_s + local.y * point.along_t;
    } else {
        const SurfaceTangents tangents = surface_tangents(*element_->surface, point.parameter);
        point.position = tangents.position;
        point.along_s = p_s.x * tangents.along_u + p_s.y * tangents.along_v;
        point.along_t = p_t.x * tangents.along_u + p_t.y * tangents.along_v;
    }
    // Corners run counter-clockwise seen from the front.
    point.area_normal = glm::cross(point.along_s, point.along_t);
    return point;
}

double FacetSurface::distance2(const Vec3& x, const Vec2& local) const {
    const Vec3 offset = at(local).position - x;
    return glm::dot(offset, offset);
}

Vec2 FacetSurface::nearest_sample(const Vec3& x) const {
    Vec2 best(0.0);
    double best_distance2 = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= samples; ++i)
        for (int j = 0; i + j <= samples; ++j) {
            const Vec2 local = Vec2(i, j) / static_cast<double>(samples);
            const double d2 = distance2(x, local);
            if (d2 < best_distance2) {
                best = local;
                best_distance2 = d2;
            }
        }
    return best;
}

Vec2 FacetSurface::nearest_on_edge(const Vec3& x, const Vec2& from, const Vec2& to, double start) const {
    double t = std::clamp(start, 0.0, 1.0);
    for (int step = 0; step < most_steps; ++step) {
        const Point point = at(glm::mix(from, to, t));
        const Vec3 along = (to.x - from.x) * point.along_s + (to.y - from.y) * point.along_t;
        const double speed2 = glm::dot(along, along);
        if (!(speed2 > 0.0)) break;
        const double next = std::clamp(t + glm::dot(along, x - point.position) / speed2, 0.0, 1.0);
        const double change = std::abs(next - t);
        t = next;
        if (change <= settled) break;
    }
    return glm::mix(from, to, t);
}

Vec2 FacetSurface::nearest(const Vec3& x) const {
    // Freely first: the point may lie beyond the edges, though not far.
    Vec2 best = nearest_sample(x), free = best;
    for (int step = 0; step < most_steps; ++step) {
        const Point point = at(free);
        Vec2 change = tangent_step(point, x - point.position);
        const double length = glm::length(change);
        if (length > 0.5) change *= 0.5 / length;
        free += change;
        if (length <= settled || std::abs(free.x) > 2.0 || std::abs(free.y) > 2.0) break;
    }
    const double free_distance2 = distance2(x, free);
    if (inside(free) && free_distance2 <= distance2(x, best)) return free;

    const std::array<Vec2, 3> corners{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
    for (std::size_t c = 0; c < 3; ++c) {
        const Vec2& from = corners[c];
        const Vec2 way = corners[(c + 1) % 3] - from;
        for (const Vec2& start : {free, best}) {
            const Vec2 candidate =
                nearest_on_edge(x, from, from + way, glm::dot(start - from, way) / glm::dot(way, way));
            if (distance2(x, candidate) < distance2(x, best)) best = candidate;
        }
    }
    return best;
}

} // namespace kinelux::geometry
