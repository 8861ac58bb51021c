// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/contacts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "geometry/surface.h"

namespace kinelux::fit {

namespace {

using Segment = std::array<Vec2, 2>;

bool meet(const Vec3& low_a, const Vec3& high_a, const Vec3& low_b, const Vec3& high_b, double tolerance) {
    return glm::all(glm::lessThanEqual(low_a, high_b + tolerance)) &&
           glm::all(glm::lessThanEqual(low_b, high_a + tolerance));
}

// The corners of a face with their distances from a plane; those within the tolerance count as in it.
struct Crossing {
    std::array<Vec3, 3> corners;
    std::array<double, 3> distances;
    int in_plane = 0;
};

Crossing crossing_of(const Body& body, const Face& face, const Plane& plane, double tolerance) {
    Crossing crossing;
    for (std::size_t k = 0; k < 3; ++k) {
        crossing.corners[k] = body.points[face.corners[k]];
        crossing.distances[k] = plane.distance(crossing.corners[k]);
        if (std::abs(crossing.distances[k]) <= tolerance) {
            crossing.distances[k] = 0.0;
            ++crossing.in_plane;
        }
    }
    return crossing;
}

// The segment in which a face that does not lie in the plane meets it.
std::optional<std::array<Vec3, 2>> common_segment(const Crossing& crossing) {
    std::array<Vec3, 2> ends;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        const double here = crossing.distances[k], there = crossing.distances[next];
        if (here == 0.0 && count < 2) ends[count++] = crossing.corners[k];
        if (here * there < 0.0 && count < 2) {
            ends[count++] = crossing.corners[k] +
                            (here / (here - there)) * (crossing.corners[next] - crossing.corners[k]);
        }
    }
    if (count < 2) return std::nullopt;
    return ends;
}

bool near_domain(const Segment& segment, const Vec2& extent, double tolerance) {
    const Vec2 low = glm::min(segment[0], segment[1]), high = glm::max(segment[0], segment[1]);
    return low.x <= extent.x + tolerance && low.y <= extent.y + tolerance && high.x >= -tolerance &&
           high.y >= -tolerance;
}

} // namespace

Contacts::Contacts(const std::vector<PlacedChart>& charts) : charts_(charts), by_low_x_(charts.size()) {
    std::iota(by_low_x_.begin(), by_low_x_.end(), std::size_t{0});
    std::stable_sort(by_low_x_.begin(), by_low_x_.end(),
                     [&](std::size_t a, std::size_t b) { return charts_[a].low.x < charts_[b].low.x; });
}

// Other charts that move together with this one and whose bounds meet its own, in order of their number.
std::vector<std::size_t> Contacts::near(std::size_t chart, double tolerance) const {
    const PlacedChart& self = charts_[chart];
    std::vector<std::size_t> result;
    for (const std::size_t other : by_low_x_) {
        const PlacedChart& candidate = charts_[other];
        if (candidate.low.x > self.high.x + tolerance) break;
        if (other == chart || candidate.motion != self.motion) continue;
        if (meet(self.low, self.high, candidate.low, candidate.high, tolerance)) result.push_back(other);
    }
    std::sort(result.begin(), result.end());
    return result;
}

std::vector<Segment> Contacts::segments(std::size_t chart, const FlatChart& flat, double tolerance) const {
    const PlacedChart& self = charts_[chart];
    std::vector<Segment> result;
    const auto add = [&](const Vec3& a, const Vec3& b) {
        const Segment segment{geometry::plane_parameters(flat.surface, a),
                              geometry::plane_parameters(flat.surface, b)};
        if (near_domain(segment, flat.extent, tolerance)) result.push_back(segment);
    };
    for (const std::size_t other : near(chart, tolerance)) {
        const Body& body = *charts_[other].body;
        for (const std::uint32_t f : charts_[other].chart->faces) {
            const Crossing crossing = crossing_of(body, body.faces[f], self.chart->plane, tolerance);
            const Vec3 low =
                glm::min(crossing.corners[0], glm::min(crossing.corners[1], crossing.corners[2]));
            const Vec3 high =
                glm::max(crossing.corners[0], glm::max(crossing.corners[1], crossing.corners[2]));
            if (crossing.in_plane == 3 || !meet(self.low, self.high, low, high, tolerance)) continue;
            if (const auto ends = common_segment(crossing)) add((*ends)[0], (*ends)[1]);
        }
        // Of faces in the same plane the outline counts.
        for (const BoundaryEdge& edge : boundary_edges(body, *charts_[other].chart)) {
            const Face& face = body.faces[edge.face];
            const Crossing crossing = crossing_of(body, face, self.chart->plane, tolerance);
            if (crossing.in_plane == 3) add(crossing.corners[edge.k], crossing.corners[(edge.k + 1) % 3]);
        }
    }
    return result;
}

std::vector<Cover> Contacts::covers(std::size_t chart, const FlatChart& flat, double tolerance) const {
    const PlacedChart& self = charts_[chart];
    // Areas that differ by rounding only count as equal.
    constexpr double clearly = 1.0 - 1e-9;
    std::vector<Cover> result;
    for (const std::size_t other : near(chart, tolerance)) {
        const PlacedChart& candidate = charts_[other];
        if (!candidate.patch) continue;
        const bool smaller = candidate.chart->area < clearly * self.chart->area;
        const bool larger = self.chart->area < clearly * candidate.chart->area;
        const bool precedes = std::tuple(!candidate.emits, other) < std::tuple(!self.emits, chart);
        if (larger || (!smaller && !precedes)) continue;
        const bool in_plane =
            std::all_of(candidate.chart->faces.begin(), candidate.chart->faces.end(), [&](std::uint32_t f) {
                return crossing_of(*candidate.body, candidate.body->faces[f], self.chart->plane, tolerance)
                           .in_plane == 3;
            });
        if (!in_plane) continue;
        const bool same_side = glm::dot(candidate.chart->plane.normal, flat.surface.axis_w) > 0.0;
        const bool both = candidate.chart->two_sided;
        result.push_back({other, both || same_side, both || !same_side});
    }
    return result;
}

bool Contacts::lies_in(const FlatChart& flat, const Vec2& point, std::size_t other) const {
    const Body& body = *charts_[other].body;
    for (const std::uint32_t f : charts_[other].chart->faces) {
        std::array<Vec2, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = geometry::plane_parameters(flat.surface, body.points[body.faces[f].corners[k]]);
        }
        int left = 0, right = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2 run = p[(k + 1) % 3] - p[k], to = point - p[k];
            const double side = run.x * to.y - run.y * to.x;
            left += side >= 0.0 ? 1 : 0;
            right += side <= 0.0 ? 1 : 0;
        }
        if (left == 3 || right == 3) return true;
    }
    return false;
}

} // namespace kinelux::fit
