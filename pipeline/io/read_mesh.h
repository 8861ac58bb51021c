// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "model/scene.h"

namespace kinelux::io {

/// What a mesh file holds, in the file's own units and axes.
struct ImportedMeshes {
    std::vector<model::Material> materials;
    std::vector<model::Object>
        objects; ///< one per OBJ group/object, glTF node with a mesh, Assimp node with a mesh
    std::vector<std::vector<std::string>>
        groups; ///< one per object: every name a scene file can ask for it by: its own
                ///< and those of the groups or parent nodes it lies in
    std::vector<model::Motion> motions; ///< glTF node animations, in the file's own units and axes
    std::vector<std::string> notes; ///< what the file holds and this program leaves out, one sentence each
    double metres_per_unit = 1.0;   ///< what the format says (glTF: 1); else 1
    bool unit_stated = false;
    Vec3 up{0.0, 0.0, 0.0}; ///< what the format says (glTF: y); else zero
};

/// Reads a mesh file by its content type: OBJ+MTL by tinyobjloader in double precision, glTF/GLB by tinygltf, the rest
/// by Assimp. Names, diffuse colour -> reflectance and emission x strength -> exitance survive.
/// Files that it names (MTL, .bin) are read only from the mesh file's own folder tree.
/// @param channels  number of channels wanted: 3 = RGB; any other number gets the mean of RGB in each
/// @throws FileError      missing, unreadable, truncated, unknown format
/// @throws GeometryError  no faces, index out of range, coordinate not finite (file, object, vertex)
ImportedMeshes read_mesh(const std::filesystem::path& file, std::size_t channels);

} // namespace kinelux::io
