// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/plan.h"
#include "model/scene.h"

namespace kinelux::io {

/// Format name, version and origin that stand at the top of every file of a case.
struct FileHeader {
    std::string format;
    std::int64_t version = 0;
    std::string program;     ///< version of the program that wrote it
    std::string made_from{}; ///< core::file_hash of the predecessor; empty: none
};

/// Where an object's mesh lies, relative to the case folder, and the hash of that file.
struct MeshFile {
    std::string path, hash;
};

// All of these read strictly: FileError says which key is missing or wrong, without the file's name. Names that are not
// UTF-8 are written with U+FFFD for each bad byte.

FileHeader header_from_json(std::string_view text);

/// @param meshes  one per object
std::string scene_to_json(const FileHeader& header, const model::Scene& scene,
                          const std::vector<MeshFile>& meshes);

/// A scene without its meshes, and where they are.
struct SceneFile {
    model::Scene scene;
    std::vector<MeshFile> meshes;
};
SceneFile scene_from_json(std::string_view text);

std::string plan_to_json(const FileHeader& header, const model::Plan& plan);
model::Plan plan_from_json(std::string_view text);

/// A text with every byte that is not UTF-8 replaced by U+FFFD.
std::string valid_utf8(const std::string& text);

} // namespace kinelux::io
