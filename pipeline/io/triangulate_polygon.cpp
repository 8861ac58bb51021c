// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "io/mesh_import.h"

namespace kinelux::io {

namespace {

// Polygons with more corners take the first ear found instead of the best shaped one, which costs n^3.
constexpr std::size_t most_corners_for_best_ear = 64;

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

// Newell's normal: twice the area vector, whatever the first corners look like.
Vec3 area_vector(const std::vector<Vec3>& corners) {
    Vec3 sum{0.0};
    const Vec3& origin = corners.front();
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        sum += glm::cross(corners[i] - origin, corners[i + 1] - origin);
    return sum;
}

// The corners in a plane seen from the polygon's front: drops the axis the normal is longest along.
std::vector<Vec2> flattened(const std::vector<Vec3>& corners, const Vec3& normal) {
    const Vec3 size = glm::abs(normal);
    const int drop = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const int first = (drop + 1) % 3, second = (drop + 2) % 3;
    std::vector<Vec2> points;
    points.reserve(corners.size());
    for (const Vec3& corner : corners) {
        const Vec3 relative = corner - corners.front();
        points.emplace_back(normal[drop] >= 0.0 ? Vec2(relative[first], relative[second])
                                                : Vec2(relative[second], relative[first]));
    }
    return points;
}

class EarClipper {
public:
    explicit EarClipper(std::vector<Vec2> points) : points_(std::move(points)) {
        for (std::uint32_t i = 0; i < points_.size(); ++i) ring_.push_back(i);
    }

    std::vector<model::Triangle> run() {
        std::vector<model::Triangle> triangles;
        while (ring_.size() > 3) {
            const std::size_t k = next_ear();
            triangles.push_back(triangle_at(k));
            ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(k));
        }
        triangles.push_back({ring_[0], ring_[1], ring_[2]});
        return triangles;
    }

private:
    model::Triangle triangle_at(std::size_t k) const {
        const std::size_t n = ring_.size();
        return {ring_[(k + n - 1) % n], ring_[k], ring_[(k + 1) % n]};
    }

    double doubled_area(const model::Triangle& t) const {
        return cross(points_[t[1]] - points_[t[0]], points_[t[2]] - points_[t[0]]);
    }

    // Twice the area over the longest edge squared: 0 for a sliver, 0.87 for an equilateral triangle.
    double quality(const model::Triangle& t) const {
        double longest = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec2 edge = points_[t[(i + 1) % 3]] - points_[t[i]];
            longest = std::max(longest, glm::dot(edge, edge));
        }
        return longest > 0.0 ? doubled_area(t) / longest : 0.0;
    }

    // Whether no other corner lies in the triangle; corners at its own corners (bridges to holes) do not count.
    bool is_empty(const model::Triangle& t) const {
        const Vec2 &a = points_[t[0]], &b = points_[t[1]], &c = points_[t[2]];
        return std::none_of(ring_.begin(), ring_.end(), [&](std::uint32_t i) {
            const Vec2& p = points_[i];
            if (p == a || p == b || p == c) return false;
            return cross(b - a, p - a) >= 0.0 && cross(c - b, p - b) >= 0.0 && cross(a - c, p - c) >= 0.0;
        });
    }

    // The best shaped ear; else a corner whose triangle has no area; else, where edges cross, the most convex corner.
    std::size_t next_ear() const {
        std::size_t ear = ring_.size(), flat = ring_.size(), convex = 0;
        double best = 0.0, most = -std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < ring_.size(); ++k) {
            const model::Triangle t = triangle_at(k);
            const double shape = quality(t);
            if (shape > most) {
                most = shape;
                convex = k;
            }
            if (doubled_area(t) == 0.0) flat = k;
            if (shape <= best || !is_empty(t)) continue;
            best = shape;
            ear = k;
            if (ring_.size() > most_corners_for_best_ear) break;
        }
        if (ear < ring_.size()) return ear;
        return flat < ring_.size() ? flat : convex;
    }

    std::vector<Vec2> points_;
    std::vector<std::uint32_t> ring_;
};

} // namespace

std::vector<model::Triangle> triangulate_polygon(const std::vector<Vec3>& corners) {
    if (corners.size() == 3) return {{0, 1, 2}};
    return EarClipper(flattened(corners, area_vector(corners))).run();
}

} // namespace kinelux::io
