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
    Pose inverse() const { return {glm::conjugate(rotation), glm::conjugate(rotation) * -translation}; }
    /// The motion that first does `first` and then this.
    Pose after(const Pose& first) const {
        return {glm::normalize(rotation * first.rotation), point(first.translation)};
    }
    bool operator==(const Pose&) const = default;
};

/// The pose of a motion by itself, without its parents, at a time; before the first and after the last keyframe it rests
/// there. Translations are interpolated by step, linearly, or by Hermite splines through the keyframes' tangents or
/// those of Catmull-Rom; rotations by step, by slerp (a keyframe's turn about its axis instead, where it has one), or by
/// Hermite splines of quaternions, made unit afterwards (glTF 2.0, appendix C).
Pose pose_at(const model::Motion& motion, double time_s);

/// The pose of what follows a motion of the scene: its parents' poses after its own.
Pose pose_at(const model::Scene& scene, MotionId motion, double time_s);

/// Key times of a motion and its parents: between them its pose is smooth. @return  increasing, without repetition [s]
std::vector<double> key_times(const model::Scene& scene, MotionId motion);

/// One pose per object of the scene at a time; identity for bodies without motion.
std::vector<Pose> object_poses(const model::Scene& scene, double time_s);

} // namespace kinelux::geometry
