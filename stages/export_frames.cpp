// SPDX-License-Identifier: GPL-3.0-or-later
#include "export_frames.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"
#include "core/log.h"
#include "geometry/pose.h"
#include "io/write_view.h"

namespace kinelux::stages {

std::set<std::uint32_t> exported_frames(const model::Scene& scene, const model::Solution& solution,
                                        const std::optional<cli::FrameRange>& range) {
    std::set<std::uint32_t> frames;
    for (const model::FrameSolution& frame : solution.frames) {
        const auto& named = scene.exported.frames;
        const bool wanted = !named || std::find(named->begin(), named->end(), frame.frame) != named->end();
        if (wanted && (!range || range->contains(frame.frame))) frames.insert(frame.frame);
    }
    if (frames.empty())
        throw core::OptionError(
            "no frame to export: the solution, the scene's [export] and --frames have none in common");
    return frames;
}

Exported export_frames(LightCase& light, const model::Solution& solution,
                       const std::set<std::uint32_t>& written, const DisplayOptions& options,
                       const io::CaseFolder& folder) {
    Exported exported;
    const model::DisplayMesh rest =
        sample::display_mesh(light.elements, light.patches, light.tree, options.cell_size);
    io::ViewWriter writer(folder.path(), light.scene);
    const auto write = [&](const model::FrameSolution& frame, std::span<const geometry::Pose> poses) {
        const auto [mesh, unresolved_area] =
            sample::shadow_mesh(rest, light.patches, light.elements, light.scene, frame.time_s, poses,
                                light.occluders, options.direct, options.shadows);
        const sample::SurfaceSampler sampler(mesh, light.elements, light.scene, light.occluders.end_offset());
        writer.write_frame(
            frame.frame, mesh,
            sampler.fields(solution.layout, frame, poses, light.occluders, options.direct, options.indirect));
        ++exported.frames;
        exported.cells = std::max<std::uint64_t>(exported.cells, mesh.triangles.size());
        exported.points = std::max<std::uint64_t>(exported.points, mesh.points.size());
        exported.unresolved_area = std::max(exported.unresolved_area, unresolved_area);
    };
    core::Progress progress("export", solution.frames.size());
    for (const model::FrameSolution& frame : solution.frames) {
        cli::Stage::throw_if_stopped();
        const auto poses = geometry::object_poses(light.scene, frame.time_s);
        light.occluders.set_poses(poses);
        if (written.contains(frame.frame)) write(frame, poses);
        const auto readings = sample::meter_readings(light.elements, light.scene, solution.layout, frame,
                                                     poses, light.occluders, options.direct);
        exported.meters.insert(exported.meters.end(), readings.begin(), readings.end());
        progress.advance(1, fmt::format("frame {}", frame.frame));
    }
    writer.finish();
    return exported;
}

} // namespace kinelux::stages
