// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/round_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "fit/round_surface.h"
#include "geometry/surface.h"

namespace kinelux::fit {

namespace {

using model::Surface;

// Pieces that surfaces grow from: small ones stay clear of the next surface, larger ones tell surfaces apart better (two
// rings of corners lie on cones and many tori).
constexpr std::array<std::size_t, 3> piece_faces{24, 96, 384};
constexpr std::size_t least_faces = 6;
constexpr double least_turn_deg = 20.0; // of a chart's faces: what bends less has no radius worth the name
// Between a face and its surface at the centroid, of what two faces may turn: half of it is the facet's own chord.
constexpr double tilt_share = 0.75;
constexpr double clearly_more = 1.02; // of area: below, the simpler surface is taken
constexpr int refits = 6;
// Where corners lie on a surface far better than the tolerance asks, those that do not are the next surface's: a face
// stays out beyond this many median distances, but not within this share of the tolerance.
constexpr double outlying = 20.0, least_tolerance = 0.01;

double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180.0); }

Vec3 centroid(const Body& body, const Face& face) {
    return (body.points[face.corners[0]] + body.points[face.corners[1]] + body.points[face.corners[2]]) / 3.0;
}

struct Region {
    Surface surface;
    std::vector<std::uint32_t> faces; // ascending
    double area = 0.0;
};

class Growth {
public:
    Growth(const Body& body, std::span<const std::uint8_t> candidates, const RoundOptions& options)
        : body_(body),
          options_(options),
          turn_cosine_(cosine(options.face_turn_deg)),
          tilt_cosine_(cosine(tilt_share * options.face_turn_deg)),
          free_(candidates.begin(), candidates.end()),
          marked_(body.faces.size(), 0) {}

    bool free(std::uint32_t face) const { return free_[face] != 0; }
    void take(const std::vector<std::uint32_t>& faces) {
        for (const std::uint32_t f : faces) free_[f] = 0;
    }

    // Free faces around a seed that continue each other smoothly and are accepted, `most` at most, ascending.
    template <class Accepts>
    std::vector<std::uint32_t> flood(std::uint32_t seed, std::size_t most, const Accepts& accepts) {
        std::vector<std::uint32_t> region;
        if (!accepts(seed)) return region;
        const std::uint32_t mark = ++floods_;
        region.push_back(seed);
        marked_[seed] = mark;
        for (std::size_t i = 0; i < region.size() && region.size() < most; ++i) {
            const Face& face = body_.faces[region[i]];
            for (std::size_t k = 0; k < 3; ++k)
                for (const std::uint32_t next : body_.across(region[i], k)) {
                    const Face& other = body_.faces[next];
                    if (free_[next] == 0 || marked_[next] == mark || region.size() >= most) continue;
                    if (other.material != face.material || other.two_sided != face.two_sided) continue;
                    if (glm::dot(other.normal, face.normal) < turn_cosine_ || !accepts(next)) continue;
                    marked_[next] = mark;
                    region.push_back(next);
                }
        }
        std::sort(region.begin(), region.end());
        return region;
    }

    bool lies_on(const Surface& surface, std::uint32_t f, double tolerance) const {
        const Face& face = body_.faces[f];
        for (const std::uint32_t corner : face.corners)
            if (!(std::abs(signed_distance(surface, body_.points[corner])) <= tolerance)) return false;
        const geometry::SurfaceTangents at =
            geometry::surface_tangents(surface, round_parameters(surface, centroid(body_, face)));
        const Vec3 across = glm::cross(at.along_u, at.along_v);
        return surface.orientation * glm::dot(across, face.normal) >= tilt_cosine_ * glm::length(across);
    }

