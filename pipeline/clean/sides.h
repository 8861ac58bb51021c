// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "clean/parts.h"
#include "clean/work_mesh.h"
#include "model/scene.h"

namespace kinelux::clean {

/// Decides for every part of every object which way it faces, and for every face whether both sides exchange light.
/// Flips faces in `meshes`, fills two_sided, and writes counts and reasons into the reports. One entry per object.
void decide_sides(const model::Scene& scene, const std::vector<std::vector<Part>>& parts,
                  std::vector<WorkMesh>& meshes, std::vector<CleanReport>& reports);

} // namespace kinelux::clean
