// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/shaft.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace kinelux::visibility {

namespace {

// Of the shaft's size. Coordinates that lie ten thousand sizes from the origin are rounded by 1e-12 of the size, and a
// few operations add to it; a blocker that reaches in by a billionth hides about as little.
constexpr double relative_touch = 1e-9;

// Turns below this, of the hull's size squared, are rounding: the point between is left out of the hull.
constexpr double straight = 1e-13;

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

// Any two unit vectors that make a right-handed frame with the normal.
std::pair<Vec3, Vec3> plane_axes(const Vec3& normal) {
    const Vec3 side = std::abs(normal.x) < 0.6 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
    const Vec3 u = glm::normalize(glm::cross(side, normal));
    return {u, glm::cross(normal, u)};
}

// Andrew's monotone chain; counter-clockwise, without points between others on a line.
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
    std::sort(points.begin(), points.end(),
              [](const Vec2& a, const Vec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    const Vec2 extent = points.back() - points.front();
    const double least_turn = straight * glm::dot(extent, extent);
    std::vector<Vec2> hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t first = hull.size();
        for (const Vec2& p : points) {
            while (hull.size() > first + 1 &&
                   cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= least_turn)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

// Whether few points are the corners of a convex polygon in order: the usual outline, for which no hull has to be made.
bool is_its_hull(std::span<const Vec3> points, const Vec3& normal, const Vec3& extent) {
    if (points.size() < 3 || points.size() > ShaftEnd::most_points) return false;
    const double least_turn = straight * glm::dot(extent, extent);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t next = i + 1 < points.size() ? i + 1 : 0;
        const Vec3 inwards = glm::cross(normal, points[next] - points[i]);
        for (std::size_t j = 0; j < points.size(); ++j)
            if (j != i && j != next && !(glm::dot(inwards, points[j] - points[i]) > least_turn)) return false;
    }
    return true;
}

// The rectangle along the hull's longest edge.
std::vector<Vec2> rectangle_around(const std::vector<Vec2>& hull) {
    Vec2 axis(0.0);
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vec2 edge = hull[(i + 1) % hull.size()] - hull[i];
        if (glm::dot(edge, edge) > glm::dot(axis, axis)) axis = edge;
    }
    axis = glm::normalize(axis);
    const Vec2 across(-axis.y, axis.x);
    Vec2 low(INFINITY), high(-INFINITY);
    for (const Vec2& p : hull) {
        const Vec2 q(glm::dot(p, axis), glm::dot(p, across));
        low = glm::min(low, q);
        high = glm::max(high, q);
    }
    return {low.x * axis + low.y * across, high.x * axis + low.y * across, high.x * axis + high.y * across,
            low.x * axis + high.y * across};
}

// The part of a convex polygon in front of a plane; at most one point more. Nothing where it only touches.
std::size_t front_part(const ShaftEnd& end, const HalfSpace& plane, double touch, std::span<Vec3> part) {
    std::array<double, ShaftEnd::most_points> heights;
    double highest = 0.0;
    for (std::size_t i = 0; i < end.count; ++i) {
        heights[i] = plane.distance(end.points[i]);
        highest = std::max(highest, heights[i]);
    }
    if (highest <= touch) return 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < end.count; ++i) {
        const std::size_t j = i + 1 < end.count ? i + 1 : 0;
        // A point just behind stays: cutting off so little would only add edges without length.
        if (heights[i] >= -touch) part[count++] = end.points[i];
        if (std::min(heights[i], heights[j]) < -touch && std::max(heights[i], heights[j]) > 0.0)
            part[count++] =
                end.points[i] + heights[i] / (heights[i] - heights[j]) * (end.points[j] - end.points[i]);
    }
    return count;
}

std::size_t whole_end(const ShaftEnd& end, std::span<Vec3> points) {
    if (end.planar()) {
        std::copy_n(end.points.begin(), end.count, points.begin());
        return end.count;
    }
    for (std::size_t corner = 0; corner < 8; ++corner)
        points[corner] = {(corner & 1) != 0 ? end.box_high.x : end.box_low.x,
                          (corner & 2) != 0 ? end.box_high.y : end.box_low.y,
                          (corner & 4) != 0 ? end.box_high.z : end.box_low.z};
    return 8;
}

HalfSpace front_of(const ShaftEnd& end) { return {end.normal, glm::dot(end.normal, end.points[0])}; }

} // namespace

