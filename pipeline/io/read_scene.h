// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "model/scene.h"

namespace kinelux::io {

struct ReadSceneOptions {
    bool allow_outside = false; ///< meshes may lie outside the scene file's folder tree
};

/// Reads a scene file (.toml) with its meshes, or a bare mesh file (.obj .gltf .glb .ply .stl .3ds .off .dae ...) with
/// defaults for the rest: its own materials, emissive ones as sources, metres, its animation.
/// Lengths come back in metres, transforms applied; nothing is repaired.
/// @throws OptionError  "file:line: ..." for unknown keys (with the nearest known one), wrong types or ranges, a motion
///                      that names no object or an object that names no motion, material or group
/// @throws FileError    a file is missing, unreadable, or outside the folder tree
/// @throws GeometryError  a mesh has no faces or a coordinate that is not finite (file, object, vertex)
model::Scene read_scene(const std::filesystem::path& file, const ReadSceneOptions& options);

/// The table of all scene file keys as Markdown: key, type, unit, default, meaning. docs/scene-format.md contains it.
std::string scene_format_table();

} // namespace kinelux::io
