// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_scene.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <glm/geometric.hpp>

#include "core/error.h"
#include "core/log.h"
#include "io/mesh_import.h"
#include "io/scene_objects.h"
#include "io/scene_schema.h"

namespace kinelux::io {

namespace {

// Frames of a bare animated file: as films, but not more than a few minutes of work.
constexpr double bare_frames_per_second = 24.0;
constexpr double most_bare_frames = 240.0;

double metres_per(const std::string& unit) {
    const std::map<std::string, double> table{
        {"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}};
    return table.at(unit);
}

void warn_where_dark_or_still(const model::Scene& scene) {
    if (std::none_of(scene.materials.begin(), scene.materials.end(), [](const auto& m) { return m.emits(); }))
        core::log_warning(scene.source.string() + ": no material emits light; everything will be black");
    if ((!scene.motions.empty() || !scene.dimmings.empty()) && scene.time.frames == 1)
        core::log_warning(scene.source.string() +
                          ": something changes with time, but there is only one frame; set [time] frames");
}

void add_time(const SceneDocument& document, model::Scene& scene) {
    const SceneSection& section = document.one("time");
    scene.time.start_s = section.number("start_s").value_or(0.0);
    scene.time.end_s = section.number("end_s").value_or(scene.time.start_s);
    scene.time.frames = static_cast<std::uint32_t>(section.number("frames").value_or(1.0));
    if (scene.time.end_s < scene.time.start_s)
        document.fail(section.line_of("end_s"), "end_s is before start_s");
    if (scene.time.frames > 1 && scene.time.end_s == scene.time.start_s)
        document.fail(section.line_of("frames"), "several frames need an end_s later than start_s");
}

void add_settings(const SceneDocument& document, double metres, model::Scene& scene) {
    const SceneSection& accuracy = document.one("accuracy");
    scene.accuracy.target = accuracy.number("target").value_or(scene.accuracy.target);
    if (const auto degree = accuracy.number("degree")) scene.accuracy.degree = static_cast<int>(*degree);
    if (const auto size = accuracy.number("element_size")) scene.accuracy.element_size = metres * *size;

    const SceneSection& effects = document.one("effects");
    scene.effects.interreflection = effects.boolean("interreflection");
    scene.effects.static_occlusion = effects.boolean("static_occlusion");
    scene.effects.moving_occlusion = effects.boolean("moving_occlusion");

    const SceneSection& exported = document.one("export");
    if (const auto size = exported.number("cell_size")) scene.exported.cell_size = metres * *size;
    if (const auto frames = exported.numbers("frames")) {
        scene.exported.frames.emplace();
        for (const double frame : *frames) {
            if (frame >= scene.time.frames)
                document.fail(exported.line_of("frames"), "frame " + std::to_string(std::llround(frame)) +
                                                              " does not exist; the last one is " +
                                                              std::to_string(scene.time.frames - 1));
            scene.exported.frames->push_back(static_cast<std::uint32_t>(frame));
        }
    }
}

void add_view(const SceneDocument& document, double metres, model::Scene& scene) {
    const SceneSection& section = document.one("view");
    if (const auto eye = section.vec3("eye")) scene.view.eye = metres * *eye;
    if (const auto target = section.vec3("target")) scene.view.target = metres * *target;
    scene.view.up = section.vec3("up").value_or(scene.up);
    if (!(glm::length(scene.view.up) > 0.0)) document.fail(section.line_of("up"), "'up' has no direction");
    scene.view.field_of_view_deg = section.number("field_of_view_deg").value_or(scene.view.field_of_view_deg);
}

model::Scene read_scene_file(const std::filesystem::path& file, Outside outside) {
    const SceneDocument document = parse_scene_document(read_bytes(file), file);
    const FolderTree tree(std::filesystem::absolute(file).parent_path(), outside);
    const SceneSection& section = document.one("scene");
    model::Scene scene;
    scene.source = file;
    scene.title = section.text("title").value_or(file.stem().string());
    scene.quantity = section.text("quantity").value_or("radiometric") == "photometric"
                         ? model::Quantity::Photometric
                         : model::Quantity::Radiometric;
    scene.channels = section.texts("channels").value_or(std::vector<std::string>{"red", "green", "blue"});
    const std::set<std::string> distinct(scene.channels.begin(), scene.channels.end());
    if (distinct.size() != scene.channels.size())
        document.fail(section.line_of("channels"), "two channels have one name");

    const double metres = metres_per(section.text("length_unit").value_or("m"));
    SceneBuilder builder(document, tree, metres, scene);
    const std::optional<Vec3> stated_up = builder.read_meshes();
    scene.up = section.has("up_axis") ? axis_vector(*section.text("up_axis")) : stated_up.value_or(scene.up);
    add_time(document, scene);
    add_settings(document, metres, scene);
    add_view(document, metres, scene);
    builder.add_dimmings();
    builder.add_materials();
    builder.add_motions();
    builder.add_objects();
    builder.add_meters();
    builder.add_parents();
    builder.refuse_unused();
    return scene;
}

// From the first to the last keyframe.
model::TimeAxis time_of(const std::vector<model::Motion>& motions) {
    model::TimeAxis time;
    if (motions.empty()) return time;
    time.start_s = motions.front().keyframes.front().time_s;
    time.end_s = time.start_s;
    for (const model::Motion& motion : motions) {
        time.start_s = std::min(time.start_s, motion.keyframes.front().time_s);
        time.end_s = std::max(time.end_s, motion.keyframes.back().time_s);
    }
    const double frames = std::ceil((time.end_s - time.start_s) * bare_frames_per_second) + 1.0;
    time.frames = static_cast<std::uint32_t>(std::min(frames, most_bare_frames));
    return time;
}

model::Scene read_bare_mesh(const std::filesystem::path& file, Outside outside) {
    const FolderTree tree(std::filesystem::absolute(file).parent_path(), outside);
    model::Scene scene;
    scene.source = file;
    scene.title = file.stem().string();
    scene.channels = {"red", "green", "blue"};
    ImportedMeshes meshes = read_mesh_inside(file, scene.channels.size(), tree);
    for (const std::string& note : meshes.notes) core::log_info(file.string() + ": " + note);
    if (!meshes.unit_stated)
        core::log_info(file.string() + ": states no unit; its lengths are taken as metres");
    if (meshes.up != Vec3(0.0)) scene.up = meshes.up;
    scene.view.up = scene.up;

    Placement placement;
    placement.scale = meshes.metres_per_unit;
    placement.linear = Mat3(placement.scale);
    scene.materials = std::move(meshes.materials);
    scene.objects = std::move(meshes.objects);
    for (model::Object& object : scene.objects)
        for (Vec3& point : object.mesh.points) point = placement.point(point);
    for (const model::Motion& motion : meshes.motions) scene.motions.push_back(placed(motion, placement));
    scene.time = time_of(scene.motions);
    return scene;
}

} // namespace

model::Scene read_scene(const std::filesystem::path& file, const ReadSceneOptions& options) {
    const Outside outside = options.allow_outside ? Outside::Allowed : Outside::Refused;
    std::string extension = file.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    model::Scene scene =
        extension == ".toml" ? read_scene_file(file, outside) : read_bare_mesh(file, outside);
    try {
        model::check(scene);
    } catch (const core::OptionError& error) {
        throw core::OptionError(file.string() + ": " + error.what());
    } catch (const core::GeometryError& error) {
        throw core::GeometryError(file.string() + ": " + error.what());
    }
    warn_where_dark_or_still(scene);
    return scene;
}

} // namespace kinelux::io
