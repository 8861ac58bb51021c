// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/settle.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "geometry/pose.h"

namespace kinelux::geometry {

namespace {

// Two paths are one if no point of the scene is farther from itself than this times the scene's size.
constexpr double same_place = 1e-9;

using Path = std::vector<Pose>; // one per frame

/// Four points that tell poses apart, and the distance that counts as none.
struct Probes {
    std::array<Vec3, 4> points;
    double tolerance;

    bool agree(const Pose& a, const Pose& b) const {
        return a == b || std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
                   return glm::distance(a.point(p), b.point(p)) <= tolerance;
               });
    }
    bool agree(const Path& a, const Path& b) const {
        return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                          [&](const Pose& x, const Pose& y) { return agree(x, y); });
    }
    bool rests(const Path& path) const {
        return std::all_of(path.begin(), path.end(),
                           [&](const Pose& pose) { return agree(pose, path.front()); });
    }
};

Probes probes_of(const model::Scene& scene) {
    Vec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const model::Object& object : scene.objects)
        for (const Vec3& point : object.mesh.points) {
            low = glm::min(low, point);
            high = glm::max(high, point);
        }
    if (!(low.x <= high.x)) low = high = Vec3(0.0); // no mesh yet
    const double extent = glm::distance(low, high);
    const double size = extent > 0.0 ? extent : 1.0;
    return {{low, low + Vec3(size, 0.0, 0.0), low + Vec3(0.0, size, 0.0), low + Vec3(0.0, 0.0, size)},
            same_place * size};
}

Path path_of(const model::Scene& scene, MotionId motion) {
    Path path;
    for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame)
        path.push_back(pose_at(scene, motion, scene.time.time_of_frame(frame)));
    return path;
}

// What a path does to a body since the first frame, seen from the world: equal for bodies that keep their distance.
Path since_start(const Path& path) {
    const Pose back = path.front().inverse();
    Path result;
    for (const Pose& pose : path) result.push_back(pose.after(back));
    return result;
}

void put(model::Mesh& mesh, const Pose& pose) {
    if (pose == Pose{}) return;
    for (Vec3& point : mesh.points) point = pose.point(point);
}

} // namespace

bool changes_pose(const model::Scene& scene, MotionId motion) {
    return !probes_of(scene).rests(path_of(scene, motion));
}

std::vector<Settled> settle_motions(model::Scene& scene) {
    struct Course {
        MotionId motion;
        Pose start;
        Path since_start;
    };
    std::vector<Settled> result(scene.objects.size(), Settled::AsItWas);
    if (std::none_of(scene.objects.begin(), scene.objects.end(), [](const auto& o) { return o.motion; }))
        return result;
    const Probes probes = probes_of(scene);
    std::vector<Course> leaders;
    std::map<MotionId, Path> paths;
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        model::Object& object = scene.objects[o];
        if (!object.motion) continue;
        Path& path = paths[*object.motion];
        if (path.empty()) path = path_of(scene, *object.motion);
        if (probes.rests(path)) {
            put(object.mesh, path.front());
            object.motion.reset();
            result[o] = Settled::AtRest;
            continue;
        }
        Path course = since_start(path);
        const auto leader = std::find_if(leaders.begin(), leaders.end(), [&](const Course& other) {
            return other.motion == *object.motion || probes.agree(other.since_start, course);
        });
        if (leader == leaders.end()) {
            leaders.push_back({*object.motion, path.front(), std::move(course)});
            continue;
        }
        if (leader->motion == *object.motion) continue;
        result[o] = Settled::WithOthers;
        if (!(leader->start == path.front())) put(object.mesh, leader->start.inverse().after(path.front()));
        object.motion = leader->motion;
    }
    return result;
}

} // namespace kinelux::geometry
