// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/case_views.h"

#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>

#include "core/error.h"
#include "core/hash.h"
#include "core/run_record.h"
#include "geometry/surface.h"
#include "io/vtk_mesh.h"

namespace kinelux::io {

namespace fs = std::filesystem;

namespace {

using Integers = std::vector<std::int32_t>;

VtkArray integers(const std::string& name, const Integers& values) {
    return {.name = name, .values = std::span<const std::int32_t>(values)};
}

std::string file_name_of(const std::string& object) {
    constexpr std::size_t longest = 80; // file systems end at 255 bytes
    std::string name;
    for (const char c : object.substr(0, longest)) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = byte < 128 && (std::isalnum(byte) != 0 || c == '.' || c == '_' || c == '-');
        name += plain ? c : '_';
    }
    if (name.empty()) name = "object";
    if (name.front() == '.') name.front() = '_';
    return name;
}

std::string lower_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// One value per channel and triangle, of the triangle's material.
std::vector<double> material_values(const model::Scene& scene, const model::Mesh& mesh,
                                    std::vector<double> model::Material::*values) {
    std::vector<double> result;
    result.reserve(mesh.triangles.size() * scene.channels.size());
    for (const MaterialId id : mesh.materials) {
        const auto& of_material = scene.materials.at(id.value).*values;
        result.insert(result.end(), of_material.begin(), of_material.end());
    }
    return result;
}

void write_clean_mesh(const fs::path& file, const model::Mesh& mesh, const model::Scene& scene) {
    std::vector<std::uint32_t> materials, source_faces = mesh.source_faces;
    for (const MaterialId id : mesh.materials) materials.push_back(id.value);
    std::vector<std::uint8_t> two_sided = mesh.two_sided;
    two_sided.resize(mesh.triangles.size(), 0);
    for (std::size_t t = source_faces.size(); t < mesh.triangles.size(); ++t)
        source_faces.push_back(static_cast<std::uint32_t>(t));
    const auto reflectance = material_values(scene, mesh, &model::Material::reflectance);
    const auto exitance = material_values(scene, mesh, &model::Material::exitance);
    const auto channels = static_cast<std::uint32_t>(scene.channels.size());
    const std::string exitance_name = array_name("Exitance", model::radiosity_unit(scene.quantity));
    write_vtk(file,
              {.points = mesh.points,
               .triangles = mesh.triangles,
               .cell_arrays = {{.name = "MaterialId", .values = std::span<const std::uint32_t>(materials)},
                               {.name = "SourceFace", .values = std::span<const std::uint32_t>(source_faces)},
                               {.name = "TwoSided", .values = std::span<const std::uint8_t>(two_sided)},
                               {.name = "Reflectance",
                                .components = channels,
                                .component_names = scene.channels,
                                .values = std::span<const double>(reflectance)},
                               {.name = exitance_name,
                                .components = channels,
                                .component_names = scene.channels,
                                .values = std::span<const double>(exitance)}},
               .names = {{"MaterialNames", material_names(scene)}}});
}

/// The index over all objects; ParaView shows each as a block with its name.
std::string multi_block_xml(const model::Scene& scene, const std::vector<MeshFile>& meshes) {
    std::string xml = "<?xml version=\"1.0\"?>\n"
                      "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
                      "  <vtkMultiBlockDataSet>\n";
    for (std::size_t o = 0; o < meshes.size(); ++o)
        xml += fmt::format("    <DataSet index=\"{}\" name=\"{}\" file=\"{}\"/>\n", o,
                           xml_escaped(valid_utf8(scene.objects[o].name)), xml_escaped(meshes[o].path));
    return xml + "  </vtkMultiBlockDataSet>\n</VTKFile>\n";
}

void remove_other_meshes(const fs::path& folder, const std::vector<MeshFile>& meshes) {
    for (const auto& entry : fs::directory_iterator(folder / "clean")) {
        const std::string path = "clean/" + entry.path().filename().string();
        const bool ours =
            std::any_of(meshes.begin(), meshes.end(), [&](const auto& mesh) { return mesh.path == path; });
        if (!ours && entry.path().extension() == ".vtp") fs::remove(entry.path());
    }
}

/// Triangles with the numbers of what they belong to, collected piece by piece.
struct Collected {
    std::vector<Vec3> points;
    std::vector<model::Triangle> triangles;
    Integers elements, patches, clusters, objects, materials, types;
    std::vector<double> deviations;

