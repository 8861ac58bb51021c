// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "fit/domain.h"

namespace kinelux::fit {

/// Boundary edges and cuts of one chart, kept such that they meet at common points only. Cuts give way: what is nearer
/// than the tolerance to a point or an edge is moved onto it, and the boundary keeps its shape.
class SegmentMap {
public:
    SegmentMap(std::vector<Vec2> points, std::vector<Edge> boundary, double tolerance);

    /// Adds a cut, divided at whatever it meets.
    void insert(const Vec2& a, const Vec2& b);

    const std::vector<Vec2>& points() const { return points_; }
    const std::vector<Edge>& boundary() const {
        return boundary_;
    } ///< directed as given, divided where cuts end
    const std::vector<Edge>& cuts() const { return cuts_; }

private:
    std::uint32_t place(const Vec2& p);
    bool divide_near(std::vector<Edge>& edges, const Vec2& p, std::uint32_t& point);
    void cross(std::vector<Edge>& edges, std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& stops);
    void add_piece(std::uint32_t a, std::uint32_t b);

    std::vector<Vec2> points_;
    std::vector<Edge> boundary_, cuts_;
    double tolerance_;
};

} // namespace kinelux::fit
