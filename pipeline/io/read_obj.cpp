// SPDX-License-Identifier: GPL-3.0-or-later
#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <sstream>

#include "core/error.h"
#include "io/mesh_import.h"

// tinyobjloader splits the statements; coordinates are converted here, because it reads what it cannot convert (nan,
// text, nothing) as 0. Its callback interface keeps what its ready lists lose: polygons of more than 255 corners, the
// names of materials that no MTL file describes.
namespace kinelux::io {

namespace {

constexpr std::string_view blanks = " \t\r";

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

// The rest of the line if it is a `keyword` statement.
std::optional<std::string_view> statement(std::string_view line, std::string_view keyword) {
    line = trimmed(line);
    if (!line.starts_with(keyword) || line.size() <= keyword.size()) return std::nullopt;
    if (blanks.find(line[keyword.size()]) == std::string_view::npos) return std::nullopt;
    return trimmed(line.substr(keyword.size()));
}

template <class Visit>
void for_each_line(std::string_view text, const Visit& visit) {
    std::size_t number = 1;
    for (std::size_t begin = 0; begin < text.size(); ++number) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        visit(text.substr(begin, end - begin), number);
        begin = end + 1;
    }
}

// What is taken from the text before tinyobjloader sees it.
struct Prepared {
    std::vector<Vec3> points;
    std::vector<std::string> libraries; ///< operands of mtllib
};

double parse_coordinate(std::string_view& rest, const std::string& where) {
    rest = trimmed(rest);
    if (rest.starts_with('+')) rest.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error == std::errc::result_out_of_range && end != rest.data())
        throw core::GeometryError(where + ": a coordinate is too large or too small for a double");
    if (error != std::errc{})
        throw core::FileError(where +
                              ": expected three coordinates after 'v'; the file is damaged or truncated");
    if (!std::isfinite(value))
        throw core::GeometryError(where + ": the vertex has a coordinate that is not finite");
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return value;
}

Prepared prepare(const MeshFile& file) {
    Prepared prepared;
    for_each_line(file.bytes, [&](std::string_view line, std::size_t number) {
        if (auto rest = statement(line, "v")) {
            const std::string where = file.name() + ":" + std::to_string(number);
            Vec3 point{0.0};
            for (int c = 0; c < 3; ++c) point[c] = parse_coordinate(*rest, where);
            prepared.points.push_back(point);
        } else if (const auto names = statement(line, "mtllib")) {
            prepared.libraries.emplace_back(*names);
        } else if (trimmed(line) == "v") {
            throw core::FileError(file.name() + ":" + std::to_string(number) +
                                  ": expected three coordinates after 'v'; the file is damaged or truncated");
        }
    });
    return prepared;
}

// Joins lines that end in a backslash with the next one; blank lines keep the numbers of those that follow.
std::string joined_lines(const std::string& text) {
    std::string joined;
    joined.reserve(text.size());
    std::size_t owed = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::size_t after =
            text[i] == '\\' && i + 1 < text.size() && text[i + 1] == '\r' ? i + 2 : i + 1;
        if (text[i] == '\\' && after < text.size() && text[after] == '\n') {
            joined += ' ';
            ++owed;
            i = after;
            continue;
        }
        joined += text[i];
        if (text[i] != '\n') continue;
        joined.append(owed, '\n');
        owed = 0;
    }
    return joined;
}

// The line of the `index`-th face statement, for messages.
std::string line_of_face(const MeshFile& file, std::size_t index) {
    std::size_t faces = 0, found = 0;
    for_each_line(file.bytes, [&](std::string_view line, std::size_t number) {
        if (statement(line, "f") && faces++ == index) found = number;
    });
    return file.name() + ":" + std::to_string(found);
}

struct Polygon {
    std::size_t first = 0, count = 0; ///< into Faces::corners
    std::uint32_t face = 0;           ///< number in the file
    std::size_t material = 0;         ///< into Faces::material_names
};

struct Group {
    std::string object;
    std::vector<std::string> names;
    std::vector<Polygon> polygons;
};

// Everything the callbacks collect.
struct Faces {
    const MeshFile* file = nullptr;
    std::size_t points = 0;
    std::vector<std::uint32_t> corners;
    std::vector<std::string> material_names{""};
    std::map<std::string, std::size_t> material_index{{"", 0}};
    std::size_t material = 0;
    std::vector<Group> groups{1};
    std::map<std::pair<std::string, std::vector<std::string>>, std::size_t> group_index{{{"", {}}, 0}};
    std::size_t group = 0;
    std::uint32_t faces = 0;
    std::size_t degenerate = 0;