    /// Adds triangles over `corners`, all of whose indices count from the first of them.
    void add(std::span<const Vec3> corners, std::span<const model::Triangle> indices) {
        const auto first = static_cast<std::uint32_t>(points.size());
        points.insert(points.end(), corners.begin(), corners.end());
        for (const auto& [a, b, c] : indices) triangles.push_back({first + a, first + b, first + c});
    }
};

void add_patch(Collected& view, std::int32_t number, const model::Patch& patch) {
    std::vector<Vec3> corners;
    corners.reserve(patch.points.size());
    for (const Vec2& uv : patch.points) corners.push_back(geometry::position(patch.surface, uv));
    view.add(corners, patch.triangles);
    const std::size_t count = view.triangles.size();
    view.patches.resize(count, number);
    view.objects.resize(count, static_cast<std::int32_t>(patch.object.value));
    view.materials.resize(count, static_cast<std::int32_t>(patch.material.value));
    view.types.resize(count, static_cast<std::int32_t>(patch.surface.type));
    view.deviations.resize(count, patch.deviation_max);
}

void add_small(Collected& view, const model::SmallTriangles& small) {
    view.add(small.points, small.triangles);
    for (const ObjectId id : small.objects) view.objects.push_back(static_cast<std::int32_t>(id.value));
    for (const MaterialId id : small.materials) view.materials.push_back(static_cast<std::int32_t>(id.value));
    view.patches.resize(view.triangles.size(), -1);
    view.types.resize(view.triangles.size(), -1);
    view.deviations.resize(view.triangles.size(), 0.0);
}

constexpr model::Triangle one_triangle{0, 1, 2};

void add_element(Collected& view, std::int32_t number, const model::Element& element,
                 const model::ClusterTree& tree, const model::PatchSet& patches) {
    if (element.patch) {
        const model::Surface& surface = patches.patches.at(element.patch->value).surface;
        for (std::uint32_t t = 0; t < element.triangle_count; ++t) {
            std::array<Vec3, 3> corners;
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] =
                    geometry::evaluate(surface, tree.domain_triangles.at(element.first_triangle + t)[k])
                        .position;
            view.add(corners, std::span(&one_triangle, 1));
        }
    } else if (element.cluster) {
        for (const std::uint32_t t : tree.clusters.at(element.cluster->value).triangles) {
            const auto& [a, b, c] = patches.small.triangles.at(t);
            const std::array corners{patches.small.points.at(a), patches.small.points.at(b),
                                     patches.small.points.at(c)};
            view.add(corners, std::span(&one_triangle, 1));
        }
    }
    const std::size_t count = view.triangles.size();
    view.elements.resize(count, number);
    view.patches.resize(count, element.patch ? static_cast<std::int32_t>(element.patch->value) : -1);
    view.clusters.resize(count, element.cluster ? static_cast<std::int32_t>(element.cluster->value) : -1);
    view.objects.resize(count, static_cast<std::int32_t>(element.object.value));
    view.materials.resize(count, static_cast<std::int32_t>(element.material.value));
}

} // namespace

std::vector<std::string> object_file_names(const model::Scene& scene) {
    std::set<std::string> taken;
    std::vector<std::string> names;
    for (const model::Object& object : scene.objects) {
        const std::string wanted = file_name_of(object.name);
        std::string name = wanted;
        for (int copy = 2; !taken.insert(lower_case(name)).second; ++copy)
            name = fmt::format("{}_{}", wanted, copy);
        names.push_back(name);
    }
    return names;
}

