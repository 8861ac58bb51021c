// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/exported.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"

namespace kinelux::reference {

namespace {

constexpr std::size_t leaf_size = 4; ///< triangles

struct Box {
    Vec3 low{std::numeric_limits<double>::infinity()};
    Vec3 high{-std::numeric_limits<double>::infinity()};
    void add(const Vec3& x) {
        low = glm::min(low, x);
        high = glm::max(high, x);
    }
    double squared_distance(const Vec3& x) const {
        const Vec3 d = glm::max(glm::max(low - x, x - high), Vec3(0.0));
        return glm::dot(d, d);
    }
};

using Barycentric = std::array<double, 3>;

Barycentric on_edge(const Vec3& x, const std::array<Vec3, 3>& corners, std::size_t edge) {
    const std::size_t next = (edge + 1) % 3;
    const Vec3 along = corners[next] - corners[edge];
    const double length2 = glm::dot(along, along);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(x - corners[edge], along) / length2, 0.0, 1.0) : 0.0;
    Barycentric result{0.0, 0.0, 0.0};
    result[edge] = 1.0 - t;
    result[next] = t;
    return result;
}

Vec3 position(const Barycentric& b, const std::array<Vec3, 3>& corners) {
    return b[0] * corners[0] + b[1] * corners[1] + b[2] * corners[2];
}

// The point of a triangle nearest to x: its foot if that lies inside, else the nearest point of the three edges.
Barycentric nearest_point(const Vec3& x, const std::array<Vec3, 3>& corners) {
    const Vec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0], d = x - corners[0];
    const Vec3 cross = glm::cross(e1, e2);
    const double area2 = glm::dot(cross, cross);
    if (area2 > 0.0) {
        const double b1 = glm::dot(glm::cross(d, e2), cross) / area2;
        const double b2 = glm::dot(glm::cross(e1, d), cross) / area2;
        if (b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0) return {1.0 - b1 - b2, b1, b2};
    }
    Barycentric best{};
    double best2 = std::numeric_limits<double>::infinity();
    for (std::size_t edge = 0; edge < 3; ++edge) {
        const Barycentric b = on_edge(x, corners, edge);
        const Vec3 way = position(b, corners) - x;
        if (glm::dot(way, way) < best2) {
            best2 = glm::dot(way, way);
            best = b;
        }
    }
    return best;
}

/// A tree of boxes over the triangles; asks for the nearest one that fits.
class TriangleTree {
public:
    explicit TriangleTree(const ExportedField& field) : field_(field), order_(field.triangles.size()) {
        std::iota(order_.begin(), order_.end(), std::uint32_t{0});
        for (std::uint32_t t = 0; t < order_.size(); ++t) {
            const std::array<Vec3, 3> p = corners(t);
            centroids_.push_back((p[0] + p[1] + p[2]) / 3.0);
            const Vec3 cross = glm::cross(p[1] - p[0], p[2] - p[0]);
            const double length = glm::length(cross);
            normals_.push_back(length > 0.0 ? cross / length : Vec3(0.0));
        }
        if (!order_.empty()) build(0, order_.size());
    }

    double extent() const {
        return nodes_.empty() ? 0.0 : glm::length(nodes_[0].box.high - nodes_[0].box.low);
    }

    struct Found {
        std::uint32_t triangle = 0;
        Barycentric barycentric{};
        double squared_distance = 0.0;
    };
    std::optional<Found> nearest(const SensorPoint& sensor, double reach, double min_cosine) const {
        std::optional<Found> best;
        double limit = reach * reach;
        std::vector<std::uint32_t> open;
        if (!nodes_.empty()) open.push_back(0);
        while (!open.empty()) {
            const Node& node = nodes_[open.back()];
            open.pop_back();
            if (node.box.squared_distance(sensor.position) > limit) continue;
            if (node.children[0] != 0) {
                const bool swap = nodes_[node.children[0]].box.squared_distance(sensor.position) <
                                  nodes_[node.children[1]].box.squared_distance(sensor.position);
                open.push_back(node.children[swap ? 1 : 0]); // the nearer one is looked at first
                open.push_back(node.children[swap ? 0 : 1]);
                continue;
            }
            for (std::size_t i = node.first; i < node.last; ++i)
                if (const auto found = fit(order_[i], sensor, min_cosine);
                    found && found->squared_distance <= limit) {
                    // Of equally near ones the first in the file counts.
                    if (!best || found->squared_distance < limit || found->triangle < best->triangle)
                        best = found;
                    limit = best->squared_distance;
                }
        }
        return best;
    }

private:
    struct Node {
        Box box;
        std::array<std::uint32_t, 2> children{0, 0}; ///< 0: a leaf
        std::size_t first = 0, last = 0;             ///< of order_
    };

