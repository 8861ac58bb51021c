// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace kinelux::visibility {

/// Closed loops of points, one after another in one array. What they enclose is where their winding numbers sum to 1:
/// loops may share edges that run in opposite directions, and such edges cancel in every contour integral.
template <class Point>
struct Loops {
    std::vector<Point> points;
    std::vector<std::uint32_t> ends; ///< of each loop: one past its last point

    std::size_t size() const { return ends.size(); }
    bool empty() const { return ends.empty(); }
    std::span<const Point> operator[](std::size_t loop) const {
        const std::size_t first = loop == 0 ? 0 : ends[loop - 1];
        return std::span(points).subspan(first, ends[loop] - first);
    }
    void clear() {
        points.clear();
        ends.clear();
    }
    void add(std::span<const Point> loop) {
        points.insert(points.end(), loop.begin(), loop.end());
        ends.push_back(static_cast<std::uint32_t>(points.size()));
    }
    void add_reversed(std::span<const Point> loop) {
        points.insert(points.end(), loop.rbegin(), loop.rend());
        ends.push_back(static_cast<std::uint32_t>(points.size()));
    }
};

using Loops2 = Loops<Vec2>;
using Loops3 = Loops<Vec3>;

/// Twice the vector area of a closed loop; along the loop's normal when plane, its length twice the area [m2].
inline Vec3 twice_vector_area(std::span<const Vec3> loop) {
    Vec3 sum(0.0);
    for (std::size_t i = 2; i < loop.size(); ++i) sum += glm::cross(loop[i - 1] - loop[0], loop[i] - loop[0]);
    return sum;
}

/// Twice the area of a closed loop, positive when counter-clockwise [m2].
inline double twice_area(std::span<const Vec2> loop) {
    double sum = 0.0;
    for (std::size_t i = 2; i < loop.size(); ++i) {
        const Vec2 e = loop[i - 1] - loop[0], f = loop[i] - loop[0];
        sum += e.x * f.y - e.y * f.x;
    }
    return sum;
}

/// Whether a loop turns nowhere to the right by more than `slack` of the product of two neighbouring edges' lengths.
/// @param normal  unit, of the side from which a counter-clockwise loop is seen
inline bool is_convex(std::span<const Vec3> loop, const Vec3& normal, double slack) {
    if (loop.size() == 3) return true;
    Vec3 before = loop[0] - loop[loop.size() - 1];
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3 edge = loop[i + 1 < loop.size() ? i + 1 : 0] - loop[i];
        const double turn = glm::dot(glm::cross(before, edge), normal);
        if (turn < 0.0 && turn * turn > slack * slack * glm::dot(before, before) * glm::dot(edge, edge))
            return false;
        before = edge;
    }
    return true;
}

/// The same in the plane, seen so that counter-clockwise loops turn to the left.
inline bool is_convex(std::span<const Vec2> loop, double slack) {
    if (loop.size() == 3) return true;
    Vec2 before = loop[0] - loop[loop.size() - 1];
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec2 edge = loop[i + 1 < loop.size() ? i + 1 : 0] - loop[i];
        const double turn = before.x * edge.y - before.y * edge.x;
        if (turn < 0.0 && turn * turn > slack * slack * glm::dot(before, before) * glm::dot(edge, edge))
            return false;
        before = edge;
    }
    return true;
}

/// Cuts loops by half spaces one after another (Sutherland and Hodgman, Communications of the ACM 17, 1974). A convex
/// loop stays convex. The parts of any other stay joined by edges along the cut, which cancel each other: areas and
/// contour integrals are right within rounding whatever the position of points and cuts. Keeps its memory for reuse.
template <class Point>
class LoopCutter {
public:
    void begin(std::span<const Point> loop) {
        loop_.assign(loop.begin(), loop.end());
        whole_ = true;
    }
    /// Keeps what lies where distance(point), linear in the point, is positive.
    template <class Distance>
    void keep(const Distance& distance) {
        distances_.resize(loop_.size());
        bool any_out = false, any_in = false;
        for (std::size_t i = 0; i < loop_.size(); ++i) {
            distances_[i] = distance(loop_[i]);
            any_out = any_out || distances_[i] < 0.0;
            any_in = any_in || distances_[i] > 0.0;
        }
        if (!any_out && any_in) return;
        whole_ = false;
        cut_.clear();
        for (std::size_t i = 0, j = 1; any_in && i < loop_.size();
             ++i, j = j + 1 < loop_.size() ? j + 1 : 0) {
            if (distances_[i] >= 0.0) cut_.push_back(loop_[i]);
            if (distances_[i] * distances_[j] < 0.0)
                cut_.push_back(crossing(loop_[i], distances_[i], loop_[j], distances_[j]));
        }
        loop_.swap(cut_);
    }
    std::span<const Point> loop() const { return loop_; } ///< what is left; empty when nothing
    bool whole() const { return whole_; }                 ///< no cut took anything

private:
    // Always from the inner to the outer end, so that an edge run both ways is cut in the same point.
    static Point crossing(const Point& p, double dp, const Point& q, double dq) {
        return dp > 0.0 ? p + dp / (dp - dq) * (q - p) : q + dq / (dq - dp) * (p - q);
    }

    std::vector<Point> loop_, cut_;
    std::vector<double> distances_;
    bool whole_ = true;
};

} // namespace kinelux::visibility
