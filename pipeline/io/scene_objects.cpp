// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scene_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

#include "core/error.h"
#include "core/log.h"

namespace kinelux::io {

namespace {

std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
}

// Number of the first point at the same place, for each point.
std::vector<std::uint32_t> welded(const model::Mesh& mesh) {
    std::map<std::array<double, 3>, std::uint32_t> first;
    std::vector<std::uint32_t> result;
    for (const Vec3& p : mesh.points)
        result.push_back(
            first.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(result.size())).first->second);
    return result;
}

// For each triangle, whether the connected part that it belongs to has no free edge.
std::vector<std::uint8_t> closed_parts(const model::Mesh& mesh) {
    const std::vector<std::uint32_t> point = welded(mesh);
    std::vector<std::uint32_t> parents(mesh.points.size());
    std::iota(parents.begin(), parents.end(), 0U);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const model::Triangle& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = point[t[i]], b = point[t[(i + 1) % 3]];
            parents[root_of(parents, a)] = root_of(parents, b);
            ++edges[std::minmax(a, b)];
        }
    std::vector<std::uint8_t> closed(mesh.points.size(), 1);
    for (const auto& [edge, count] : edges)
        if (count < 2) closed[root_of(parents, edge.first)] = 0;
    std::vector<std::uint8_t> result;
    for (const model::Triangle& t : mesh.triangles) result.push_back(closed[root_of(parents, point[t[0]])]);
    return result;
}

std::string names_in(const std::vector<std::string>& names) {
    return names.empty() ? "none" : short_list(names);
}

std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
    const auto meant = nearest(word, known);
    return meant ? "; did you mean '" + *meant + "'?" : "";
}

} // namespace

Vec3 axis_vector(const std::string& name) {
    return {name == "x" ? 1.0 : 0.0, name == "y" ? 1.0 : 0.0, name == "z" ? 1.0 : 0.0};
}

Mat3 turn_between(const Vec3& from, const Vec3& to) {
    if (from == to) return Mat3(1.0);
    const Vec3 axis = glm::cross(from, to); // of length 1: a quarter turn about it
    Mat3 turn(0.0);
    for (int c = 0; c < 3; ++c) {
        Vec3 unit{0.0};
        unit[c] = 1.0;
        turn[c] = glm::cross(axis, unit) + axis * axis[c];
    }
    return turn;
}

model::Motion placed(const model::Motion& motion, const Placement& placement) {
    model::Motion result = motion;
    result.pivot = placement.point(motion.pivot);
    const auto turned = [&](const Quat& value) {
        return placement.rotation * value * glm::conjugate(placement.rotation);
    };
    for (model::Keyframe& key : result.keyframes) {
        key.translation = placement.linear * key.translation;
        key.rotation = turned(key.rotation);
        if (key.turn) key.turn = placement.rotation * *key.turn;
        if (!key.tangents) continue;
        for (Vec3* tangent : {&key.tangents->translation_in, &key.tangents->translation_out})
            *tangent = placement.linear * *tangent;
        for (Quat* tangent : {&key.tangents->rotation_in, &key.tangents->rotation_out})
            *tangent = turned(*tangent);
    }
    return result;
}

double emitting_area(const model::Mesh& mesh, const std::vector<model::Material>& materials) {
    const std::vector<std::uint8_t> closed = closed_parts(mesh);
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const model::Triangle& corners = mesh.triangles[t];
        const Vec3& origin = mesh.points[corners[0]];
        const double area =
            0.5 * glm::length(glm::cross(mesh.points[corners[1]] - origin, mesh.points[corners[2]] - origin));
        const model::Sides sides = materials[mesh.materials[t].value].sides;
        const bool both = sides == model::Sides::Both || (sides == model::Sides::Auto && closed[t] == 0);
        sum += both ? 2.0 * area : area;
    }
    return sum;
}

void append(model::Mesh& mesh, const model::Mesh& part) {
    const auto base = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), part.points.begin(), part.points.end());
    for (const model::Triangle& t : part.triangles)
        mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
    mesh.materials.insert(mesh.materials.end(), part.materials.begin(), part.materials.end());
    mesh.source_faces.insert(mesh.source_faces.end(), part.source_faces.begin(), part.source_faces.end());
}

SceneBuilder::SceneBuilder(const SceneDocument& document, const FolderTree& tree, double metres,
                           model::Scene& scene)
    : document_(document), tree_(tree), metres_(metres), scene_(scene) {}

std::filesystem::path SceneBuilder::path_of(const std::string& name) const {
    return document_.file.parent_path() / name;
}

