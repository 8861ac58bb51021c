// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "clean/clean.h"
#include "model/scene.h"

namespace kinelux::clean {

/// Lifts bodies that move within the plane of a resting surface facing the same way (a lamp set into a ceiling) to the
/// front of it, by 1e-5 of the scene's extent: which of two surfaces in one place is seen would be undecided otherwise.
/// The lift is less than the offset at which shadow rays start, so the body does not darken the surface it slides along
/// (which would have to be cut anew in every frame); what it covers counts as uncovered. Adds a note to the report of
/// each body lifted. Bodies at rest need no lift: fit removes what they cover. @param scene  with oriented meshes
void lift_coplanar_movers(model::Scene& scene, std::vector<CleanReport>& reports);

} // namespace kinelux::clean
