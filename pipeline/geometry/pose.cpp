// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/pose.h"

#include <algorithm>
#include <optional>
#include <set>

#include "core/error.h"

namespace kinelux::geometry {

namespace {

using Keyframes = std::vector<model::Keyframe>;

// The cubic from one value to another with given slopes; s in [0, 1] over an interval of `length` seconds.
template <class Value>
Value hermite(const Value& from, const Value& slope_out, const Value& to, const Value& slope_in,
              double length, double s) {
    const double s2 = s * s, s3 = s2 * s;
    return from * (2.0 * s3 - 3.0 * s2 + 1.0) + slope_out * (length * (s3 - 2.0 * s2 + s)) +
           to * (3.0 * s2 - 2.0 * s3) + slope_in * (length * (s3 - s2));
}

// Catmull-Rom: the slope of the chord between the neighbours, for uneven spacing; one-sided at the ends.
Vec3 chord_slope(const Keyframes& keys, std::size_t k) {
    const std::size_t before = k > 0 ? k - 1 : k;
    const std::size_t after = k + 1 < keys.size() ? k + 1 : k;
    return (keys[after].translation - keys[before].translation) / (keys[after].time_s - keys[before].time_s);
}

Vec3 translation_between(const model::Motion& motion, std::size_t k, double s) {
    const model::Keyframe &from = motion.keyframes[k], &to = motion.keyframes[k + 1];
    if (motion.interpolation == model::Interpolation::Step) return from.translation;
    if (motion.interpolation == model::Interpolation::Linear)
        return glm::mix(from.translation, to.translation, s);
    return hermite(
        from.translation, from.tangents ? from.tangents->translation_out : chord_slope(motion.keyframes, k),
        to.translation, to.tangents ? to.tangents->translation_in : chord_slope(motion.keyframes, k + 1),
        to.time_s - from.time_s, s);
}

Quat rotation_between(const model::Motion& motion, std::size_t k, double s) {
    const model::Keyframe &from = motion.keyframes[k], &to = motion.keyframes[k + 1];
    if (motion.rotation_interpolation == model::Interpolation::Step) return from.rotation;
    if (motion.rotation_interpolation == model::Interpolation::Cubic)
        return hermite(from.rotation, from.tangents->rotation_out, to.rotation, to.tangents->rotation_in,
                       to.time_s - from.time_s, s);
    const double angle = to.turn ? glm::length(*to.turn) : 0.0;
    if (angle > 0.0) return glm::angleAxis(s * angle, *to.turn / angle) * from.rotation;
    return glm::slerp(from.rotation, to.rotation, s);
}

Pose pose_from(const Quat& rotation, const Vec3& translation, const Vec3& pivot) {
    const Quat unit = glm::normalize(rotation);
    return {unit, pivot + translation - unit * pivot};
}

} // namespace

Pose pose_at(const model::Motion& motion, double time_s) {
    const auto& keys = motion.keyframes;
    if (keys.empty())
        throw core::OptionError("motion '" + motion.name + "' has no keyframe; give it at least one");
    const auto after = std::upper_bound(keys.begin(), keys.end(), time_s,
                                        [](double t, const model::Keyframe& key) { return t < key.time_s; });
    if (after == keys.begin())
        return pose_from(keys.front().rotation, keys.front().translation, motion.pivot);
    const auto k = static_cast<std::size_t>(after - keys.begin()) - 1;
    if (after == keys.end()) return pose_from(keys[k].rotation, keys[k].translation, motion.pivot);
    const double s = (time_s - keys[k].time_s) / (keys[k + 1].time_s - keys[k].time_s);
    return pose_from(rotation_between(motion, k, s), translation_between(motion, k, s), motion.pivot);
}

Pose pose_at(const model::Scene& scene, MotionId motion, double time_s) {
    Pose pose = pose_at(scene.motions[motion.value], time_s);
    for (auto parent = scene.motions[motion.value].parent; parent;
         parent = scene.motions[parent->value].parent)
        pose = pose_at(scene.motions[parent->value], time_s).after(pose);
    return pose;
}

std::vector<double> key_times(const model::Scene& scene, MotionId motion) {
    std::set<double> times;
    for (std::optional<MotionId> link = motion; link; link = scene.motions[link->value].parent)
        for (const model::Keyframe& key : scene.motions[link->value].keyframes) times.insert(key.time_s);
    return {times.begin(), times.end()};
}

std::vector<Pose> object_poses(const model::Scene& scene, double time_s) {
    std::vector<Pose> poses;
    poses.reserve(scene.objects.size());
    for (const model::Object& object : scene.objects)
        poses.push_back(object.motion ? pose_at(scene, *object.motion, time_s) : Pose{});
    return poses;
}

} // namespace kinelux::geometry