std::vector<MeshFile> write_clean_meshes(const fs::path& folder, const model::Scene& scene) {
    std::error_code failed;
    fs::create_directories(folder / "clean", failed);
    if (failed) throw core::FileError(fmt::format("{}: cannot be made", (folder / "clean").string()));
    std::vector<MeshFile> meshes;
    for (const std::string& name : object_file_names(scene)) {
        const std::string path = "clean/" + name + ".vtp";
        write_clean_mesh(folder / path, scene.objects[meshes.size()].mesh, scene);
        meshes.push_back({path, core::file_hash(folder / path)});
    }
    core::write_whole_file(folder / "clean.vtm", multi_block_xml(scene, meshes));
    remove_other_meshes(folder, meshes);
    return meshes;
}

model::Mesh read_clean_mesh(const fs::path& file) {
    VtkContent content = read_vtk(file, {.cell_arrays = {"MaterialId", "SourceFace", "TwoSided"}});
    model::Mesh mesh;
    mesh.points = std::move(content.points);
    mesh.triangles = std::move(content.triangles);
    for (const std::uint32_t id : content.cell_arrays[0].values) mesh.materials.emplace_back(id);
    mesh.source_faces = std::move(content.cell_arrays[1].values);
    for (const std::uint32_t flag : content.cell_arrays[2].values)
        mesh.two_sided.push_back(static_cast<std::uint8_t>(flag));
    return mesh;
}

void write_patches_view(const fs::path& file, const model::PatchSet& patches, const model::Scene& scene) {
    Collected view;
    for (std::size_t p = 0; p < patches.patches.size(); ++p)
        add_patch(view, static_cast<std::int32_t>(p), patches.patches[p]);
    add_small(view, patches.small);
    write_vtk(file,
              {.points = view.points,
               .triangles = view.triangles,
               .cell_arrays = {integers("PatchId", view.patches),
                               integers("ObjectId", view.objects),
                               integers("MaterialId", view.materials),
                               integers("SurfaceType", view.types),
                               {.name = "Deviation_m", .values = std::span<const double>(view.deviations)}},
               .names = {{"ObjectNames", object_names(scene)},
                         {"MaterialNames", material_names(scene)},
                         {"SurfaceTypeNames",
                          {"plane", "cylinder", "cone", "sphere", "torus", "B-spline", "bilinear"}}}});
}

void write_clusters_view(const fs::path& file, const model::ClusterTree& tree, const model::PatchSet& patches,
                         const model::Scene& scene) {
    Collected view;
    for (std::size_t e = 0; e < tree.elements.size(); ++e)
        add_element(view, static_cast<std::int32_t>(e), tree.elements[e], tree, patches);
    write_vtk(file,
              {.points = view.points,
               .triangles = view.triangles,
               .cell_arrays = {integers("ElementId", view.elements), integers("PatchId", view.patches),
                               integers("ClusterId", view.clusters), integers("ObjectId", view.objects),
                               integers("MaterialId", view.materials)},
               .names = {{"ObjectNames", object_names(scene)}, {"MaterialNames", material_names(scene)}}});
}

std::vector<std::string> object_names(const model::Scene& scene) {
    std::vector<std::string> names;
    for (const model::Object& object : scene.objects) names.push_back(valid_utf8(object.name));
    return names;
}

std::vector<std::string> material_names(const model::Scene& scene) {
    std::vector<std::string> names;
    for (const model::Material& material : scene.materials) names.push_back(valid_utf8(material.name));
    return names;
}

std::string array_name(const std::string& quantity, const std::string& unit) {
    std::string name = quantity + "_" + unit;
    std::replace(name.begin(), name.end(), '/', '_');
    return name;
}

} // namespace kinelux::io
