// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/segment_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace kinelux::fit {

namespace {

double cross_product(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

// Where along a-b, in [0, 1], the foot of p lies, if p is nearer to the segment than the tolerance.
std::optional<double> foot(const Vec2& a, const Vec2& b, const Vec2& p, double tolerance) {
    const Vec2 low = glm::min(a, b) - tolerance, high = glm::max(a, b) + tolerance;
    if (p.x < low.x || p.y < low.y || p.x > high.x || p.y > high.y) return std::nullopt;
    const Vec2 run = b - a;
    const double square = glm::dot(run, run);
    if (!(square > 0.0)) return std::nullopt;
    const double t = std::clamp(glm::dot(p - a, run) / square, 0.0, 1.0);
    if (glm::distance(a + t * run, p) > tolerance) return std::nullopt;
    return t;
}

bool boxes_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    const Vec2 low = glm::max(glm::min(a, b), glm::min(c, d));
    const Vec2 high = glm::min(glm::max(a, b), glm::max(c, d));
    return low.x <= high.x && low.y <= high.y;
}

} // namespace

SegmentMap::SegmentMap(std::vector<Vec2> points, std::vector<Edge> boundary, double tolerance)
    : points_(std::move(points)), boundary_(std::move(boundary)), tolerance_(tolerance) {}

// If p lies on an edge, the edge is divided at p's foot, which is `point` then.
bool SegmentMap::divide_near(std::vector<Edge>& edges, const Vec2& p, std::uint32_t& point) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const Edge edge = edges[i];
        const std::optional<double> t = foot(points_[edge[0]], points_[edge[1]], p, tolerance_);
        if (!t) continue;
        point = static_cast<std::uint32_t>(points_.size());
        points_.push_back(points_[edge[0]] + *t * (points_[edge[1]] - points_[edge[0]]));
        edges[i] = {edge[0], point};
        edges.push_back({point, edge[1]});
        return true;
    }
    return false;
}

// The point of the map that p becomes: one that is there already, a new one on an edge, or a new one.
std::uint32_t SegmentMap::place(const Vec2& p) {
    std::optional<std::uint32_t> nearest;
    double nearest_distance = tolerance_;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        if (std::abs(points_[i].x - p.x) > tolerance_) continue;
        const double distance = glm::distance(points_[i], p);
        if (distance > nearest_distance) continue;
        if (nearest && distance == nearest_distance) continue;
        nearest = static_cast<std::uint32_t>(i);
        nearest_distance = distance;
    }
    if (nearest) return *nearest;
    std::uint32_t point = 0;
    if (divide_near(boundary_, p, point) || divide_near(cuts_, p, point)) return point;
    points_.push_back(p);
    return static_cast<std::uint32_t>(points_.size() - 1);
}

// Divides every edge that a-b crosses between its ends and collects the crossings.
void SegmentMap::cross(std::vector<Edge>& edges, std::uint32_t a, std::uint32_t b,
                       std::vector<std::uint32_t>& stops) {
    const std::size_t count = edges.size();
    for (std::size_t i = 0; i < count; ++i) {
        const Edge edge = edges[i];
        if (edge[0] == a || edge[0] == b || edge[1] == a || edge[1] == b) continue;
        const Vec2 p = points_[a], q = points_[b], c = points_[edge[0]], d = points_[edge[1]];
        if (!boxes_meet(p, q, c, d)) continue;
        const double side_c = cross_product(q - p, c - p), side_d = cross_product(q - p, d - p);
        const double side_p = cross_product(d - c, p - c), side_q = cross_product(d - c, q - c);
        if (side_c * side_d >= 0.0 || side_p * side_q >= 0.0) continue;
        const Vec2 x = c + (side_c / (side_c - side_d)) * (d - c);
        // A crossing next to an end of the edge is at that end; it is found again among the points near a-b.
        if (glm::distance(x, c) <= tolerance_ || glm::distance(x, d) <= tolerance_) continue;
        const std::uint32_t point = static_cast<std::uint32_t>(points_.size());
        points_.push_back(x);
        edges[i] = {edge[0], point};
        edges.push_back({point, edge[1]});
        stops.push_back(point);
    }
}

void SegmentMap::add_piece(std::uint32_t a, std::uint32_t b) {
    const auto same = [&](const Edge& e) { return (e[0] == a && e[1] == b) || (e[0] == b && e[1] == a); };
    if (a == b || std::any_of(boundary_.begin(), boundary_.end(), same)) return;
    if (std::any_of(cuts_.begin(), cuts_.end(), same)) return;
    cuts_.push_back({a, b});
}

void SegmentMap::insert(const Vec2& a, const Vec2& b) {
    const std::uint32_t from = place(a), to = place(b);
    if (from == to) return;
    std::vector<std::uint32_t> stops;
    cross(boundary_, from, to, stops);
    cross(cuts_, from, to, stops);
    const Vec2 start = points_[from], end = points_[to];
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const std::uint32_t point = static_cast<std::uint32_t>(i);
        if (point != from && point != to && foot(start, end, points_[i], tolerance_)) stops.push_back(point);
    }
    std::sort(stops.begin(), stops.end(), [&](std::uint32_t p, std::uint32_t q) {
        const double along_p = glm::dot(points_[p] - start, end - start);
        const double along_q = glm::dot(points_[q] - start, end - start);
        return along_p != along_q ? along_p < along_q : p < q;
    });
    stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
    stops.push_back(to);
    std::uint32_t last = from;
    for (const std::uint32_t stop : stops) {
        add_piece(last, stop);
        last = stop;
    }
}

} // namespace kinelux::fit