ShaftEnd shaft_end(const Vec3& low, const Vec3& high) {
    ShaftEnd end;
    end.box_low = low;
    end.box_high = high;
    return end;
}

ShaftEnd shaft_end(std::span<const Vec3> points, const Vec3& normal) {
    ShaftEnd end = shaft_end(points[0], points[0]);
    for (const Vec3& p : points) {
        end.box_low = glm::min(end.box_low, p);
        end.box_high = glm::max(end.box_high, p);
    }
    if (is_its_hull(points, normal, end.box_high - end.box_low)) {
        end.normal = normal;
        end.count = points.size();
        std::copy(points.begin(), points.end(), end.points.begin());
        return end;
    }
    const auto [u, v] = plane_axes(normal);
    std::vector<Vec2> flat;
    flat.reserve(points.size());
    for (const Vec3& p : points) flat.emplace_back(glm::dot(p - points[0], u), glm::dot(p - points[0], v));
    std::vector<Vec2> hull = convex_hull(std::move(flat));
    if (hull.size() < 3) return end;
    if (hull.size() > ShaftEnd::most_points) hull = rectangle_around(hull);
    end.normal = normal;
    for (const Vec2& p : hull) end.points[end.count++] = points[0] + p.x * u + p.y * v;
    return end;
}

ShaftEnd shaft_end(const geometry::ElementShape& element) {
    if (!element.planar || element.outline.empty()) return shaft_end(element.box_low, element.box_high);
    const Vec3& normal = element.facets[0].normal;
    if (element.outline.size() == 1) return shaft_end(element.outline[0], normal);
    std::vector<Vec3> points;
    for (const std::vector<Vec3>& loop : element.outline)
        points.insert(points.end(), loop.begin(), loop.end());
    return shaft_end(points, normal);
}

double separation(const ShaftEnd& a, const ShaftEnd& b) {
    double largest = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        largest = std::max({largest, a.box_low[axis] - b.box_high[axis], b.box_low[axis] - a.box_high[axis]});
    const auto extent = [](const ShaftEnd& end, const Vec3& direction) {
        const Vec3 middle = 0.5 * (end.box_low + end.box_high);
        const double centre = glm::dot(direction, middle);
        if (!end.planar()) {
            const double half = glm::dot(glm::abs(direction), 0.5 * (end.box_high - end.box_low));
            return std::pair(centre - half, centre + half);
        }
        std::pair range(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
        for (std::size_t k = 0; k < end.count; ++k) {
            const double at = glm::dot(direction, end.points[k]);
            range = {std::min(range.first, at), std::max(range.second, at)};
        }
        return range;
    };
    const Vec3 line = b.box_low + b.box_high - a.box_low - a.box_high;
    for (const Vec3& direction : {a.normal, b.normal, line}) {
        const double length = glm::length(direction);
        if (!(length > 0.0)) continue;
        const auto [low_a, high_a] = extent(a, direction / length);
        const auto [low_b, high_b] = extent(b, direction / length);
        largest = std::max({largest, low_a - high_b, low_b - high_a});
    }
    return largest;
}

Shaft::Shaft(const ShaftEnd& a, const ShaftEnd& b) {
    size_ = glm::distance(glm::min(a.box_low, b.box_low), glm::max(a.box_high, b.box_high));
    touch_ = relative_touch * size_;
    take_front_parts(a, b);
    if (count_a_ < 3 || count_b_ < 3) {
        count_a_ = count_b_ = 0;
        return;
    }
    measure();
    if (a.planar()) half_spaces_[count_++] = front_of(a);
    if (b.planar()) half_spaces_[count_++] = front_of(b);
    if (a.planar() && b.planar()) {
        add_tangents(points_a(), points_b());
        add_tangents(points_b(), points_a());
    } else {
        add_box_tangents(a, b);
    }
}

void Shaft::take_front_parts(const ShaftEnd& a, const ShaftEnd& b) {
    count_a_ =
        a.planar() && b.planar() ? front_part(a, front_of(b), touch_, points_a_) : whole_end(a, points_a_);
    count_b_ =
        a.planar() && b.planar() ? front_part(b, front_of(a), touch_, points_b_) : whole_end(b, points_b_);
}

void Shaft::measure() {
    low_ = high_ = points_a_[0];
    for (const auto& points : {points_a(), points_b()})
        for (const Vec3& p : points) {
            low_ = glm::min(low_, p);
            high_ = glm::max(high_, p);
        }
    size_ = glm::distance(low_, high_);
    touch_ = relative_touch * size_;
}

// Per edge of a polygon the half space that it bounds together with the outermost point of the other end. The other end
// lies in front of the polygon, so that turning about the edge meets its points within half a turn.
void Shaft::add_tangents(std::span<const Vec3> polygon, std::span<const Vec3> other) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3& p = polygon[i];
        const Vec3 edge = polygon[i + 1 < polygon.size() ? i + 1 : 0] - p;
        Vec3 normal = glm::cross(other[0] - p, edge);
        for (const Vec3& y : other.subspan(1))
            if (glm::dot(normal, y - p) < 0.0) normal = glm::cross(y - p, edge);
        const double length = glm::length(normal);
        if (!(length > touch_ * touch_)) continue;
        normal /= length;
        add_if_bounding({normal, glm::dot(normal, p)});
    }
}

