// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>

namespace kinelux::fit {

namespace {

// A warped quadrilateral lies four times as far from the plane of one of its halves as from its best plane: while
// that plane is not known, faces may be this many tolerances away.
constexpr double first_slack = 4.0;
constexpr int refits = 3;

// One body while it is divided.
struct Growth {
    const Body& body;
    const ChartOptions& options;
    double least_cosine;
    std::vector<std::uint8_t> taken;   // by a finished chart
    std::vector<std::uint32_t> marked; // number of the last flood that reached the face
    std::uint32_t floods = 0;
};

bool fits(const Growth& growth, const Face& face, const Plane& plane, double distance) {
    const bool thin = face.height < growth.options.thin_height;
    if (!thin && glm::dot(face.normal, plane.normal) < growth.least_cosine) return false;
    for (const std::uint32_t corner : face.corners) {
        if (std::abs(plane.distance(growth.body.points[corner])) > distance) return false;
    }
    return true;
}

// The connected faces around a seed that fit a plane; empty if the seed itself does not.
std::vector<std::uint32_t> flood(Growth& growth, std::uint32_t seed, const Plane& plane, double distance) {
    const Body& body = growth.body;
    const Face& kind = body.faces[seed];
    std::vector<std::uint32_t> region;
    if (!fits(growth, kind, plane, distance)) return region;
    const std::uint32_t mark = ++growth.floods;
    region.push_back(seed);
    growth.marked[seed] = mark;
    for (std::size_t i = 0; i < region.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            for (const std::uint32_t next : body.across(region[i], k)) {
                const Face& face = body.faces[next];
                if (growth.taken[next] != 0 || growth.marked[next] == mark) continue;
                if (face.material != kind.material || face.two_sided != kind.two_sided) continue;
                if (!fits(growth, face, plane, distance)) continue;
                growth.marked[next] = mark;
                region.push_back(next);
            }
        }
    }
    std::sort(region.begin(), region.end());
    return region;
}

double largest_distance(const Body& body, const std::vector<std::uint32_t>& region, const Plane& plane) {
    double largest = 0.0;
    for (const std::uint32_t f : region) {
        for (const std::uint32_t corner : body.faces[f].corners) {
            largest = std::max(largest, std::abs(plane.distance(body.points[corner])));
        }
    }
    return largest;
}

// Moves a plane to the middle between the corners farthest before and behind it.
void centre(const Body& body, const std::vector<std::uint32_t>& region, Plane& plane) {
    double low = 0.0, high = 0.0;
    for (const std::uint32_t f : region) {
        for (const std::uint32_t corner : body.faces[f].corners) {
            low = std::min(low, plane.distance(body.points[corner]));
            high = std::max(high, plane.distance(body.points[corner]));
        }
    }
    plane.point += 0.5 * (low + high) * plane.normal;
}

// The least-squares plane of a region. Corners count little in it: where one is beyond the tolerance, the plane is
// moved so that the farthest corners on both sides are equally far.
Plane refitted(const Body& body, const std::vector<std::uint32_t>& region, const Vec3& front,
               double tolerance) {
    std::vector<std::array<Vec3, 3>> triangles;
    for (const std::uint32_t f : region) {
        const model::Triangle& t = body.faces[f].corners;
        triangles.push_back({body.points[t[0]], body.points[t[1]], body.points[t[2]]});
    }
    Plane plane = nearest_plane(triangles);
    if (glm::dot(plane.normal, front) < 0.0) plane.normal = -plane.normal;
    if (largest_distance(body, region, plane) > tolerance) centre(body, region, plane);
    return plane;
}

struct Region {
    std::vector<std::uint32_t> faces;
    Plane plane;
};

// The faces around a seed with the plane that all of them fit.
Region grow(Growth& growth, std::uint32_t seed) {
    const Face& face = growth.body.faces[seed];
    const double tolerance = growth.options.distance_tolerance;
    const Plane first{growth.body.points[face.corners[0]], face.normal};
    Region region{flood(growth, seed, first, first_slack * tolerance), first};
    if (largest_distance(growth.body, region.faces, first) <= growth.options.exact_distance) return region;
    for (int i = 0; i < refits; ++i) {
        const Plane plane = refitted(growth.body, region.faces, face.normal, tolerance);
        std::vector<std::uint32_t> faces = flood(growth, seed, plane, tolerance);
        if (faces.empty()) return {flood(growth, seed, first, tolerance), first};
        const bool settled = faces == region.faces;
        region = {std::move(faces), plane};
        if (settled) break;
    }
    return region;
}

void measure_deviation(const Body& body, Chart& chart) {
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t f : chart.faces) {
        corners.insert(corners.end(), body.faces[f].corners.begin(), body.faces[f].corners.end());
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    double squares = 0.0;
    for (const std::uint32_t corner : corners) {
        const double distance = std::abs(chart.plane.distance(body.points[corner]));
        chart.deviation_max = std::max(chart.deviation_max, distance);
        squares += distance * distance;
    }
    chart.deviation_rms = std::sqrt(squares / static_cast<double>(corners.size()));
}

} // namespace

std::vector<Chart> grow_charts(const Body& body, std::size_t body_index, const ChartOptions& options) {
    const double least_cosine = std::cos(options.normal_tolerance_deg * std::numbers::pi / 180.0);
    const std::size_t count = body.faces.size();
    Growth growth{body, options, least_cosine, std::vector<std::uint8_t>(count, 0),
                  std::vector<std::uint32_t>(count, 0)};

    std::vector<std::uint32_t> seeds(count);
    std::iota(seeds.begin(), seeds.end(), 0U);
    std::stable_sort(seeds.begin(), seeds.end(), [&](std::uint32_t a, std::uint32_t b) {
        return body.faces[a].area > body.faces[b].area;
    });
    std::vector<Chart> charts;
    for (const std::uint32_t seed : seeds) {
        if (growth.taken[seed] != 0) continue;
        Region region = grow(growth, seed);
        if (region.faces.empty()) region.faces = {seed};
        Chart chart;
        chart.body = body_index;
        chart.faces = std::move(region.faces);
        chart.material = body.faces[seed].material;
        chart.two_sided = body.faces[seed].two_sided;
        chart.plane = region.plane;
        for (const std::uint32_t f : chart.faces) {
            growth.taken[f] = 1;
            chart.area += body.faces[f].area;
        }
        measure_deviation(body, chart);
        charts.push_back(std::move(chart));
    }
    return charts;
}

} // namespace kinelux::fit
