// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "clean/clean.h"
#include "model/scene.h"

namespace kinelux::clean {

/// Lifts bodies that emit or move within the plane of a resting surface facing the same way (a lamp set into a ceiling)
/// to the front of it, by 5e-6 of the scene's extent: which of two surfaces in one place is hit by a ray, and which is
/// seen, would be undecided otherwise. The lift is less than what fit takes for contact, so the surface covered by a
/// lamp at rest is still removed there. What a moving one covers is dark, as it is behind a lamp that hangs lower, where
/// polygons are clipped exactly; it is less than the offset at which shadow rays start, so where these decide it is not.
/// Adds a note to the report of each body lifted. @param scene  with oriented meshes
void lift_coplanar_panels(model::Scene& scene, std::vector<CleanReport>& reports);

} // namespace kinelux::clean
