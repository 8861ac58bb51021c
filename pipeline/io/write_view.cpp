// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/run_record.h"
#include "geometry/pose.h"
#include "io/case_views.h"
#include "io/view_script.h"
#include "io/vtk_mesh.h"

namespace kinelux::io {

namespace fs = std::filesystem;

namespace {

/// A linear value of 0.35 is shown as sRGB 0.63: brighter than middle grey, for rooms are mostly light walls.
constexpr double mean_shown = 0.35;
/// Below the knee colours are linear; above it they approach 1 without reaching it, so that lamps keep their hue.
constexpr double knee = 0.7;
/// Share of the points whose irradiance lies inside the colour map; the rest are spots beside lamps.
constexpr double map_quantile = 0.98;

VtkArray vtk_array(const model::NamedArray& array) {
    return {.name = array.name,
            .components = array.components,
            .component_names = array.component_names,
            .values = std::span<const float>(array.values)};
}

const model::NamedArray* find_array(const std::vector<model::NamedArray>& arrays, const std::string& name) {
    const auto found =
        std::find_if(arrays.begin(), arrays.end(), [&](const auto& a) { return a.name == name; });
    return found == arrays.end() ? nullptr : &*found;
}

double channel_mean(const model::NamedArray& array, std::size_t item) {
    double sum = 0.0;
    for (std::uint32_t c = 0; c < array.components; ++c)
        sum += static_cast<double>(array.values[item * array.components + c]);
    return sum / array.components;
}

/// Area mean of a point field over triangles that emit, or over those that do not.
double mean_over(const model::DisplayMesh& mesh, const std::vector<Vec3>& points,
                 const model::NamedArray& array, const model::Scene& scene, bool emitting) {
    double sum = 0.0, area = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (scene.materials.at(mesh.materials[t].value).emits() != emitting) continue;
        const auto& [a, b, c] = mesh.triangles[t];
        const double triangle_area =
            0.5 * glm::length(glm::cross(points[b] - points[a], points[c] - points[a]));
        area += triangle_area;
        sum +=
            triangle_area * (channel_mean(array, a) + channel_mean(array, b) + channel_mean(array, c)) / 3.0;
    }
    return area > 0.0 ? sum / area : 0.0;
}

/// Exposure that shows the mean radiosity of the surfaces that do not emit as mean_shown; where nothing is lit, that of
/// the lamps as 1.
double exposure_for(const model::DisplayMesh& mesh, const std::vector<Vec3>& points,
                    const model::NamedArray& radiosity, const model::Scene& scene) {
    const double lit = mean_over(mesh, points, radiosity, scene, false);
    if (lit > 0.0) return mean_shown / lit;
    const double lamps = mean_over(mesh, points, radiosity, scene, true);
    return lamps > 0.0 ? 1.0 / lamps : 1.0;
}

/// Linear to shown: soft clip above the knee, then the sRGB curve (IEC 61966-2-1), then 0..255.
std::uint8_t shown_value(double linear) {
    double x = std::isfinite(linear) ? std::max(linear, 0.0) : 0.0;
    if (x > knee) x = knee + (1.0 - knee) * (1.0 - std::exp(-(x - knee) / (1.0 - knee)));
    const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(encoded, 0.0, 1.0)));
}

/// shown_value at `steps` linear values from 0 to `end`, where it has reached its largest.
class ToneCurve {
public:
    ToneCurve() {
        for (std::size_t k = 0; k < table_.size(); ++k)
            table_[k] = shown_value(end * static_cast<double>(k) / static_cast<double>(table_.size() - 1));
    }
    std::uint8_t operator()(double linear) const {
        if (!(linear > 0.0)) return 0;
        if (linear < fine) return shown_value(linear); // the curve is steep here
        const double place = std::min(linear / end, 1.0) * static_cast<double>(table_.size() - 1);
        return table_[static_cast<std::size_t>(std::lround(place))];
    }

private:
    static constexpr double end = 4.0, fine = 0.02;
    std::array<std::uint8_t, 16384> table_{};
};

std::vector<std::uint8_t> colours(const model::NamedArray& radiosity, double exposure) {
    static const ToneCurve curve;
    std::vector<std::uint8_t> result(radiosity.values.size());
    for (std::size_t k = 0; k < result.size(); ++k)
        result[k] = curve(exposure * static_cast<double>(radiosity.values[k]));
    return result;
}