    std::vector<Surface> surfaces_of(const std::vector<std::uint32_t>& faces) const {
        std::vector<std::uint32_t> corners;
        std::vector<FaceSample> samples;
        for (const std::uint32_t f : faces) {
            const Face& face = body_.faces[f];
            corners.insert(corners.end(), face.corners.begin(), face.corners.end());
            samples.push_back({centroid(body_, face), face.normal, face.area});
        }
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        std::vector<Vec3> points;
        points.reserve(corners.size());
        for (const std::uint32_t corner : corners) points.push_back(body_.points[corner]);
        std::vector<Surface> surfaces = nearest_round_surfaces(points, samples);
        for (Surface& s : surfaces) orient(s, samples);
        return surfaces;
    }

    // The region that grows around a seed from the surface of a first piece; nothing if it does not settle.
    std::optional<Region> grown(std::uint32_t seed, Surface surface) {
        const model::SurfaceType type = surface.type;
        Region region{surface, {}, 0.0};
        double tolerance = options_.distance_tolerance;
        for (int i = 0; i < refits; ++i) {
            std::vector<std::uint32_t> faces = flood(
                seed, body_.faces.size(), [&](std::uint32_t f) { return lies_on(surface, f, tolerance); });
            if (faces.empty()) return std::nullopt;
            const bool settled = faces == region.faces;
            region = {surface, std::move(faces), 0.0};
            if (settled) break;
            for (const Surface& better : surfaces_of(region.faces))
                if (better.type == type) surface = better;
            tolerance =
                std::clamp(outlying * median_distance(surface, region.faces),
                           least_tolerance * options_.distance_tolerance, options_.distance_tolerance);
        }
        for (const std::uint32_t f : region.faces) region.area += body_.faces[f].area;
        return worth_it(region) ? std::optional(std::move(region)) : std::nullopt;
    }

    double area_of(const std::vector<std::uint32_t>& faces) const {
        double area = 0.0;
        for (const std::uint32_t f : faces) area += body_.faces[f].area;
        return area;
    }

private:
    static void orient(Surface& surface, const std::vector<FaceSample>& samples) {
        double along = 0.0;
        for (const FaceSample& s : samples) {
            const geometry::SurfaceTangents at =
                geometry::surface_tangents(surface, round_parameters(surface, s.position));
            along += s.area * glm::dot(glm::cross(at.along_u, at.along_v), s.normal);
        }
        surface.orientation = along < 0.0 ? -1.0 : 1.0;
    }

    double median_distance(const Surface& surface, const std::vector<std::uint32_t>& faces) const {
        std::vector<double> distances;
        for (const std::uint32_t f : faces)
            for (const std::uint32_t corner : body_.faces[f].corners)
                distances.push_back(std::abs(signed_distance(surface, body_.points[corner])));
        const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
        std::nth_element(distances.begin(), middle, distances.end());
        return *middle;
    }

    bool worth_it(const Region& region) const {
        if (region.faces.size() < least_faces || region.area < options_.least_area) return false;
        const Vec3 first = body_.faces[region.faces.front()].normal;
        return std::any_of(region.faces.begin(), region.faces.end(), [&](std::uint32_t f) {
            return glm::dot(body_.faces[f].normal, first) < cosine(least_turn_deg);
        });
    }

    const Body& body_;
    const RoundOptions& options_;
    double turn_cosine_, tilt_cosine_;
    std::vector<std::uint8_t> free_;
    std::vector<std::uint32_t> marked_; // number of the last flood that reached the face
    std::uint32_t floods_ = 0;
};

// The largest region around a seed whose surface starts from a piece of the mesh; of regions of about the same size the
// simplest.
std::optional<Region> largest_region(Growth& growth, std::uint32_t seed,
                                     const std::vector<std::uint32_t>& piece) {
    std::optional<Region> best;
    for (const Surface& surface : growth.surfaces_of(piece)) {
        std::optional<Region> region = growth.grown(seed, surface);
        if (region && (!best || region->area > clearly_more * best->area)) best = std::move(region);
        if (best && best->faces.size() == piece.size()) break;
    }
    return best;
}

