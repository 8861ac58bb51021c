// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "model/cluster_tree.h"
#include "model/patch_set.h"

namespace kinelux::support {

/// A planar patch of object and material 0. @param corners  counter-clockwise seen from the front; every corner sees the
/// first one through the patch [m]
model::Patch polygon_patch(std::span<const Vec3> corners, ObjectId object = {});

/// A parallelogram with a parallelogram hole. @param hole_low, hole_high  in units of the edges, 0 < low < high < 1
model::Patch frame_patch(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v, const Vec2& hole_low,
                         const Vec2& hole_high, ObjectId object = {});

/// One element per patch: all triangles of its domain.
model::ClusterTree whole_patch_elements(const model::PatchSet& set);

} // namespace kinelux::support
