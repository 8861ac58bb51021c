// SPDX-License-Identifier: GPL-3.0-or-later
#include "light_case.h"

#include <fmt/format.h>

#include "core/error.h"
#include "motion/exact_engine.h"
#include "solve/animation.h"

namespace kinelux::stages {

kernel::TransportOptions LightCase::transport_options(std::uint64_t seed) const {
    kernel::TransportOptions options = coefficients::transport_options_for(scene, plan, elements);
    options.seed = seed;
    return options;
}

std::vector<double> LightCase::areas() const {
    std::vector<double> areas;
    for (const geometry::ElementShape& element : elements) areas.push_back(element.area);
    return areas;
}

LightCase read_light_case(const io::CaseFolder& folder) {
    model::Scene scene = folder.read_scene();
    model::PatchSet patches = folder.read_patches();
    model::ClusterTree tree = folder.read_clusters();
    model::Plan plan = folder.read_plan();
    auto elements = geometry::element_shapes(patches, tree, plan.degree, plan.cluster_degree);
    visibility::Occluders occluders(visibility::bodies_of(patches, scene));
    return {.scene = std::move(scene),
            .patches = std::move(patches),
            .tree = std::move(tree),
            .plan = std::move(plan),
            .elements = std::move(elements),
            .occluders = std::move(occluders)};
}

std::vector<std::uint32_t> frames_of(const model::Scene& scene, const std::optional<cli::FrameRange>& range) {
    std::vector<std::uint32_t> frames;
    for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame)
        if (!range || range->contains(frame)) frames.push_back(frame);
    if (frames.empty())
        throw core::OptionError(fmt::format("--frames {},{}: the scene has frames 0 to {}", range->first,
                                            range->last, scene.time.frames - 1));
    return frames;
}

Groups groups_of(const LightCase& light, GroupBy by) {
    return groups_of(light.scene, light.patches, light.tree, by);
}

Groups groups_of(const model::Scene& scene, const model::PatchSet& patches, const model::ClusterTree& tree,
                 GroupBy by) {
    Groups groups;
    if (by == GroupBy::Object)
        for (const model::Object& object : scene.objects) groups.names.push_back(object.name);
    else {
        for (std::size_t p = 0; p < patches.patches.size(); ++p)
            groups.names.push_back(
                fmt::format("patch {} of {}", p, scene.objects[patches.patches[p].object.value].name));
        for (std::size_t c = 0; c < tree.clusters.size(); ++c)
            groups.names.push_back(
                fmt::format("cluster {} of {}", c, scene.objects[tree.clusters[c].object.value].name));
    }
    for (const model::Element& element : tree.elements) {
        if (by == GroupBy::Object)
            groups.group_of.push_back(element.object.value);
        else if (element.patch)
            groups.group_of.push_back(element.patch->value);
        else
            groups.group_of.push_back(static_cast<std::uint32_t>(patches.patches.size()) +
                                      element.cluster->value);
    }
    return groups;
}

std::vector<double> row_sums(std::span<const coefficients::FormFactor> factors, std::size_t groups) {
    std::vector<double> sums(groups, 0.0);
    for (const coefficients::FormFactor& factor : factors) sums[factor.from] += factor.value;
    return sums;
}

model::Coefficients coefficients_at(model::Coefficients coefficients, LightCase& light, std::uint32_t frame,
                                    std::uint64_t seed) {
    motion::ExactEngine engine(coefficients, light.elements, light.plan, light.occluders,
                               light.transport_options(seed));
    const double time_s = light.scene.time.time_of_frame(frame);
    coefficients.static_blocks = solve::blocks_at(
        coefficients.static_blocks, engine.advance(time_s, geometry::object_poses(light.scene, time_s)));
    return coefficients;
}

} // namespace kinelux::stages
