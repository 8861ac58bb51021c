// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "fit/charts.h"
#include "fit/contacts.h"
#include "fit/curved.h"
#include "fit/domain.h"
#include "fit/faces.h"
#include "fit/outline.h"
#include "fit/round_charts.h"
#include "fit/small_triangles.h"
#include "fit/unroll.h"
#include "geometry/surface.h"

namespace kinelux::fit {

namespace {

// Where no tolerance of the user's applies, shares of the scene's size.
constexpr double thin_height = 1e-5; // of a face: float coordinates leave its normal a few degrees of noise
constexpr double exact_distance = 1e-9; // of corners from their plane: rounding
// A chart below this share of the scene's area is a speck: it never carries a patch.
constexpr double negligible_area = 1e-6;

struct Size {
    double diagonal = 0.0, extent = 0.0, area = 0.0;
};

Size scene_size(const model::Scene& scene, const std::vector<Body>& bodies) {
    const bool any_at_rest = std::any_of(bodies.begin(), bodies.end(), [&](const Body& body) {
        return !body.faces.empty() && !scene.objects[body.object.value].motion;
    });
    Vec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    Size size;
    for (const Body& body : bodies) {
        for (const Face& face : body.faces) size.area += face.area;
        if (any_at_rest && scene.objects[body.object.value].motion) continue;
        for (const Face& face : body.faces) {
            for (const std::uint32_t corner : face.corners) {
                low = glm::min(low, body.points[corner]);
                high = glm::max(high, body.points[corner]);
            }
        }
    }
    if (!(size.area > 0.0))
        throw core::GeometryError("no face of the scene has area; there is nothing to fit");
    const Vec3 edges = high - low;
    size.diagonal = glm::length(edges);
    size.extent = std::max({edges.x, edges.y, edges.z});
    return size;
}

// All charts of the scene, ordered by body, with what is known of each.
struct SceneCharts {
    std::vector<Chart> charts;
    std::vector<FlatChart> flats;
    std::vector<PlacedChart> places;
};

void add_charts(const Body& body, std::size_t index, const Size& size, const FitOptions& options,
                SceneCharts& all, std::vector<std::uint8_t>& curved) {
    const ChartOptions chart_options{.distance_tolerance = options.distance_tolerance * size.diagonal,
                                     .normal_tolerance_deg = options.normal_tolerance_deg,
                                     .thin_height = thin_height * size.diagonal,
                                     .exact_distance = exact_distance * size.diagonal};
    const std::vector<Chart> charts = grow_charts(body, index, chart_options);
    std::vector<double> widths;
    for (const Chart& chart : charts) {
        all.flats.push_back(flatten(body, chart));
        widths.push_back(std::min(all.flats.back().extent.x, all.flats.back().extent.y));
    }
    const std::vector<std::uint8_t> flags = curved_charts(body, charts, widths,
                                                          {.scene_extent = size.extent,
                                                           .small_area = options.min_patch_area * size.area,
                                                           .negligible_area = negligible_area * size.area});
    curved.insert(curved.end(), flags.begin(), flags.end());
    all.charts.insert(all.charts.end(), charts.begin(), charts.end());
}

PlacedChart place(const model::Scene& scene, const Body& body, const Chart& chart, bool curved) {
    PlacedChart placed;
    placed.body = &body;
    placed.chart = &chart;
    placed.motion = scene.objects[body.object.value].motion;
    placed.emits = scene.materials[chart.material.value].emits();
    placed.patch = !curved;
    placed.low = Vec3{std::numeric_limits<double>::infinity()};
    placed.high = -placed.low;
    for (const std::uint32_t f : chart.faces) {
        for (const std::uint32_t corner : body.faces[f].corners) {
            placed.low = glm::min(placed.low, body.points[corner]);
            placed.high = glm::max(placed.high, body.points[corner]);
        }
    }
    return placed;
}

SceneCharts find_charts(const model::Scene& scene, const std::vector<Body>& bodies, const Size& size,
                        const FitOptions& options) {
    SceneCharts all;
    std::vector<std::uint8_t> curved;
    for (std::size_t b = 0; b < bodies.size(); ++b) add_charts(bodies[b], b, size, options, all, curved);
    for (std::size_t c = 0; c < all.charts.size(); ++c) {
        all.places.push_back(place(scene, bodies[all.charts[c].body], all.charts[c], curved[c] != 0));
    }
    return all;
}

void add_patches(ChartPatches made, FitResult& result) {
    result.contact_cuts += made.divided ? 1 : 0;
    result.overlapping += made.kept_whole ? 1 : 0;
    result.covered_patches += made.covered;
    result.covered_area += made.covered_area;
    for (model::Patch& patch : made.patches) {
        result.deviation_max = std::max(result.deviation_max, patch.deviation_max);
        result.patches.patches.push_back(std::move(patch));
    }
}

// What becomes of the facets of one body's curved surfaces.
struct RoundPatches {
    std::vector<model::Patch> patches;
    std::vector<std::uint8_t> taken; // one per face of the body
    double chord_max = 0.0;
};

RoundPatches round_patches(const SceneCharts& scene, const Body& body, std::size_t index, const Size& size,
                           const FitOptions& options) {
    RoundPatches result;
    result.taken.resize(body.faces.size(), 0);
    if (!(options.round_face_turn_deg > 0.0)) return result;
    std::vector<std::uint8_t> facets(body.faces.size(), 0);
    for (std::size_t c = 0; c < scene.charts.size(); ++c) {
        if (scene.charts[c].body != index || scene.places[c].patch) continue;
        for (const std::uint32_t f : scene.charts[c].faces) facets[f] = 1;
    }
    const RoundOptions round{.distance_tolerance = options.distance_tolerance * size.diagonal,
                             .face_turn_deg = options.round_face_turn_deg,
                             .least_area = options.min_patch_area * size.area};
    for (const RoundChart& chart : grow_round_charts(body, index, facets, round)) {
        std::vector<model::Patch> patches = patches_of_round_chart(body, chart);
        if (patches.empty()) continue;
        for (const std::uint32_t f : chart.faces) result.taken[f] = 1;
        result.chord_max = std::max(result.chord_max, chart.chord_max);
        std::move(patches.begin(), patches.end(), std::back_inserter(result.patches));
    }
    return result;
}

void add_round_patches(RoundPatches made, FitResult& result) {
    result.round_patches += made.patches.size();
    result.chord_max = std::max(result.chord_max, made.chord_max);
    for (model::Patch& patch : made.patches) {
        result.deviation_max = std::max(result.deviation_max, patch.deviation_max);
        result.patches.patches.push_back(std::move(patch));
    }
}

double area_of(const model::PatchSet& set) {
    double area = geometry::area(set.small);
    for (const model::Patch& patch : set.patches) area += geometry::area(patch);
    return area;
}

} // namespace

FitResult fit_patches(const model::Scene& clean_scene, const FitOptions& options) {
    std::vector<Body> bodies;
    for (std::size_t o = 0; o < clean_scene.objects.size(); ++o) {
        bodies.push_back(make_body(clean_scene.objects[o], ObjectId(o)));
    }
    const Size size = scene_size(clean_scene, bodies);
    const SceneCharts scene = find_charts(clean_scene, bodies, size, options);
    const Contacts contacts(scene.places);
    std::vector<ChartPatches> made(scene.charts.size());
    core::parallel_for(scene.charts.size(), [&](std::size_t c) {
        if (!scene.places[c].patch) return;
        made[c] = patches_of_chart(scene.places, c, scene.flats[c], contacts,
                                   options.contact_tolerance * size.diagonal);
    });

    std::vector<RoundPatches> round(bodies.size());
    core::parallel_for(bodies.size(),
                       [&](std::size_t b) { round[b] = round_patches(scene, bodies[b], b, size, options); });

    FitResult result;
    for (std::size_t c = 0; c < scene.charts.size(); ++c) {
        const Chart& chart = scene.charts[c];
        result.area_in += (chart.two_sided ? 2.0 : 1.0) * chart.area;
        if (scene.places[c].patch) {
            result.faces_in_patches += chart.faces.size();
            add_patches(std::move(made[c]), result);
        } else {
            Chart left = chart;
            std::erase_if(left.faces, [&](std::uint32_t f) { return round[chart.body].taken[f] != 0; });
            result.faces_in_patches += chart.faces.size() - left.faces.size();
            result.faces_left_small += left.faces.size();
            add_small_triangles(bodies[chart.body], left, options.small_triangle_edge * size.diagonal,
                                result.patches.small);
        }
    }
    for (RoundPatches& of_body : round) add_round_patches(std::move(of_body), result);
    result.area_out = area_of(result.patches);
    return result;
}

} // namespace kinelux::fit
