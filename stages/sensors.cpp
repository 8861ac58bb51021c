// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "cli/text.h"
#include "core/error.h"
#include "core/run_record.h"
#include "io/write_view.h"
#include "reference/exported.h"

namespace kinelux::stages {

namespace fs = std::filesystem;

namespace {

fs::path frame_file(const io::CaseFolder& folder, std::uint32_t frame) {
    return folder.file("frames") / fmt::format("frame_{:04}.vtu", frame);
}

std::vector<reference::SensorPoint> read_sensors(const fs::path& file) {
    std::ifstream in(file);
    if (!in)
        throw core::FileError(
            fmt::format("{}: cannot be read; name a file of lines x y z nx ny nz", file.string()));
    std::vector<reference::SensorPoint> points;
    std::size_t number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        if (line.find_first_not_of(" \t\r") == std::string::npos || line.starts_with('#')) continue;
        std::istringstream words(line);
        Vec3 x(0.0), n(0.0);
        words >> x.x >> x.y >> x.z >> n.x >> n.y >> n.z;
        const double length = glm::length(n);
        if (!words || !(length > 0.0) || !std::isfinite(length) || !(words >> std::ws).eof())
            throw core::FileError(fmt::format(
                "{}:{}: expected six numbers x y z nx ny nz, the normal not zero", file.string(), number));
        points.push_back({.object = {}, .triangle = 0, .position = x, .normal = n / length});
    }
    if (points.empty()) throw core::FileError(fmt::format("{}: holds no sensor", file.string()));
    return points;
}

/// Sensors from a file name no object: the first one that has an exported triangle there is theirs.
void look_up(const reference::ExportedField& field, std::size_t objects, bool object_known,
             std::vector<reference::SensorPoint>& points, std::vector<Judged>& judged) {
    for (std::size_t o = 0; o < (object_known ? 1 : objects); ++o) {
        if (!object_known)
            for (std::size_t p = 0; p < points.size(); ++p)
                if (!judged[p].exported) points[p].object = ObjectId(o);
        const auto values = reference::values_at(field, points, {});
        for (std::size_t p = 0; p < points.size(); ++p) {
            judged[p].exported = values[p];
            judged[p].point = points[p];
        }
    }
}

} // namespace

std::vector<std::uint32_t> frames_to_judge(const io::CaseFolder& folder, const model::Scene& scene,
                                           const std::optional<cli::FrameRange>& range) {
    std::vector<std::uint32_t> frames;
    for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame) {
        if ((range && !range->contains(frame)) || !fs::exists(frame_file(folder, frame))) continue;
        frames.push_back(frame);
        if (!range) break;
    }
    if (frames.empty())
        throw core::FileError(fmt::format("{}: no such frame; run kinelux-export {} first",
                                          folder.file("frames").string(), folder.path().string()));
    return frames;
}

std::vector<Judged> judge_frame(const io::CaseFolder& folder, const model::Scene& scene, std::uint32_t frame,
                                const SensorRequest& request) {
    const double time_s = scene.time.time_of_frame(frame);
    auto points = request.file.empty()
                      ? reference::sensor_points(scene, time_s, request.count, request.trace.seed)
                      : read_sensors(request.file);
    auto readings = reference::trace_irradiance(scene, time_s, points, request.trace);
    const io::ExportedFrame exported = io::read_frame(frame_file(folder, frame), scene.quantity);
    std::vector<Judged> judged(points.size());
    look_up({.points = exported.points,
             .triangles = exported.triangles,
             .objects = exported.objects,
             .values = exported.irradiance.values,
             .components = exported.irradiance.components},
            scene.objects.size(), request.file.empty(), points, judged);
    for (std::size_t p = 0; p < judged.size(); ++p) {
        judged[p].frame = frame;
        judged[p].reading = std::move(readings[p]);
    }
    return judged;
}

reference::Comparison compare(const std::vector<Judged>& judged) {
    std::vector<reference::SensorReading> readings;
    std::vector<std::optional<std::vector<double>>> values;
    for (const Judged& one : judged) {
        readings.push_back(one.reading);
        values.push_back(one.exported);
    }
    return reference::compare(readings, values);
}

void write_reference_csv(const fs::path& file, const model::Scene& scene, const std::vector<Judged>& judged) {
    const std::string unit = model::irradiance_unit(scene.quantity);
    std::string text = "frame,object,x,y,z,nx,ny,nz,channel,irradiance,standard_error,exported,unit\n";
    for (const Judged& one : judged) {
        const Vec3& x = one.point.position;
        const Vec3& n = one.point.normal;
        const std::string place = fmt::format("{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", one.frame,
                                              cli::csv_field(scene.objects[one.point.object.value].name), x.x,
                                              x.y, x.z, n.x, n.y, n.z);
        for (std::size_t c = 0; c < scene.channels.size(); ++c)
            text += fmt::format("{},{},{:.9g},{:.3g},{},{}\n", place, cli::csv_field(scene.channels[c]),
                                one.reading.irradiance[c], one.reading.standard_error[c],
                                one.exported ? fmt::format("{:.9g}", (*one.exported)[c]) : "", unit);
    }
    core::write_whole_file(file, text);
}

} // namespace kinelux::stages
