// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/curved.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/geometric.hpp>

#include "fit/domain.h"

namespace kinelux::fit {

namespace {

// A regular prism reads as round from 13 sides on if it is narrow, from 11 on if it is small in every way.
constexpr double smooth_deg = 30.0, smooth_small_deg = 35.0;
constexpr double same_plane_deg = 1.0; // charts of one plane that differ in material are no curve
constexpr double smooth_share = 0.25;  // of the boundary's length
constexpr double narrow_share = 0.02;  // of the scene's extent
constexpr double wide_share =
    0.2; // of the scene's extent: a facet wider than this deserves elements of its own
constexpr double dominating_ratio = 4.0; // wider than its widest smooth neighbour by this: a flat side

double angle_deg(const Vec3& a, const Vec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi;
}

// How a chart's boundary continues into other planes.
struct Continuation {
    double length = 0.0, smooth_length = 0.0, smooth_small_length = 0.0;
    double widest_neighbour = 0.0;
};

Continuation continuation(const Body& body, const std::vector<Chart>& charts,
                          const std::vector<std::uint32_t>& chart_of, const std::vector<double>& widths,
                          const Chart& chart) {
    Continuation result;
    for (const BoundaryEdge& edge : boundary_edges(body, chart)) {
        const Face& face = body.faces[edge.face];
        const Vec3 a = body.points[face.corners[edge.k]], b = body.points[face.corners[(edge.k + 1) % 3]];
        const double length = glm::distance(a, b);
        result.length += length;
        double least_angle = 180.0;
        for (const std::uint32_t other : body.across(edge.face, edge.k)) {
            const Chart& neighbour = charts[chart_of[other]];
            if (angle_deg(neighbour.plane.normal, chart.plane.normal) <= same_plane_deg) continue;
            const double angle = angle_deg(body.faces[other].normal, face.normal);
            least_angle = std::min(least_angle, angle);
            if (angle < smooth_small_deg)
                result.widest_neighbour = std::max(result.widest_neighbour, widths[chart_of[other]]);
        }
        if (least_angle < smooth_deg) result.smooth_length += length;
        if (least_angle < smooth_small_deg) result.smooth_small_length += length;
    }
    return result;
}

} // namespace

std::vector<std::uint8_t> curved_charts(const Body& body, const std::vector<Chart>& charts,
                                        const std::vector<double>& widths, const CurvedOptions& options) {
    std::vector<std::uint32_t> chart_of(body.faces.size(), 0);
    for (std::size_t c = 0; c < charts.size(); ++c) {
        for (const std::uint32_t f : charts[c].faces) chart_of[f] = static_cast<std::uint32_t>(c);
    }
    std::vector<std::uint8_t> curved(charts.size(), 0);
    for (std::size_t c = 0; c < charts.size(); ++c) {
        const Continuation edge = continuation(body, charts, chart_of, widths, charts[c]);
        const bool small =
            charts[c].area < options.small_area || widths[c] < narrow_share * options.scene_extent;
        const double smooth = small ? edge.smooth_small_length : edge.smooth_length;
        const bool facet = smooth >= smooth_share * edge.length && edge.widest_neighbour > 0.0 &&
                           widths[c] <= wide_share * options.scene_extent &&
                           widths[c] <= dominating_ratio * edge.widest_neighbour;
        curved[c] = facet || charts[c].area < options.negligible_area ? 1 : 0;
    }
    return curved;
}

} // namespace kinelux::fit
