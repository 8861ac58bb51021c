// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "sample/sampler.h"
#include "support/shapes.h"

namespace kinelux::test {

/// Elements, display mesh and occluders of some patches.
struct ShownPatches {
    model::PatchSet set;
    model::Scene scene;
    model::ClusterTree tree;
    std::vector<geometry::ElementShape> shapes;
    model::DisplayMesh mesh;
    visibility::Occluders occluders;
    std::vector<geometry::Pose> poses;

    ShownPatches(std::vector<model::Patch> patches, model::Scene with, int n, int degree, double cell)
        : set{std::move(patches), {}},
          scene(std::move(with)),
          tree(support::uniform_elements(set, n)),
          shapes(geometry::element_shapes(set, tree, degree, 0)),
          mesh(sample::display_mesh(shapes, set, tree, cell)),
          occluders(support::occluders_of(set, scene)),
          poses(scene.objects.size()) {}
};

} // namespace kinelux::test
