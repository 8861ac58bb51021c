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

constexpr std::size_t max_corners =
    32; ///< of a source's outline that are looked at; others have too many to be seen
constexpr double corner_inset = 1e-2; ///< of the way to the panel's centre: rays must not meet in its corners

/// Shadow rays of one receiver and what each stands for; kept by a thread between receivers to spare allocations.
struct Rays {
    std::vector<visibility::Segment> segments;
    std::vector<double> weights;
    std::vector<std::uint8_t> blocked;
    double visible = 0.0, all = 0.0; ///< sums of weights of the rays cast so far
    std::size_t hidden = 0, cast = 0;

    void reset() {
        visible = all = 0.0;
        hidden = cast = 0;
    }
    void add(const Receiver& receiver, const Vec3& light, double weight) {
        segments.push_back({receiver.position, light});
        weights.push_back(weight);
    }
    void trace(const visibility::Occluders& occluders) {
        blocked.resize(segments.size());
        occluders.occluded(segments, blocked);
        for (std::size_t i = 0; i < segments.size(); ++i) {
            all += weights[i];
            visible += blocked[i] != 0 ? 0.0 : weights[i];
            hidden += blocked[i];
        }
        cast += segments.size();
        segments.clear();
        weights.clear();
    }
    bool agree() const { return all > 0.0 && (hidden == 0 || hidden == cast); }
};

// cos+ cos'+ / (pi r^2) between a receiver and a point of a panel.
double exchange(const Receiver& receiver, const Vec3& light, const LightPanel& panel) {
    const Vec3 way = light - receiver.position;
    const double r2 = glm::dot(way, way);
    const double here = glm::dot(way, receiver.normal), there = -glm::dot(way, panel.normal);
    return here > 0.0 && there > 0.0 ? here * there / (std::numbers::pi * r2 * r2) : 0.0;
}

// Samples are drawn from the panels in proportion to what each sends unoccluded, evenly on its area, and weighted with
// the kernel over its mean on the panel: the weights' expectation is 1, and the ratio of sums is exact without shadow.
void add_sample(const Receiver& receiver, std::span<const LightPanel> panels,
                std::span<const double> cumulative_factors, Vec2 square, Rays& rays) {
    const double target = square.x * cumulative_factors.back();
    const auto found = std::upper_bound(cumulative_factors.begin(), cumulative_factors.end() - 1, target);
    const auto p = static_cast<std::size_t>(found - cumulative_factors.begin());
    const double before = p > 0 ? cumulative_factors[p - 1] : 0.0;
    const double factor = cumulative_factors[p] - before;
    if (!(factor > 0.0)) return;
    square.x = std::clamp((target - before) / factor, 0.0, 1.0);
    const Vec3 light = panels[p].point(square);
    const double kernel = exchange(receiver, light, panels[p]);
    if (kernel > 0.0) rays.add(receiver, light, kernel * panels[p].area() / factor);
}

// A straight shadow edge that cuts a convex source cuts off one of its corners: rays to the corners find most of the
// penumbra that few random rays miss. They only tell whether all is alike and have no weight.
void add_corners(const Receiver& receiver, std::span<const LightPanel> panels, Rays& rays) {
    std::size_t corners = 0;
    for (const LightPanel& panel : panels) corners += panel.outline.size();
    if (corners > max_corners) return;
    for (const LightPanel& panel : panels)
        for (const LightPanel::Edge& edge : panel.outline) {
            const Vec3 light = edge.from + corner_inset * (panel.centre - edge.from);
            if (exchange(receiver, light, panel) > 0.0) rays.add(receiver, light, 0.0);
        }
}

} // namespace

DirectLightOptions direct_light_options_for(const model::Scene& scene) {
    // A visible share found with n scrambled Sobol points is off by about n^(-3/4) where an edge cuts the source; half
    // the target is left for it.
    DirectLightOptions options;
    options.shadow_rays =
        static_cast<int>(std::clamp(std::pow(2.0 / scene.accuracy.target, 4.0 / 3.0), 32.0, 4096.0));
    return options;
}

DirectLight::DirectLight(std::span<const geometry::ElementShape> sources, const model::Scene& scene,
                         double time_s, const visibility::Occluders& occluders,
                         const DirectLightOptions& options)
    : occluders_(occluders), options_(options) {
    const auto exitances = model::exitances_at(scene, time_s);
    const auto shines = [](const std::vector<double>& exitance) {
        return std::any_of(exitance.begin(), exitance.end(), [](double value) { return value > 0.0; });
    };
    std::map<std::pair<ObjectId, MaterialId>, std::vector<const geometry::ElementShape*>> groups;
    for (const geometry::ElementShape& element : sources)
        if (shines(exitances[element.material.value]))
            groups[{element.object, element.material}].push_back(&element);
    for (const auto& [owner, elements] : groups)
        sources_.push_back({light_panels(elements), exitances[owner.second.value]});
}

double DirectLight::visible_share(const Receiver& receiver, const Source& source,
                                  std::span<const double> cumulative_factors, std::uint64_t seed) const {
    const Receiver start{receiver.ray_origin.value_or(receiver.position), receiver.normal};
    thread_local Rays rays;
    rays.reset();
    const auto probes = static_cast<std::uint32_t>(std::max(options_.probe_rays, 1));
    const auto limit = std::max(static_cast<std::uint32_t>(std::max(options_.shadow_rays, 1)), probes);
    add_corners(start, source.panels, rays);
    for (std::uint32_t i = 0; i < probes; ++i)
        add_sample(start, source.panels, cumulative_factors, core::sobol_2d(i, seed), rays);
    rays.trace(occluders_);
    if (!rays.agree()) {
        for (std::uint32_t i = probes; i < limit; ++i)
            add_sample(start, source.panels, cumulative_factors, core::sobol_2d(i, seed), rays);
        rays.trace(occluders_);
    }
    return rays.all > 0.0 ? rays.visible / rays.all : 1.0;
}

void DirectLight::irradiance(const Receiver& receiver, std::uint64_t stream, std::span<double> result,
                             std::span<Seen> seen) const {
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
        const double share = !(factor > 0.0) ? 0.0
                             : occluders_.empty()
                                 ? 1.0
                                 : visible_share(receiver, source, cumulative_factors,
                                                 core::mix(core::mix(options_.seed, stream), s));
        for (std::size_t c = 0; c < result.size(); ++c) result[c] += share * factor * source.exitance[c];
        if (!seen.empty()) seen[s] = share == 0.0 ? Seen::Nothing : share == 1.0 ? Seen::Whole : Seen::Partly;
    }
}

void DirectLight::irradiance_unshadowed(const Receiver& receiver, std::span<const Seen> seen,
                                        std::span<double> result) const {
    std::fill(result.begin(), result.end(), 0.0);
    for (std::size_t s = 0; s < sources_.size(); ++s) {
        if (seen[s] == Seen::Nothing) continue;
        double factor = 0.0;
        for (const LightPanel& panel : sources_[s].panels)
            factor += point_to_panel(receiver.position, receiver.normal, panel);
        for (std::size_t c = 0; c < result.size(); ++c) result[c] += factor * sources_[s].exitance[c];
    }
}

} // namespace kinelux::sample
