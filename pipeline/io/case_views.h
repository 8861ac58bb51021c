// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/scene_json.h"
#include "model/cluster_tree.h"
#include "model/patch_set.h"
#include "model/scene.h"

namespace kinelux::io {

/// File names for objects: letters, digits, '.', '_', '-' of their names, the rest '_'; distinct even where upper and
/// lower case are one.
std::vector<std::string> object_file_names(const model::Scene& scene);

/// Writes clean/<object>.vtp for each object and clean.vtm over them; removes clean/*.vtp of earlier runs.
/// @return where each object's mesh is, relative to the folder, and its hash
std::vector<MeshFile> write_clean_meshes(const std::filesystem::path& folder, const model::Scene& scene);

/// A mesh as write_clean_meshes wrote it. @throws FileError
model::Mesh read_clean_mesh(const std::filesystem::path& file);

/// patches.vtu: the triangulated domains on their surfaces, and the small triangles.
void write_patches_view(const std::filesystem::path& file, const model::PatchSet& patches,
                        const model::Scene& scene);

/// clusters.vtu: the pieces of patches on their surfaces, and the clusters' triangles.
void write_clusters_view(const std::filesystem::path& file, const model::ClusterTree& tree,
                         const model::PatchSet& patches, const model::Scene& scene);

/// Names as they are kept in VTK files.
std::vector<std::string> object_names(const model::Scene& scene);
std::vector<std::string> material_names(const model::Scene& scene);

/// "Exitance_W_m2" from ("Exitance", "W/m2"): a quantity and its unit as an array name.
std::string array_name(const std::string& quantity, const std::string& unit);

} // namespace kinelux::io
