// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "clean/clean.h"
#include "model/scene.h"

namespace kinelux::clean {

/// Lifts bodies that move within the plane of a resting surface facing the same way (a lamp set into a ceiling) to the
/// front of it, by 1e-4 of the scene's extent: which of two surfaces in one place is lit, blocks and is seen would be
/// undecided otherwise. Adds a note to the report of each body lifted. Bodies at rest need no lift: fit removes what
/// they cover. @param scene  with oriented meshes
void lift_coplanar_movers(model::Scene& scene, std::vector<CleanReport>& reports);

} // namespace kinelux::clean