/// Value below which map_quantile of the points lie.
double high_value(const model::NamedArray& array) {
    std::vector<double> values(array.values.size() / std::max(array.components, 1u));
    if (values.empty()) return 0.0;
    for (std::size_t p = 0; p < values.size(); ++p) values[p] = channel_mean(array, p);
    const auto place =
        values.begin() + static_cast<std::ptrdiff_t>(map_quantile * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

std::vector<float> moved_normals(const model::DisplayMesh& mesh, const model::Scene& scene, double time_s) {
    const auto poses = geometry::object_poses(scene, time_s);
    std::vector<float> result;
    result.reserve(3 * mesh.normals.size());
    for (std::size_t p = 0; p < mesh.normals.size(); ++p) {
        const Vec3 normal = poses.at(mesh.point_objects[p]).direction(mesh.normals[p]);
        for (int axis = 0; axis < 3; ++axis) result.push_back(static_cast<float>(normal[axis]));
    }
    return result;
}

/// The numbers of what each triangle belongs to, as plain integers.
struct TriangleIds {
    std::vector<std::uint32_t> elements, objects, materials;

    explicit TriangleIds(const model::DisplayMesh& mesh) {
        for (const ElementId id : mesh.elements) elements.push_back(id.value);
        for (const ObjectId id : mesh.objects) objects.push_back(id.value);
        for (const MaterialId id : mesh.materials) materials.push_back(id.value);
    }
};

std::vector<VtkArray> id_arrays(const TriangleIds& ids, const model::DisplayMesh& mesh) {
    return {{.name = "PatchId", .values = std::span<const std::int32_t>(mesh.patches)},
            {.name = "ObjectId", .values = std::span<const std::uint32_t>(ids.objects)},
            {.name = "MaterialId", .values = std::span<const std::uint32_t>(ids.materials)},
            {.name = "ElementId", .values = std::span<const std::uint32_t>(ids.elements)},
            {.name = "ClusterId", .values = std::span<const std::int32_t>(mesh.clusters)},
            {.name = "ElementDegree", .values = std::span<const std::uint8_t>(mesh.degrees)}};
}

std::string csv_text(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

} // namespace

ViewWriter::ViewWriter(fs::path folder, const model::Scene& scene)
    : folder_(std::move(folder)),
      scene_(scene),
      low_(std::numeric_limits<double>::max()),
      high_(std::numeric_limits<double>::lowest()) {
    std::error_code failed;
    fs::create_directories(folder_ / "frames", failed);
    if (failed) throw core::FileError(fmt::format("{}: cannot be made", (folder_ / "frames").string()));
    // An export that does not finish must not leave an index over frames of two exports.
    fs::remove(folder_ / "view.pvd", failed);
}

void ViewWriter::write_frame(std::uint32_t frame, const model::DisplayMesh& mesh,
                             const model::SurfaceFields& fields) {
    const std::string radiosity_name = array_name("Radiosity", model::radiosity_unit(scene_.quantity));
    const std::string irradiance_name = array_name("Irradiance", model::irradiance_unit(scene_.quantity));
    VtkTriangles view{
        .points = fields.points,
        .triangles = mesh.triangles,
        .precision = PointPrecision::Single,
        .time_s = fields.time_s,
        .names = {{"ObjectNames", object_names(scene_)}, {"MaterialNames", material_names(scene_)}}};
    for (const auto& array : fields.point_arrays) view.point_arrays.push_back(vtk_array(array));

    std::vector<float> normals;
    if (find_array(fields.point_arrays, "Normals") == nullptr) {
        normals = moved_normals(mesh, scene_, fields.time_s);
        view.point_arrays.push_back(
            {.name = "Normals", .components = 3, .values = std::span<const float>(normals)});
    }
    std::vector<std::uint8_t> colour;
    const auto* radiosity = find_array(fields.point_arrays, radiosity_name);
    if (radiosity != nullptr && radiosity->components == 3) {
        if (exposure_ == 0.0) exposure_ = exposure_for(mesh, fields.points, *radiosity, scene_);
        colour = colours(*radiosity, exposure_);
        view.point_arrays.push_back({.name = "Color",
                                     .components = 3,
                                     .component_names = {"red", "green", "blue"},
                                     .values = std::span<const std::uint8_t>(colour)});
    }
    const TriangleIds ids(mesh);
    view.cell_arrays = id_arrays(ids, mesh);
    for (const auto& array : fields.cell_arrays) view.cell_arrays.push_back(vtk_array(array));

    const std::string file = fmt::format("frames/frame_{:04}.vtu", frame);
    write_vtk(folder_ / file, view);
    written_.push_back({fields.time_s, file});

    if (const auto* irradiance = find_array(fields.point_arrays, irradiance_name))
        irradiance_high_ = std::max(irradiance_high_, high_value(*irradiance));
    for (const Vec3& point : fields.points) {
        low_ = glm::min(low_, point);
        high_ = glm::max(high_, point);
    }
}

void ViewWriter::finish() {
    std::stable_sort(written_.begin(), written_.end(),
                     [](const Written& a, const Written& b) { return a.time_s < b.time_s; });
    std::string xml =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n";
    for (const Written& frame : written_)
        xml += fmt::format("    <DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>\n", frame.time_s,
                           frame.file);
    core::write_whole_file(folder_ / "view.py", view_script(scene_, {.low = low_,
                                                                     .high = high_,
                                                                     .irradiance_high = irradiance_high_,
                                                                     .exposure = exposure_}));
    core::write_whole_file(folder_ / "view.pvd", xml + "  </Collection>\n</VTKFile>\n");
}

void write_meters(const fs::path& file, std::span<const model::MeterReading> readings) {
    // {} of fmt is the shortest decimal that reads back as the same double.
    std::string text = "frame,time_s,meter,quantity,channel,value,unit,error_estimate\n";
    for (const auto& r : readings)
        text += fmt::format("{},{},{},{},{},{},{},{}\n", r.frame, r.time_s, csv_text(r.meter),
                            csv_text(r.quantity), csv_text(r.channel), r.value, csv_text(r.unit),
                            r.error_estimate);
    core::write_whole_file(file, text);
}

} // namespace kinelux::io