// Between boxes, the half spaces whose borders are parallel to an axis and touch an edge of either box. The box of a
// polygon stands for it; the box of the whole is tested apart.
void Shaft::add_box_tangents(const ShaftEnd& a, const ShaftEnd& b) {
    for (int axis = 0; axis < 3; ++axis) {
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        for (int corner = 0; corner < 4; ++corner) {
            const Vec3& at = (corner & 1) != 0 ? a.box_high : a.box_low;
            const Vec3& bt = (corner & 1) != 0 ? b.box_high : b.box_low;
            const Vec2 p(at[i], (corner & 2) != 0 ? a.box_high[j] : a.box_low[j]);
            const Vec2 q(bt[i], (corner & 2) != 0 ? b.box_high[j] : b.box_low[j]);
            const double length = glm::distance(p, q);
            if (!(length > touch_)) continue;
            // Left or right of the line p q: the side of the corner opposite to this one.
            Vec3 normal(0.0);
            normal[i] = (q.y - p.y) / length;
            normal[j] = (p.x - q.x) / length;
            const Vec2 opposite((corner & 1) != 0 ? a.box_low[i] : a.box_high[i],
                                (corner & 2) != 0 ? a.box_low[j] : a.box_high[j]);
            if (normal[i] * (opposite.x - p.x) + normal[j] * (opposite.y - p.y) < 0.0) normal = -normal;
            add_if_bounding({normal, normal[i] * p.x + normal[j] * p.y});
        }
    }
}

// Where points coincide or lie on one line, a plane through three of them may cut through the ends; such are left out.
void Shaft::add_if_bounding(const HalfSpace& half_space) {
    for (const auto& points : {points_a(), points_b()})
        for (const Vec3& p : points)
            if (half_space.distance(p) < -touch_) return;
    half_spaces_[count_++] = half_space;
}

bool Shaft::misses(const Vec3& low, const Vec3& high) const {
    if (empty()) return true;
    for (int axis = 0; axis < 3; ++axis)
        if (high[axis] <= low_[axis] + touch_ || low[axis] >= high_[axis] - touch_) return true;
    const Vec3 centre = 0.5 * (low + high), half = 0.5 * (high - low);
    for (const HalfSpace& half_space : half_spaces()) {
        const Vec3 reach = glm::abs(half_space.normal) * half;
        if (half_space.distance(centre) + reach.x + reach.y + reach.z <= touch_) return true;
    }
    return false;
}

bool Shaft::misses(std::span<const Vec3> points, const HalfSpace& plane) const {
    if (empty()) return true;
    const auto all_outside = [&](const HalfSpace& half_space) {
        return std::all_of(points.begin(), points.end(),
                           [&](const Vec3& p) { return half_space.distance(p) <= touch_; });
    };
    if (std::any_of(half_spaces().begin(), half_spaces().end(), all_outside)) return true;
    // Both ends on one side of the polygon's plane: segments between them do not cross it.
    double lowest = 0.0, highest = 0.0;
    for (const auto& ends : {points_a(), points_b()})
        for (const Vec3& p : ends) {
            const double height = plane.distance(p);
            lowest = std::min(lowest, height);
            highest = std::max(highest, height);
        }
    return lowest >= -touch_ || highest <= touch_;
}

} // namespace kinelux::visibility
