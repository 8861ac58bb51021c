// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "model/cluster_tree.h"
#include "model/patch_set.h"
#include "model/plan.h"
#include "model/scene.h"

namespace kinelux::plan {

/// Decides what a scene calls for, with the reason and the error risked by what is left out, and predicts unknowns,
/// blocks and memory. The scene's own [effects] win.
model::Plan plan_effects(const model::Scene& scene, const model::PatchSet& patches,
                         const model::ClusterTree& tree);

} // namespace kinelux::plan
