// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/vec.h"
#include "model/scene.h"

namespace kinelux::geometry {

/// A rigid motion, world_from_rest: x -> rotation x + translation.
struct Pose {
    Quat rotation{1.0, 0.0, 0.0, 0.0}; ///< unit
    Vec3 translation{0.0};             ///< [m]

    Vec3 point(const Vec3& rest) const { return rotation * rest + translation; }
    Vec3 direction(const Vec3& rest) const { return rotation * rest; }
    Vec3 rest_point(const Vec3& world) const { return glm::conjugate(rotation) * (world - translation); }
    bool operator==(const Pose&) const = default;
};

/// The pose of a motion at a time; before the first and after the last keyframe it rests there.
/// Translations are interpolated by step, linearly or by a Catmull-Rom spline, rotations by slerp (or step).
Pose pose_at(const model::Motion& motion, double time_s);

/// One pose per object of the scene at a time; identity for bodies without motion.
std::vector<Pose> object_poses(const model::Scene& scene, double time_s);

} // namespace kinelux::geometry
