// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/pose.h"

#include <algorithm>

#include "core/error.h"

namespace kinelux::geometry {

namespace {

// Catmull-Rom through key k and k+1 with the slopes of uneven spacing; one-sided at the ends.
Vec3 catmull_rom(const std::vector<model::Keyframe>& keys, std::size_t k, double s) {
    const auto slope = [&](std::size_t i) {
        const std::size_t before = i > 0 ? i - 1 : i;
        const std::size_t after = i + 1 < keys.size() ? i + 1 : i;
        return (keys[after].translation - keys[before].translation) /
               (keys[after].time_s - keys[before].time_s);
    };
    const double length = keys[k + 1].time_s - keys[k].time_s;
    const double s2 = s * s, s3 = s2 * s;
    return (2.0 * s3 - 3.0 * s2 + 1.0) * keys[k].translation + (s3 - 2.0 * s2 + s) * length * slope(k) +
           (3.0 * s2 - 2.0 * s3) * keys[k + 1].translation + (s3 - s2) * length * slope(k + 1);
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
    if (after == keys.end() || motion.interpolation == model::Interpolation::Step)
        return pose_from(keys[k].rotation, keys[k].translation, motion.pivot);

    const double s = (time_s - keys[k].time_s) / (keys[k + 1].time_s - keys[k].time_s);
    const Quat rotation = glm::slerp(keys[k].rotation, keys[k + 1].rotation, s);
    const Vec3 translation = motion.interpolation == model::Interpolation::Cubic
                                 ? catmull_rom(keys, k, s)
                                 : glm::mix(keys[k].translation, keys[k + 1].translation, s);
    return pose_from(rotation, translation, motion.pivot);
}

std::vector<Pose> object_poses(const model::Scene& scene, double time_s) {
    std::vector<Pose> poses;
    poses.reserve(scene.objects.size());
    for (const model::Object& object : scene.objects)
        poses.push_back(object.motion ? pose_at(scene.motions[object.motion->value], time_s) : Pose{});
    return poses;
}

} // namespace kinelux::geometry
