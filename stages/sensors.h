// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/option_table.h"
#include "io/case_folder.h"
#include "model/scene.h"
#include "reference/reference.h"

namespace kinelux::stages {

/// Numbers of the exported frames of a case inside a range (nothing: the first one only).
/// @throws FileError  there is none
std::vector<std::uint32_t> frames_to_judge(const io::CaseFolder& folder, const model::Scene& scene,
                                           const std::optional<cli::FrameRange>& range);

/// Where the exported irradiance is judged, what the reference says there, and what was exported.
struct Judged {
    std::uint32_t frame = 0;
    reference::SensorPoint point;
    reference::SensorReading reading;
    std::optional<std::vector<double>> exported; ///< per channel; nothing: no exported triangle there
};

struct SensorRequest {
    std::uint32_t count = 0;    ///< points to spread over the scene
    std::filesystem::path file; ///< lines "x y z nx ny nz" [m]; empty: spread
    reference::ReferenceOptions trace;
};

/// Traces one frame's sensor points and looks the exported values up. @throws FileError  a line of the sensor file that
/// is not six numbers (file:line)
std::vector<Judged> judge_frame(const io::CaseFolder& folder, const model::Scene& scene, std::uint32_t frame,
                                const SensorRequest& request);

/// How far what was exported is from the reference, all frames together.
reference::Comparison compare(const std::vector<Judged>& judged);

/// reference.csv: frame,object,x,y,z,nx,ny,nz,channel,irradiance,standard_error,exported,unit
void write_reference_csv(const std::filesystem::path& file, const model::Scene& scene,
                         const std::vector<Judged>& judged);

} // namespace kinelux::stages