std::optional<Vec3> SceneBuilder::read_meshes() {
    std::optional<Vec3> up;
    for (const SceneSection* object : document_.all("object")) {
        const std::string name = *object->text("mesh");
        if (meshes_.count(name) > 0) continue;
        try {
            tree_.require(path_of(name));
            const ImportedMeshes& read = meshes_[name] =
                read_mesh_inside(path_of(name), scene_.channels.size(), tree_);
            const std::string prefix = name + ": ";
            for (const std::string& note : read.notes) core::log_info(prefix + note);
            if (!up && read.up != Vec3(0.0)) up = read.up;
        } catch (const core::FileError& error) {
            throw core::FileError(document_.where(object->line_of("mesh")) + ": " + error.what());
        } catch (const core::GeometryError& error) {
            throw core::GeometryError(document_.where(object->line_of("mesh")) + ": " + error.what());
        }
    }
    return up;
}

std::vector<double> SceneBuilder::per_channel(const SceneSection& section, const std::string& key) const {
    std::vector<double> values = section.numbers(key).value_or(std::vector<double>{0.0});
    const std::size_t channels = scene_.channels.size();
    if (values.size() == 1) values.assign(channels, values.front());
    if (values.size() != channels)
        document_.fail(section.line_of(key), "'" + key + "': " + std::to_string(values.size()) +
                                                 " values, but the scene has " + std::to_string(channels) +
                                                 " channels");
    return values;
}

std::optional<model::Sides> SceneBuilder::sides_of(const SceneSection& section) const {
    if (section.has("sides") && section.has("two_sided"))
        document_.fail(section.line_of("two_sided"), "give either 'sides' or 'two_sided'");
    if (const auto two_sided = section.boolean("two_sided"))
        return *two_sided ? model::Sides::Both : model::Sides::Front;
    if (const auto sides = section.text("sides"))
        return *sides == "both"    ? model::Sides::Both
               : *sides == "front" ? model::Sides::Front
                                   : model::Sides::Auto;
    return std::nullopt;
}

void SceneBuilder::add_materials() {
    for (const SceneSection* section : document_.all("material")) {
        model::Material material;
        material.name = *section->text("name");
        if (!material_names_.insert(material.name).second)
            document_.fail(section->line_of("name"), "there are two materials '" + material.name + "'");
        material.reflectance = per_channel(*section, "reflectance");
        material.exitance = per_channel(*section, "exitance");
        material.sides = sides_of(*section).value_or(model::Sides::Auto);
        if (section->has("dimming")) material.dimming = dimming_of(*section);
        materials_[material.name] = MaterialId(scene_.materials.size());
        scene_.materials.push_back(std::move(material));
    }
}

AxisTurn SceneBuilder::turn_of(const SceneSection& section) const {
    const double degrees = section.number("rotation_deg").value_or(0.0);
    const auto axis = section.vec3("rotation_axis");
    if (degrees != 0.0 && !axis)
        document_.fail(section.line_of("rotation_deg"), "'rotation_deg' needs 'rotation_axis'");
    if (axis && !(glm::length(*axis) > 0.0))
        document_.fail(section.line_of("rotation_axis"), "'rotation_axis' has no direction");
    if (degrees == 0.0) return {};
    return {glm::normalize(*axis), degrees};
}

void SceneBuilder::add_objects() {
    const auto sections = document_.all("object");
    if (sections.empty()) document_.fail(1, "the scene has no [[object]]");
    for (const SceneSection* section : sections) add_object(*section);
}

void SceneBuilder::add_object(const SceneSection& section) {
    const std::string file = *section.text("mesh");
    const ImportedMeshes& meshes = meshes_.at(file);
    model::Object object;
    object.name = *section.text("name");
    if (!object_names_.insert(object.name).second)
        document_.fail(section.line_of("name"), "there are two objects '" + object.name + "'");
    object.source = section.has("group") ? file + ":" + *section.text("group") : file;

    const Placement placement = placement_of(section, meshes);
    for (const std::size_t i : selected(section, meshes)) append(object.mesh, meshes.objects[i].mesh);
    for (Vec3& point : object.mesh.points) point = placement.point(point);

    if (section.has("material")) {
        const MaterialId material = named_material(section, file, meshes);
        std::fill(object.mesh.materials.begin(), object.mesh.materials.end(), material);
    } else {
        for (MaterialId& material : object.mesh.materials)
            material = file_material(file, meshes.materials[material.value]);
    }
    derive_materials(section, object.mesh);
    if (section.has("motion")) object.motion = motion_of(section, file, meshes, placement);
    scene_.objects.push_back(std::move(object));
}

std::vector<std::size_t> SceneBuilder::selected(const SceneSection& section,
                                                const ImportedMeshes& meshes) const {
    std::vector<std::size_t> chosen;
    std::vector<std::string> names;
    const auto group = section.text("group");
    for (std::size_t i = 0; i < meshes.objects.size(); ++i) {
        const auto& own = meshes.groups[i];
        if (!group || std::find(own.begin(), own.end(), *group) != own.end()) chosen.push_back(i);
        names.push_back(meshes.objects[i].name);
    }
    if (chosen.empty())
        document_.fail(section.line_of("group"), "'" + *section.text("mesh") + "' has no group '" + *group +
                                                     "'; it has: " + names_in(names) +
                                                     suggestion(*group, names));
    return chosen;
}

