// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "cli/option_table.h"
#include "io/case_folder.h"
#include "light_case.h"
#include "model/solution.h"
#include "model/surface_field.h"
#include "sample/sampler.h"
#include "sample/shadow_mesh.h"

namespace kinelux::stages {

/// Frames of a solution to write: those the scene names (nothing: all), inside a range (nothing: all).
/// @throws OptionError  none is left
std::set<std::uint32_t> exported_frames(const model::Scene& scene, const model::Solution& solution,
                                        const std::optional<cli::FrameRange>& range);

/// How finely fields are shown.
struct DisplayOptions {
    double cell_size = 0.0;            ///< largest edge of a triangle [m]
    sample::ShadowMeshOptions shadows; ///< smallest_edge >= cell_size: the same triangles in all frames
    sample::DirectLightOptions direct;
    sample::IndirectLight indirect = sample::IndirectLight::Solution;
};

struct Exported {
    std::uint64_t frames = 0;
    std::uint64_t cells = 0, points = 0;     ///< most of any frame
    double unresolved_area = 0.0;            ///< most of any frame [m2]; see sample::ShadowMesh
    std::vector<model::MeterReading> meters; ///< of all frames of the solution
};

/// Writes view.pvd, the frames and view.py; reads the meters of every frame.
Exported export_frames(LightCase& light, const model::Solution& solution,
                       const std::set<std::uint32_t>& written, const DisplayOptions& options,
                       const io::CaseFolder& folder);

} // namespace kinelux::stages
