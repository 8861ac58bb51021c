// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "core/sequence.h"
#include "sample/sampler.h"

namespace kinelux::sample {

namespace {

/// Shadow rays of one receiver and what each stands for; kept by a thread between receivers to spare allocations.
struct Rays {
    std::vector<visibility::Segment> segments;
    std::vector<double> weights;
    std::vector<std::uint8_t> blocked;
    double visible = 0.0, all = 0.0; ///< sums of weights of the rays cast so far

    void cast(const visibility::Occluders& occluders) {
        blocked.resize(segments.size());
        occluders.occluded(segments, blocked);
        for (std::size_t i = 0; i < segments.size(); ++i) {
            all += weights[i];
            visible += blocked[i] != 0 ? 0.0 : weights[i];
        }
        segments.clear();
        weights.clear();
    }
};

} // namespace

DirectLight::DirectLight(std::span<const geometry::ElementShape> sources, const model::Scene& scene,
                         const visibility::Occluders& occluders, const DirectLightOptions& options)
    : occluders_(occluders), options_(options) {
    std::map<std::pair<ObjectId, MaterialId>, std::vector<const geometry::ElementShape*>> groups;
    for (const geometry::ElementShape& element : sources)
        if (scene.materials[element.material.value].emits())
            groups[{element.object, element.material}].push_back(&element);
    for (const auto& [owner, elements] : groups)
        sources_.push_back({light_panels(elements), scene.materials[owner.second.value].exitance});
}

// Samples are drawn from the panels in proportion to what each sends unoccluded, evenly on its area, and weighted with
// the kernel over its mean on the panel: the weights' expectation is 1, and the ratio of sums is exact without shadow.
double DirectLight::visible_share(const Receiver& receiver, const Source& source,
                                  std::span<const double> cumulative_factors, std::uint64_t seed) const {
    thread_local Rays rays;
    rays.visible = rays.all = 0.0;
    const double total = cumulative_factors.back();
    const auto probes = static_cast<std::uint32_t>(std::max(options_.probe_rays, 1));
    const auto limit = std::max(static_cast<std::uint32_t>(std::max(options_.shadow_rays, 1)), probes);
    for (std::uint32_t i = 0; i < limit; ++i) {
        if (i == probes) {
            rays.cast(occluders_);
            if (rays.all > 0.0 && (rays.visible == 0.0 || rays.visible == rays.all)) break;
        }
        Vec2 square = core::sobol_2d(i, seed);
        const double target = square.x * total;
        const auto found = std::upper_bound(cumulative_factors.begin(), cumulative_factors.end() - 1, target);
        const auto p = static_cast<std::size_t>(found - cumulative_factors.begin());
        const double before = p > 0 ? cumulative_factors[p - 1] : 0.0;
        const double factor = cumulative_factors[p] - before;
        if (!(factor > 0.0)) continue;
        square.x = std::clamp((target - before) / factor, 0.0, 1.0);
        const LightPanel& panel = source.panels[p];
        const Vec3 light = panel.point(square);
        const Vec3 way = light - receiver.position;
        const double r2 = glm::dot(way, way);
        const double here = glm::dot(way, receiver.normal), there = -glm::dot(way, panel.normal);
        if (!(here > 0.0) || !(there > 0.0)) continue; // the part of the source below the horizon
        rays.segments.push_back({receiver.position, light});
        rays.weights.push_back(here * there * panel.area() / (std::numbers::pi * r2 * r2 * factor));
    }
    rays.cast(occluders_);
    return rays.all > 0.0 ? rays.visible / rays.all : 1.0;
}

void DirectLight::irradiance(const Receiver& receiver, std::uint64_t stream, std::span<double> result) const {
    std::fill(result.begin(), result.end(), 0.0);
    thread_local std::vector<double> cumulative_factors;
    for (std::size_t s = 0; s < sources_.size(); ++s) {
        const Source& source = sources_[s];
        double factor = 0.0;
        cumulative_factors.clear();
        for (const LightPanel& panel : source.panels) {
            factor += point_to_panel(receiver.position, receiver.normal, panel);
            cumulative_factors.push_back(factor);
        }
        if (!(factor > 0.0)) continue;
        if (!occluders_.empty())
            factor *= visible_share(receiver, source, cumulative_factors,
                                    core::mix(core::mix(options_.seed, stream), s));
        for (std::size_t c = 0; c < result.size(); ++c) result[c] += factor * source.exitance[c];
    }
}

} // namespace kinelux::sample