    void enter(const std::string& object, const std::vector<std::string>& names) {
        const auto [place, is_new] = group_index.try_emplace({object, names}, groups.size());
        if (is_new) groups.push_back({object, names, {}});
        group = place->second;
    }

    void add(const tinyobj::index_t* indices, std::size_t count) {
        Polygon polygon{corners.size(), count, faces++, material};
        for (std::size_t i = 0; i < count; ++i)
            corners.push_back(resolved(indices[i].vertex_index, polygon.face));
        if (count < 3)
            ++degenerate;
        else
            groups[group].polygons.push_back(polygon);
    }

    // OBJ counts from 1, or backwards from the last vertex read so far. Bounds against the whole file, as others do.
    std::uint32_t resolved(int index, std::uint32_t face) const {
        const auto position =
            index > 0 ? static_cast<long long>(index) - 1 : static_cast<long long>(points) + index;
        if (index == 0 || position < 0)
            throw core::GeometryError(line_of_face(*file, face) + ": face " + std::to_string(face + 1) +
                                      " names vertex " + std::to_string(index) + ", which does not exist");
        return static_cast<std::uint32_t>(position);
    }
};

Faces& faces_of(void* data) { return *static_cast<Faces*>(data); }

Faces read_faces(const MeshFile& file) {
    tinyobj::callback_t callback;
    callback.vertex_cb = [](void* data, double, double, double, double) { ++faces_of(data).points; };
    callback.index_cb = [](void* data, tinyobj::index_t* indices, int count) {
        faces_of(data).add(indices, static_cast<std::size_t>(count));
    };
    callback.usemtl_cb = [](void* data, const char* name, int) {
        Faces& faces = faces_of(data);
        const std::string text(trimmed(name));
        const auto [place, is_new] = faces.material_index.try_emplace(text, faces.material_names.size());
        if (is_new) faces.material_names.push_back(text);
        faces.material = place->second;
    };
    callback.group_cb = [](void* data, const char** names, int count) {
        Faces& faces = faces_of(data);
        faces.enter(faces.groups[faces.group].object, std::vector<std::string>(names, names + count));
    };
    callback.object_cb = [](void* data, const char* name) {
        faces_of(data).enter(std::string(trimmed(name)), {});
    };
    Faces faces;
    faces.file = &file;
    std::istringstream stream(file.bytes);
    std::string warnings, errors;
    if (!tinyobj::LoadObjWithCallback(stream, callback, &faces, nullptr, &warnings, &errors))
        throw core::FileError(file.name() + ": " + errors);
    return faces;
}

struct MaterialLibraries {
    std::map<std::string, int> index;
    std::vector<tinyobj::material_t> materials;
};

void read_library(const MeshFile& file, const std::string& name, MaterialLibraries& libraries,
                  std::vector<std::string>& notes) {
    const std::filesystem::path path = file.path.parent_path() / name;
    file.tree.require(path);
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
        notes.push_back("material file '" + name + "' is missing");
        return;
    }
    std::istringstream stream(read_bytes(path));
    std::string warnings, errors;
    tinyobj::LoadMtl(&libraries.index, &libraries.materials, &stream, &warnings, &errors);
}

// One mtllib may name several files, and a file name may hold blanks: it is one name if there is such a file.
MaterialLibraries read_libraries(const MeshFile& file, const Prepared& prepared,
                                 std::vector<std::string>& notes) {
    MaterialLibraries libraries;
    std::set<std::string> seen;
    for (const std::string& operand : prepared.libraries) {
        std::error_code error;
        std::vector<std::string> names{operand};
        if (!std::filesystem::exists(file.path.parent_path() / operand, error)) {
            std::istringstream words(operand);
            names.clear();
            for (std::string word; words >> word;) names.push_back(word);
        }
        for (const std::string& name : names)
            if (seen.insert(name).second) read_library(file, name, libraries, notes);
    }
    return libraries;
}

