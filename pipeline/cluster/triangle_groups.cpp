// SPDX-License-Identifier: GPL-3.0-or-later
#include "cluster/triangle_groups.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace kinelux::cluster {

namespace {

using Members = std::vector<std::uint32_t>;

// What the division looks at, one entry per small triangle.
struct Shapes {
    std::vector<Vec3> low, high, centroid;
    std::vector<Vec3> area_vector; // normal times area [m2]
    std::vector<Vec3> normal;      // unit; zero for a triangle without area
};

Shapes shapes_of(const model::SmallTriangles& small) {
    Shapes shapes;
    for (const model::Triangle& t : small.triangles) {
        const Vec3 a = small.points[t[0]], b = small.points[t[1]], c = small.points[t[2]];
        const Vec3 area_vector = 0.5 * glm::cross(b - a, c - a);
        const double area = glm::length(area_vector);
        shapes.low.push_back(glm::min(a, glm::min(b, c)));
        shapes.high.push_back(glm::max(a, glm::max(b, c)));
        shapes.centroid.push_back((a + b + c) / 3.0);
        shapes.area_vector.push_back(area_vector);
        shapes.normal.push_back(area > 0.0 ? area_vector / area : Vec3{0.0});
    }
    return shapes;
}

double angle_deg(const Vec3& a, const Vec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi;
}

// Largest angle between a member's normal and the mean normal; 180 if the normals cancel.
double normal_spread_deg(const Shapes& shapes, const Members& members) {
    Vec3 sum{0.0};
    double area = 0.0;
    for (const std::uint32_t t : members) {
        sum += shapes.area_vector[t];
        area += glm::length(shapes.area_vector[t]);
    }
    constexpr double cancelled = 1e-9;
    if (members.size() > 1 && glm::length(sum) <= cancelled * area) return 180.0;
    double spread = 0.0;
    for (const std::uint32_t t : members) {
        if (shapes.normal[t] != Vec3{0.0}) spread = std::max(spread, angle_deg(shapes.normal[t], sum));
    }
    return spread;
}

double largest_edge(const Shapes& shapes, const Members& members) {
    Vec3 low = shapes.low[members.front()], high = shapes.high[members.front()];
    for (const std::uint32_t t : members) {
        low = glm::min(low, shapes.low[t]);
        high = glm::max(high, shapes.high[t]);
    }
    const Vec3 size = high - low;
    return std::max({size.x, size.y, size.z});
}

// Divides by centroids across the longest edge of their bounds: in the middle, or, where all lie together, by number.
std::pair<Members, Members> divide_by_place(const Shapes& shapes, const Members& members) {
    Vec3 low = shapes.centroid[members.front()], high = low;
    for (const std::uint32_t t : members) {
        low = glm::min(low, shapes.centroid[t]);
        high = glm::max(high, shapes.centroid[t]);
    }
    const Vec3 size = high - low;
    int axis = 0;
    if (size.y > size[axis]) axis = 1;
    if (size.z > size[axis]) axis = 2;
    const double middle = 0.5 * (low[axis] + high[axis]);
    std::pair<Members, Members> parts;
    for (const std::uint32_t t : members) {
        (shapes.centroid[t][axis] < middle ? parts.first : parts.second).push_back(t);
    }
    if (parts.first.empty() || parts.second.empty()) {
        const auto half = members.begin() + static_cast<std::ptrdiff_t>(members.size() / 2);
        return {Members(members.begin(), half), Members(half, members.end())};
    }
    return parts;
}

// Divides by the nearer of two poles: the normal farthest from the first member's, and the normal farthest from that.
std::pair<Members, Members> divide_by_normal(const Shapes& shapes, const Members& members) {
    const auto farthest_from = [&](const Vec3& direction) {
        std::uint32_t best = members.front();
        for (const std::uint32_t t : members) {
            if (glm::dot(shapes.normal[t], direction) < glm::dot(shapes.normal[best], direction)) best = t;
        }
        return shapes.normal[best];
    };
    const Vec3 first_pole = farthest_from(shapes.normal[members.front()]);
    const Vec3 second_pole = farthest_from(first_pole);
    std::pair<Members, Members> parts;
    for (const std::uint32_t t : members) {
        const bool first = glm::dot(shapes.normal[t], first_pole) >= glm::dot(shapes.normal[t], second_pole);
        (first ? parts.first : parts.second).push_back(t);
    }
    if (parts.first.empty() || parts.second.empty()) return divide_by_place(shapes, members);
    return parts;
}

void divide(const Shapes& shapes, const ClusterOptions& options, const Members& all,
            std::vector<Members>& groups) {
    std::vector<Members> open{all};
    while (!open.empty()) {
        const Members members = std::move(open.back());
        open.pop_back();
        const bool too_large = largest_edge(shapes, members) > options.cluster_size;
        const bool too_bent = normal_spread_deg(shapes, members) > options.normal_spread_deg;
        if (members.size() == 1 || (!too_large && !too_bent)) {
            groups.push_back(members);
            continue;
        }
        auto [first, second] =
            too_large ? divide_by_place(shapes, members) : divide_by_normal(shapes, members);
        open.push_back(std::move(second));
        open.push_back(std::move(first));
    }
}

} // namespace

std::vector<model::Cluster> group_triangles(const model::SmallTriangles& small,
                                            const ClusterOptions& options) {
    const Shapes shapes = shapes_of(small);
    std::map<std::pair<ObjectId, MaterialId>, Members> by_kind;
    for (std::size_t t = 0; t < small.triangles.size(); ++t) {
        by_kind[{small.objects[t], small.materials[t]}].push_back(static_cast<std::uint32_t>(t));
    }
    std::vector<model::Cluster> clusters;
    for (const auto& [kind, members] : by_kind) {
        std::vector<Members> groups;
        divide(shapes, options, members, groups);
        for (Members& group : groups) {
            const double spread = normal_spread_deg(shapes, group);
            clusters.push_back({kind.first, kind.second, std::move(group), spread});
        }
    }
    return clusters;
}

} // namespace kinelux::cluster
