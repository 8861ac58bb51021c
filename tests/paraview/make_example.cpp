// SPDX-License-Identifier: GPL-3.0-or-later
// make_example FOLDER [CELLS]: writes a case of a floor and a lamp that moves above it, with a view of three frames whose
// values are known in closed form; the scripts beside this file check what ParaView makes of it.
#include <cstdio>
#include <cstdlib>

#include "geometry/pose.h"
#include "io/case_folder.h"
#include "io/example_case.h"
#include "io/write_view.h"

namespace {

using namespace kinelux;

/// A square of cells x cells x 2 triangles in the plane z = height.
void add_square(model::DisplayMesh& mesh, ObjectId object, MaterialId material, double size, double height,
                int cells) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    const bool up = object == ObjectId(0);
    for (int v = 0; v <= cells; ++v)
        for (int u = 0; u <= cells; ++u) {
            mesh.points.emplace_back(size * u / cells, size * v / cells, height);
            mesh.normals.emplace_back(0.0, 0.0, up ? 1.0 : -1.0);
            mesh.point_objects.push_back(object.value);
        }
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        mesh.triangles.push_back(up ? model::Triangle{a, b, c} : model::Triangle{a, c, b});
        mesh.elements.emplace_back(object.value);
        mesh.objects.push_back(object);
        mesh.materials.push_back(material);
        mesh.patches.push_back(up ? 0 : -1);
        mesh.clusters.push_back(up ? -1 : 0);
        mesh.degrees.push_back(up ? 2 : 0);
    };
    const auto row = static_cast<std::uint32_t>(cells + 1);
    for (std::uint32_t v = 0; v + 1 < row; ++v)
        for (std::uint32_t u = 0; u + 1 < row; ++u) {
            const std::uint32_t corner = first + v * row + u;
            add(corner, corner + 1, corner + row + 1);
            add(corner, corner + row + 1, corner + row);
        }
}

model::NamedArray array(const std::string& name, const std::vector<std::string>& channels) {
    return {.name = name,
            .components = static_cast<std::uint32_t>(channels.size()),
            .component_names = channels,
            .values = {}};
}

/// Irradiance 200 / (1 + d^2) lx under the lamp, d the horizontal distance from its corner; the lamp emits.
model::SurfaceFields fields(const model::DisplayMesh& mesh, const model::Scene& scene, double time_s) {
    model::SurfaceFields result;
    result.time_s = time_s;
    const auto poses = geometry::object_poses(scene, time_s);
    const Vec3 lamp = poses[1].point({0.0, 0.0, 0.0});
    auto irradiance = array("Irradiance_lx", scene.channels);
    auto radiosity = array("Radiosity_lm_m2", scene.channels);
    auto error = array("ErrorEstimate_lx", {"value"});
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const std::uint32_t object = mesh.point_objects[p];
        result.points.push_back(poses[object].point(mesh.points[p]));
        const double dx = result.points[p].x - lamp.x, dy = result.points[p].y - lamp.y;
        const model::Material& material = scene.materials[object];
        for (std::size_t c = 0; c < scene.channels.size(); ++c) {
            const double E = object == 0 ? 200.0 / (1.0 + dx * dx + dy * dy) : 0.0;
            irradiance.values.push_back(static_cast<float>(E));
            radiosity.values.push_back(
                static_cast<float>(material.exitance[c] + material.reflectance[c] * E));
        }
        error.values.push_back(0.5f);
    }
    result.point_arrays = {irradiance, radiosity, error};
    return result;
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fputs("usage: make_example FOLDER [CELLS]\n", stderr);
        return 2;
    }
    const int cells = argc > 2 ? std::atoi(argv[2]) : 16;
    const io::CaseFolder folder(argv[1], true);
    model::Scene scene = support::example_scene();
    scene.view.target.reset();
    folder.write_scene(scene);
    folder.write_patches(support::example_patches(), scene);
    folder.write_clusters(support::example_clusters(), support::example_patches());
    model::DisplayMesh mesh;
    add_square(mesh, ObjectId(0), MaterialId(0), 2.0, 0.0, cells);
    add_square(mesh, ObjectId(1), MaterialId(1), 0.5, 1.5, 4);
    io::ViewWriter writer(folder.path(), scene);
    for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame)
        writer.write_frame(frame, mesh, fields(mesh, scene, scene.time.time_of_frame(frame)));
    writer.finish();
    return 0;
}