// Materials of the faces in the order of their first use.
std::vector<MaterialId> add_materials(const Faces& faces, const MaterialLibraries& libraries,
                                      MaterialCollector& collector, std::vector<std::string>& notes) {
    std::vector<std::uint8_t> used(faces.material_names.size(), 0);
    for (const Group& group : faces.groups)
        for (const Polygon& polygon : group.polygons) used[polygon.material] = 1;
    std::vector<MaterialId> ids(faces.material_names.size());
    std::vector<std::string> textured, transparent;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (!used[i]) continue;
        const std::string& name = faces.material_names[i];
        const auto found = libraries.index.find(name);
        if (name.empty() || found == libraries.index.end()) {
            ids[i] = name.empty() ? collector.default_grey() : collector.undescribed(name);
            continue;
        }
        const tinyobj::material_t& material = libraries.materials[static_cast<std::size_t>(found->second)];
        if (!material.diffuse_texname.empty() || !material.emissive_texname.empty()) textured.push_back(name);
        if (material.dissolve < 1.0) transparent.push_back(name);
        ids[i] = collector.add(name, {material.diffuse[0], material.diffuse[1], material.diffuse[2]},
                               {material.emission[0], material.emission[1], material.emission[2]},
                               model::Sides::Auto);
    }
    if (!textured.empty())
        notes.push_back("textures are not read, only Kd and Ke, in: " + short_list(textured));
    if (!transparent.empty())
        notes.push_back("transparent materials are opaque here: " + short_list(transparent));
    return ids;
}

std::string group_label(const Group& group) {
    std::string label;
    for (const std::string& name : group.names) label += (label.empty() ? "" : " ") + name;
    return label.empty() ? group.object : label;
}

// Gives each object its own points, numbered in the order of first use.
class MeshCutter {
public:
    MeshCutter(const MeshFile& file, const std::vector<Vec3>& points, const Faces& faces,
               const std::vector<MaterialId>& materials)
        : file_(file), points_(points), faces_(faces), materials_(materials), local_(points.size(), unused) {}

    model::Mesh cut(const Group& group) {
        model::Mesh mesh;
        std::vector<std::uint32_t> mine;
        for (const Polygon& polygon : group.polygons) {
            std::vector<Vec3> corners;
            std::vector<std::uint32_t> numbers;
            for (std::size_t i = 0; i < polygon.count; ++i) {
                const std::uint32_t point = faces_.corners[polygon.first + i];
                if (point >= points_.size()) refuse(polygon, point);
                if (local_[point] == unused) {
                    local_[point] = static_cast<std::uint32_t>(mine.size());
                    mine.push_back(point);
                    mesh.points.push_back(points_[point]);
                }
                numbers.push_back(local_[point]);
                corners.push_back(points_[point]);
            }
            for (const model::Triangle& t : triangulate_polygon(corners)) {
                mesh.triangles.push_back({numbers[t[0]], numbers[t[1]], numbers[t[2]]});
                mesh.materials.push_back(materials_[polygon.material]);
                mesh.source_faces.push_back(polygon.face);
            }
        }
        for (const std::uint32_t point : mine) local_[point] = unused;
        return mesh;
    }

private:
    static constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();

    [[noreturn]] void refuse(const Polygon& polygon, std::uint32_t point) const {
        throw core::GeometryError(line_of_face(file_, polygon.face) + ": face " +
                                  std::to_string(polygon.face + 1) + " names vertex " +
                                  std::to_string(point + 1) + ", but the file has " +
                                  std::to_string(points_.size()));
    }

    const MeshFile& file_;
    const std::vector<Vec3>& points_;
    const Faces& faces_;
    const std::vector<MaterialId>& materials_;
    std::vector<std::uint32_t> local_;
};

} // namespace

ImportedMeshes read_obj(const MeshFile& original) {
    if (original.bytes.starts_with("\xFE\xFF") || original.bytes.starts_with("\xFF\xFE"))
        throw core::FileError(original.name() + ": is UTF-16 text; save it as UTF-8");
    MeshFile file = original;
    file.bytes = joined_lines(original.bytes);
    ImportedMeshes result;
    const Prepared prepared = prepare(file);
    const Faces faces = read_faces(file);
    MaterialCollector collector(file.channels);
    const MaterialLibraries libraries = read_libraries(file, prepared, result.notes);
    const std::vector<MaterialId> materials = add_materials(faces, libraries, collector, result.notes);

    MeshCutter cutter(file, prepared.points, faces, materials);
    std::set<std::string> taken;
    for (const Group& group : faces.groups) {
        if (group.polygons.empty()) continue;
        const std::string label = group_label(group);
        model::Object object;
        object.name = unique_name(label.empty() ? file.path.stem().string() : label, taken);
        object.source = label.empty() ? file.name() : file.name() + ":" + label;
        object.mesh = cutter.cut(group);
        std::vector<std::string> names = group.names;
        names.insert(names.end(), {object.name, label, group.object});
        result.objects.push_back(std::move(object));
        result.groups.push_back(std::move(names));
    }
    if (faces.degenerate > 0)
        result.notes.push_back(std::to_string(faces.degenerate) +
                               " faces with fewer than three corners are left out");
    collector.finish(result);
    return result;
}

} // namespace kinelux::io
