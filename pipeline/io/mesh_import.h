// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec.h"
#include "io/read_mesh.h"

// What the mesh readers share; private to io.
namespace kinelux::io {

enum class Outside { Refused, Allowed };

/// The folder tree that a scene may read from. Symbolic links count as what they point to.
class FolderTree {
public:
    FolderTree(const std::filesystem::path& root, Outside outside);
    bool contains(const std::filesystem::path& file) const;
    /// @throws FileError  `file` lies outside and outside is refused
    void require(const std::filesystem::path& file) const;

private:
    std::filesystem::path root_;
    Outside outside_;
};

/// A mesh file in memory with what its reader needs to know.
struct MeshFile {
    std::filesystem::path path;
    std::string bytes;
    std::size_t channels = 3;
    FolderTree tree;

    std::string name() const { return path.string(); } ///< for messages
};

/// A file's bytes. @throws FileError  it is missing, a folder or cannot be read
std::string read_bytes(const std::filesystem::path& file);

/// read_mesh for a file that may name others (MTL, .bin): those must lie in `tree`; the file itself need not.
ImportedMeshes read_mesh_inside(const std::filesystem::path& file, std::size_t channels,
                                const FolderTree& tree);

ImportedMeshes read_obj(const MeshFile& file);
ImportedMeshes read_gltf(const MeshFile& file);
/// @param hint  format by content where the extension says something else, e.g. "ply"; empty: by path
ImportedMeshes read_assimp(const MeshFile& file, const std::string& hint);

enum class CadFormat { Step, Iges };
/// Parts and assemblies by OpenCASCADE: one object an instance, under its names, colours as reflectances, in millimetres.
/// Faces become facets that are at most 2e-4 of the model's size off the exact surface and share the points of common edges.
/// @throws FileError, GeometryError  as read_mesh
ImportedMeshes read_cad(const MeshFile& file, CadFormat format);

/// Collects the materials of one file: RGB to channels, names made unique, impossible reflectances put right and noted.
class MaterialCollector {
public:
    explicit MaterialCollector(std::size_t channels) : channels_(channels) {}
    /// @param reflectance  RGB [1]; above 0.95 is lowered to that, below 0 raised to 0
    /// @param exitance     RGB [W/m2 or lm/m2]; below 0 raised to 0
    /// @throws FileError  a value is not finite
    MaterialId add(const std::string& name, const Vec3& reflectance, const Vec3& exitance,
                   model::Sides sides);
    /// The material of faces that have none: grey, reflectance 0.5. Made when first asked for.
    MaterialId default_grey();
    /// A material that faces name and no file describes: grey like the default, under its own name.
    MaterialId undescribed(const std::string& name);
    /// Hands over the materials and appends what was changed to the notes.
    void finish(ImportedMeshes& result);

private:
    std::vector<double> per_channel(const Vec3& rgb) const;

    std::size_t channels_;
    std::vector<model::Material> materials_;
    std::set<std::string> names_;
    std::vector<std::string> clamped_, undescribed_;
    std::map<std::string, MaterialId> grey_;
};

/// `wanted`, or "wanted (2)", "wanted (3)", ... where that is taken; the result is added to `taken`.
std::string unique_name(const std::string& wanted, std::set<std::string>& taken);

/// "a, b, c and 12 more": at most eight names.
std::string short_list(const std::vector<std::string>& names);

/// Cuts a simple polygon, convex or not, into triangles of the same orientation by clipping ears.
/// @param corners  n >= 3 points, nearly in one plane; repeated and collinear ones are allowed
/// @return  n - 2 triangles of indices into `corners`; they cover the polygon once
std::vector<model::Triangle> triangulate_polygon(const std::vector<Vec3>& corners);

} // namespace kinelux::io
