// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "core/vec.h"
#include "model/scene.h"
#include "model/surface_field.h"

namespace kinelux::io {

/// Writes view.pvd, frames/frame_NNNN.vtu and view.py into a folder, frame by frame. The .pvd and view.py are written
/// by finish(), so that they never name a frame that is not there.
class ViewWriter {
public:
    ViewWriter(std::filesystem::path folder, const model::Scene& scene);
    /// @param fields  of this mesh
    void write_frame(std::uint32_t frame, const model::DisplayMesh& mesh, const model::SurfaceFields& fields);
    void finish();

private:
    std::filesystem::path folder_;
    const model::Scene& scene_;
    struct Written {
        double time_s;
        std::string file;
    };
    std::vector<Written> written_;
    Vec3 low_, high_; ///< bounds over all frames written
    double exposure_ =
        0.0; ///< what radiosity is multiplied by for the Color array; of the first frame written
    double irradiance_high_ = 0.0; ///< end of view.py's colour map, over all frames written [W/m2 or lx]
};

/// meters.csv: frame,time_s,meter,quantity,channel,value,unit,error_estimate
void write_meters(const std::filesystem::path& file, std::span<const model::MeterReading> readings);

/// The exported triangles of one frame as read back from its .vtu, to judge what the user sees.
struct ExportedFrame {
    std::vector<Vec3> points;
    std::vector<model::Triangle> triangles;
    std::vector<std::uint32_t> objects; ///< one per triangle
    model::NamedArray irradiance;       ///< per point, one component per channel
};
ExportedFrame read_frame(const std::filesystem::path& vtu, model::Quantity quantity);

} // namespace kinelux::io