Placement SceneBuilder::placement_of(const SceneSection& section, const ImportedMeshes& meshes) const {
    Placement placement;
    const Vec3 up = section.has("up_axis") ? axis_vector(*section.text("up_axis")) : meshes.up;
    const Mat3 turn = up == Vec3(0.0) ? Mat3(1.0) : turn_between(up, scene_.up);
    const Quat rotation = turn_of(section).rotation();
    placement.scale =
        section.number("scale").value_or(1.0) * (meshes.unit_stated ? meshes.metres_per_unit : metres_);
    const Mat3 turned = rotation == Quat(1.0, 0.0, 0.0, 0.0) ? turn : glm::mat3_cast(rotation) * turn;
    placement.linear = placement.scale * turned;
    placement.rotation = glm::normalize(rotation * glm::quat_cast(turn));
    placement.translation = metres_ * section.vec3("translation").value_or(Vec3(0.0));
    return placement;
}

// A material of a mesh file: replaced by the scene file's of that name, shared with an equal one of another mesh file.
MaterialId SceneBuilder::file_material(const std::string& file, const model::Material& material) {
    const auto stated = materials_.find(material.name);
    if (stated != materials_.end()) return stated->second;
    const auto same = [&](const model::Material& m) {
        return m.reflectance == material.reflectance && m.exitance == material.exitance &&
               m.sides == material.sides && m.dimming == material.dimming;
    };
    const std::string second_name = material.name + " (" + file + ")";
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
        const model::Material& known = scene_.materials[i];
        if ((known.name == material.name || known.name == second_name) && same(known)) return MaterialId(i);
    }
    model::Material added = material;
    added.name =
        unique_name(material_names_.count(material.name) > 0 ? second_name : material.name, material_names_);
    scene_.materials.push_back(std::move(added));
    return MaterialId(scene_.materials.size() - 1);
}

MaterialId SceneBuilder::named_material(const SceneSection& section, const std::string& file,
                                        const ImportedMeshes& meshes) {
    const std::string name = *section.text("material");
    const auto stated = materials_.find(name);
    if (stated != materials_.end()) return stated->second;
    std::vector<std::string> known;
    for (const auto& [own, id] : materials_) known.push_back(own);
    for (const model::Material& material : meshes.materials) {
        if (material.name == name) return file_material(file, material);
        if (std::find(known.begin(), known.end(), material.name) == known.end())
            known.push_back(material.name);
    }
    document_.fail(section.line_of("material"), "there is no material '" + name + "' here or in '" + file +
                                                    "'; there are: " + names_in(known) +
                                                    suggestion(name, known));
}

// The object's own sides and emission on top of the materials of its faces.
void SceneBuilder::derive_materials(const SceneSection& section, model::Mesh& mesh) {
    const auto sides = sides_of(section);
    if (section.has("exitance") && section.has("flux"))
        document_.fail(section.line_of("flux"), "give either 'exitance' or 'flux'");
    const bool emits = section.has("exitance") || section.has("flux");
    if (!sides && !emits && !section.has("dimming")) return;

    std::map<MaterialId, MaterialId> derived;
    for (MaterialId& material : mesh.materials) {
        const auto [place, is_new] = derived.try_emplace(material, scene_.materials.size());
        if (is_new) {
            model::Material copy = scene_.materials[material.value];
            copy.name = unique_name(copy.name + " (" + *section.text("name") + ")", material_names_);
            copy.sides = sides.value_or(copy.sides);
            if (section.has("dimming")) copy.dimming = dimming_of(section);
            scene_.materials.push_back(std::move(copy));
        }
        material = place->second;
    }
    if (emits) set_exitance(section, mesh, derived);
    const bool dark = std::none_of(derived.begin(), derived.end(), [&](const auto& pair) {
        return scene_.materials[pair.second.value].emits();
    });
    if (section.has("dimming") && dark)
        document_.fail(section.line_of("dimming"),
                       "object '" + *section.text("name") + "' emits no light that could be dimmed");
}

void SceneBuilder::set_exitance(const SceneSection& section, const model::Mesh& mesh,
                                const std::map<MaterialId, MaterialId>& derived) {
    std::vector<double> exitance = per_channel(section, section.has("flux") ? "flux" : "exitance");
    if (section.has("flux")) {
        const double area = emitting_area(mesh, scene_.materials);
        if (!(area > 0.0)) document_.fail(section.line_of("flux"), "the object has no area to emit from");
        for (double& value : exitance) value /= area;
        core::log_detail("object '" + *section.text("name") + "': its flux leaves " + std::to_string(area) +
                         " m2");
    }
    for (const auto& [base, own] : derived) scene_.materials[own.value].exitance = exitance;
}

} // namespace kinelux::io
