// SPDX-License-Identifier: GPL-3.0-or-later
#include "engines.h"

#include <algorithm>
#include <vector>

#include "motion/exact_engine.h"
#include "motion/offline_engine.h"
#include "motion/online_engine.h"
#include "motion/paper_engine.h"
#include "solve/animation.h"

namespace kinelux::stages {

namespace {

constexpr double share_of_motion = 0.25; ///< of the accuracy asked for
constexpr std::size_t few_frames = 8;    ///< up to so many interpolation gains nothing

// From the light of three frames with coarse blocks.
motion::Importance importance(LightCase& light, const model::Coefficients& blocks,
                              std::span<const double> areas, std::span<const std::uint32_t> frames,
                              const kernel::TransportOptions& options) {
    constexpr double coarse = 0.05;
    kernel::TransportOptions rough = options;
    rough.tolerance = std::max(rough.tolerance, coarse);
    rough.sight_tolerance = std::max(rough.sight_tolerance, coarse);
    motion::ExactEngine engine(blocks, light.elements, light.plan, light.occluders, rough);
    std::vector<std::uint32_t> few{frames.front(), frames[frames.size() / 2], frames.back()};
    few.erase(std::unique(few.begin(), few.end()), few.end());
    return solve::importance_of({light.scene, light.plan, blocks, light.tree.elements, areas}, engine, few);
}

std::vector<MaterialId> emitting(const model::Scene& scene) {
    std::vector<MaterialId> result;
    for (std::size_t m = 0; m < scene.materials.size(); ++m)
        if (scene.materials[m].emits()) result.push_back(MaterialId(m));
    return result;
}

motion::PaperOptions paper_options(const std::string& shadows, const model::Scene& scene) {
    motion::PaperOptions options;
    options.occlusion =
        shadows == "exact" ? motion::PaperOcclusion::Exact : motion::PaperOcclusion::Publication;
    if (shadows == "publication") options.sources = emitting(scene);
    return options;
}

motion::PosePath path_of(const model::Scene& scene, std::span<const std::uint32_t> frames) {
    motion::PosePath path;
    for (const std::uint32_t frame : frames) {
        path.times_s.push_back(scene.time.time_of_frame(frame));
        path.poses.push_back(geometry::object_poses(scene, path.times_s.back()));
    }
    return path;
}

} // namespace

void add_engine_options(EngineOptions& options, cli::OptionTable& table) {
    table.add(
        {.member = &options.name,
         .flags = "--engine",
         .help = "how blocks change when bodies move: integrated anew, continued from frame to frame, "
                 "polynomials in time, or by the publication's series; auto: offline for more than 8 frames, "
                 "else exact",
         .words = {"auto", "exact", "online", "offline", "paper"}});
    table.add({.member = &options.paper_shadows,
               .flags = "--paper-shadows",
               .help =
                   "of --engine paper, in the light that is reflected on: as published, but exact where a "
                   "source is at one end; exact everywhere; or as published at sources too",
               .words = {"publication", "exact", "sources-too"}});
}

NamedEngine make_engine(const EngineOptions& wanted, LightCase& light, const model::Coefficients& blocks,
                        std::span<const double> areas, std::span<const std::uint32_t> frames,
                        std::uint64_t seed) {
    const bool many = !light.plan.moving_objects.empty() && frames.size() > few_frames;
    const std::string chosen = wanted.name == "auto" ? (many ? "offline" : "exact") : wanted.name;
    const kernel::TransportOptions options = light.transport_options(seed);
    if (chosen == "exact")
        return {chosen, std::make_unique<motion::ExactEngine>(blocks, light.elements, light.plan,
                                                              light.occluders, options)};
    if (chosen == "paper")
        return {chosen, std::make_unique<motion::PaperEngine>(
                            blocks, light.elements, light.plan, light.occluders, options,
                            paper_options(wanted.paper_shadows, light.scene))};
    const motion::Importance weights = importance(light, blocks, areas, frames, options);
    const double tolerance = share_of_motion * light.scene.accuracy.target;
    if (chosen == "online")
        return {chosen,
                std::make_unique<motion::OnlineEngine>(blocks, light.elements, light.plan, light.occluders,
                                                       options, weights, tolerance, motion::Watched::Listed)};
    return {chosen, std::make_unique<motion::OfflineEngine>(
                        blocks, light.elements, light.plan, light.occluders, options,
                        path_of(light.scene, frames), weights, tolerance)};
}

void report_engine(const NamedEngine& engine, cli::Stage& stage) {
    stage.record().set("engine", engine.name);
    if (engine.name == "exact" || engine.name == "paper") return;
    stage.count("blocks integrated beforehand", engine.engine->prepared());
    stage.figure("memory of motion", static_cast<double>(engine.engine->bytes()) / (1024.0 * 1024.0), "MiB");
}

} // namespace kinelux::stages