// A sphere has no axis of its own. Where many faces meet is a pole of the mesh, and of the surface; else the poles are
// kept away from the faces if they can be.
Vec3 pole_of(const Body& body, const std::vector<std::uint32_t>& faces, const Surface& sphere) {
    constexpr std::size_t many = 8;
    constexpr double clear = 0.94; // cosine of 20 degrees between a face and a pole
    std::map<std::uint32_t, std::size_t> meeting;
    for (const std::uint32_t f : faces)
        for (const std::uint32_t corner : body.faces[f].corners) ++meeting[corner];
    const auto most = std::max_element(meeting.begin(), meeting.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most->second < many)
        for (const Vec3& axis : {Vec3{0.0, 0.0, 1.0}, Vec3{1.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0}})
            if (std::none_of(faces.begin(), faces.end(), [&](std::uint32_t f) {
                    return std::abs(glm::dot(body.faces[f].normal, axis)) > clear;
                }))
                return axis;
    return body.points[most->first] - sphere.origin;
}

RoundChart chart_of(const Body& body, std::size_t body_index, Region region) {
    RoundChart chart;
    chart.body = body_index;
    chart.material = body.faces[region.faces.front()].material;
    chart.two_sided = body.faces[region.faces.front()].two_sided;
    chart.surface = region.surface;
    if (chart.surface.type == model::SurfaceType::Sphere)
        set_axis(chart.surface, pole_of(body, region.faces, chart.surface));
    chart.area = region.area;
    double squares = 0.0, count = 0.0;
    for (const std::uint32_t f : region.faces) {
        for (const std::uint32_t corner : body.faces[f].corners) {
            const double distance = std::abs(signed_distance(chart.surface, body.points[corner]));
            chart.deviation_max = std::max(chart.deviation_max, distance);
            squares += distance * distance;
            count += 1.0;
        }
        chart.chord_max = std::max(chart.chord_max,
                                   std::abs(signed_distance(chart.surface, centroid(body, body.faces[f]))));
    }
    chart.deviation_rms = std::sqrt(squares / count);
    chart.faces = std::move(region.faces);
    return chart;
}

} // namespace

std::vector<RoundChart> grow_round_charts(const Body& body, std::size_t body_index,
                                          std::span<const std::uint8_t> candidates,
                                          const RoundOptions& options) {
    Growth growth(body, candidates, options);
    std::vector<RoundChart> charts;
    const auto any = [](std::uint32_t) { return true; };
    const auto take = [&](Region region) {
        growth.take(region.faces);
        charts.push_back(chart_of(body, body_index, std::move(region)));
    };
    std::vector<std::uint8_t> seen(body.faces.size(), 0), hopeless(body.faces.size(), 0);
    for (std::uint32_t first = 0; first < body.faces.size(); ++first) {
        if (seen[first] != 0 || !growth.free(first)) continue;
        const std::vector<std::uint32_t> smooth = growth.flood(first, body.faces.size(), any);
        for (const std::uint32_t f : smooth) seen[f] = 1;
        if (smooth.size() < least_faces || growth.area_of(smooth) < options.least_area) continue;
        if (auto region = largest_region(growth, first, smooth); region && region->faces == smooth) {
            take(std::move(*region));
            continue;
        }
        for (const std::uint32_t seed : smooth) {
            if (!growth.free(seed) || hopeless[seed] != 0) continue;
            std::optional<Region> best;
            std::vector<std::uint32_t> piece;
            for (const std::size_t most : piece_faces) {
                piece = growth.flood(seed, most, any);
                if (piece.size() < least_faces) break;
                auto region = largest_region(growth, seed, piece);
                if (region && (!best || region->area > clearly_more * best->area)) best = std::move(region);
                if (piece.size() < most) break;
            }
            if (best) {
                take(std::move(*best));
            } else {
                for (const std::uint32_t f : piece) hopeless[f] = 1;
            }
        }
    }
    return charts;
}

} // namespace kinelux::fit
