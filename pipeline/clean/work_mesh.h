// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clean/clean.h"
#include "model/mesh.h"
#include "model/scene.h"

namespace kinelux::clean {

/// One object while it is repaired.
struct WorkMesh {
    model::Mesh mesh;
    std::vector<std::uint8_t>
        pinned; ///< one per face, 1 = one of two sides that the file models by a face each:
                ///< it keeps its direction and shows its front only
    std::vector<std::uint8_t> flipped; ///< one per face, 1 = its direction is not the file's
};

/// Merges points, drops faces without area and faces that are there twice, and makes one two-sided face of two that lie
/// back to back with the same material. Fills the counts of the report.
/// @throws GeometryError  a coordinate that is not finite (names object and face), or no face left
WorkMesh repair(const model::Object& object, const CleanOptions& options, CleanReport& report);

} // namespace kinelux::clean
