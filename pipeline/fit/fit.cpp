// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit.h"

#include <algorithm>
#include <cstddef>
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
#include "fit/small_triangles.h"

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

double area_of(const model::PatchSet& set) {
    double area = 0.0;
    for (const model::Patch& patch : set.patches) {
        for (const model::Triangle& t : patch.triangles) {
            const Vec2 ab = patch.points[t[1]] - patch.points[t[0]],
                       ac = patch.points[t[2]] - patch.points[t[0]];
            area += 0.5 * (ab.x * ac.y - ab.y * ac.x);
        }
    }
    for (const model::Triangle& t : set.small.triangles) {
        const Vec3 a = set.small.points[t[0]];
        area += 0.5 * glm::length(glm::cross(set.small.points[t[1]] - a, set.small.points[t[2]] - a));
    }
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

    FitResult result;
    for (std::size_t c = 0; c < scene.charts.size(); ++c) {
        const Chart& chart = scene.charts[c];
        result.area_in += (chart.two_sided ? 2.0 : 1.0) * chart.area;
        if (scene.places[c].patch) {
            result.faces_in_patches += chart.faces.size();
            add_patches(std::move(made[c]), result);
        } else {
            result.faces_left_small += chart.faces.size();
            add_small_triangles(bodies[chart.body], chart, options.small_triangle_edge * size.diagonal,
                                result.patches.small);
        }
    }
    result.area_out = area_of(result.patches);
    return result;
}

} // namespace kinelux::fit
