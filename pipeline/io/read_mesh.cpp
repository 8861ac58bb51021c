// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_mesh.h"

#include <algorithm>
#include <cctype>
#include <cstring>

#include "core/error.h"
#include "io/mesh_import.h"
#include "io/rehearse.h"

namespace kinelux::io {

namespace {

std::string lower_extension(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension.empty() ? extension : extension.substr(1);
}

bool is_binary_stl(std::string_view bytes) {
    constexpr std::size_t header = 80, face = 50;
    if (bytes.size() < header + 4) return false;
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + header, sizeof count);
    return count > 0 && bytes.size() == header + 4 + face * static_cast<std::size_t>(count);
}

// Whether the first statement lines are those of an OBJ file.
bool is_obj(std::string_view bytes) {
    for (std::size_t begin = 0; begin < bytes.size();) {
        const std::size_t end = std::min(bytes.find('\n', begin), bytes.size());
        const std::string_view line = bytes.substr(begin, end - begin);
        begin = end + 1;
        if (line.empty() || line == "\r" || line.front() == '#') continue;
        for (const std::string_view start : {"v ", "o ", "g ", "vn ", "vt ", "mtllib ", "usemtl "})
            if (line.starts_with(start)) return true;
        return false;
    }
    return false;
}

// IGES has lines of 80 characters, the first of them with S in column 73.
bool is_iges(std::string_view bytes) {
    constexpr std::size_t column = 72;
    const std::string_view line = bytes.substr(0, bytes.find_first_of("\r\n"));
    return line.size() == 80 && line[column] == 'S' &&
           line.substr(column + 1).find_first_not_of(" 0123456789") == std::string_view::npos;
}

// The format by the first bytes where they are unmistakable, else empty.
std::string format_by_content(std::string_view bytes) {
    const std::size_t text = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
    const std::string_view head = bytes.substr(text, 4096);
    if (bytes.starts_with("glTF")) return "glb";
    if (head.starts_with('{') && head.find("\"asset\"") != std::string_view::npos) return "gltf";
    if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return "ply";
    if (bytes.starts_with("OFF\n") || bytes.starts_with("OFF\r") || bytes.starts_with("OFF ")) return "off";
    if (head.find("<COLLADA") != std::string_view::npos) return "dae";
    if (head.starts_with("ISO-10303-21")) return "step";
    if (is_iges(bytes)) return "iges";
    if (is_binary_stl(bytes)) return "stl";
    if (head.starts_with("solid") && head.find("facet") != std::string_view::npos) return "stl";
    return {};
}

// Formats that two extensions share, so that the extension does not lie.
bool same_format(const std::string& content, const std::string& extension) {
    const auto is_step = [](const std::string& e) { return e == "step" || e == "stp" || e == "ifc"; };
    return content == extension || (is_step(content) && is_step(extension));
}

void check_imported(const ImportedMeshes& meshes, const std::string& file) {
    std::size_t faces = 0;
    for (const model::Object& object : meshes.objects) {
        model::check(object.mesh, file + ": object '" + object.name + "'");
        faces += object.mesh.triangles.size();
    }
    if (faces == 0) throw core::GeometryError(file + ": holds no faces");
}

ImportedMeshes dispatch(const MeshFile& file) {
    const std::string extension = lower_extension(file.path);
    std::string format = format_by_content(file.bytes);
    if (format.empty() && (extension.empty() || extension == "txt") && is_obj(file.bytes)) format = "obj";
    if (format.empty()) format = extension;
    if (format == "obj") return read_obj(file);
    if (format == "gltf" || format == "glb") return read_gltf(file);
    const std::string_view head = std::string_view(file.bytes).substr(0, 4096);
    const bool step = format == "step" || format == "stp";
    const bool iges = format == "iges" || format == "igs";
    const bool cad = iges || (step && head.find("IFC") == std::string_view::npos);
    const auto import = [&] {
        if (cad) return read_cad(file, iges ? CadFormat::Iges : CadFormat::Step);
        return read_assimp(file, same_format(format, extension) ? "" : format);
    };
    constexpr double s_per_byte = 2e-6; // honest files take a fraction of that
    ImportLimits limits;
    limits.cpu_s += s_per_byte * static_cast<double>(file.bytes.size());
    rehearse(file.name(), limits, [&] { import(); });
    return import();
}

} // namespace

ImportedMeshes read_mesh_inside(const std::filesystem::path& path, std::size_t channels,
                                const FolderTree& tree) {
    MeshFile file{path, read_bytes(path), channels, tree};
    if (file.bytes.empty()) throw core::FileError(file.name() + ": is empty");
    if (file.bytes.starts_with("\xEF\xBB\xBF")) file.bytes.erase(0, 3);
    ImportedMeshes meshes = dispatch(file);
    check_imported(meshes, file.name());
    return meshes;
}

ImportedMeshes read_mesh(const std::filesystem::path& file, std::size_t channels) {
    return read_mesh_inside(file, channels, FolderTree(file.parent_path(), Outside::Refused));
}

} // namespace kinelux::io