    std::array<Vec3, 3> corners(std::uint32_t t) const {
        const model::Triangle& triangle = field_.triangles[t];
        return {field_.points[triangle[0]], field_.points[triangle[1]], field_.points[triangle[2]]};
    }

    std::optional<Found> fit(std::uint32_t t, const SensorPoint& sensor, double min_cosine) const {
        if (field_.objects[t] != sensor.object.value || glm::dot(normals_[t], sensor.normal) < min_cosine)
            return std::nullopt;
        const std::array<Vec3, 3> p = corners(t);
        Found found{t, nearest_point(sensor.position, p), 0.0};
        const Vec3 way = position(found.barycentric, p) - sensor.position;
        found.squared_distance = glm::dot(way, way);
        return found;
    }

    std::uint32_t build(std::size_t first, std::size_t last) {
        const auto index = static_cast<std::uint32_t>(nodes_.size());
        nodes_.emplace_back();
        Box box, centres;
        for (std::size_t i = first; i < last; ++i) {
            for (const Vec3& corner : corners(order_[i])) box.add(corner);
            centres.add(centroids_[order_[i]]);
        }
        nodes_[index].box = box;
        nodes_[index].first = first;
        nodes_[index].last = last;
        if (last - first <= leaf_size) return index;
        const Vec3 size = centres.high - centres.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::size_t middle = (first + last) / 2;
        std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(first),
                         order_.begin() + static_cast<std::ptrdiff_t>(middle),
                         order_.begin() + static_cast<std::ptrdiff_t>(last),
                         [&](std::uint32_t a, std::uint32_t b) {
                             return std::pair(centroids_[a][axis], a) < std::pair(centroids_[b][axis], b);
                         });
        const std::uint32_t left = build(first, middle);
        const std::uint32_t right = build(middle, last);
        nodes_[index].children = {left, right};
        return index;
    }

    const ExportedField& field_;
    std::vector<std::uint32_t> order_;
    std::vector<Vec3> centroids_, normals_;
    std::vector<Node> nodes_;
};

void require_fitting(const ExportedField& field) {
    if (field.objects.size() != field.triangles.size() || field.components == 0 ||
        field.values.size() != field.points.size() * field.components)
        throw core::GeometryError("the exported field's sizes do not fit each other: export the frame again");
    for (const model::Triangle& triangle : field.triangles)
        for (const std::uint32_t corner : triangle)
            if (corner >= field.points.size())
                throw core::GeometryError(
                    "the exported field has a triangle whose corner does not exist: export the "
                    "frame again");
}

} // namespace

std::vector<std::optional<std::vector<double>>>
values_at(const ExportedField& field, std::span<const SensorPoint> sensors, const MatchOptions& options) {
    require_fitting(field);
    const TriangleTree tree(field);
    std::vector<std::optional<std::vector<double>>> values(sensors.size());
    core::parallel_for(sensors.size(), [&](std::size_t i) {
        const auto found = tree.nearest(sensors[i], options.tolerance * tree.extent(), options.min_cosine);
        if (!found) return;
        std::vector<double> value(field.components, 0.0);
        for (std::size_t corner = 0; corner < 3; ++corner)
            for (std::size_t c = 0; c < field.components; ++c)
                value[c] +=
                    found->barycentric[corner] *
                    static_cast<double>(
                        field.values[field.triangles[found->triangle][corner] * field.components + c]);
        values[i] = std::move(value);
    });
    return values;
}

} // namespace kinelux::reference
