// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "coefficients/coefficients.h"
#include "geometry/pose.h"
#include "model/plan.h"
#include "motion/engine.h"
#include "support/shapes.h"

namespace kinelux::motion {

/// A box room with a lamp (object 1, material 1) that moves below the ceiling, facing down.
struct LampRoom {
    enum class Shelf { None, Resting, Moving };

    model::PatchSet set;
    model::Scene scene = support::plain_scene(3, 0.6);
    model::Plan plan{.degree = 1, .moving_objects = {ObjectId(1)}};

    /// @param keys   of the lamp's motion; the lamp's centre at rest is (0.4, 1, 1.7) and what it turns about
    /// @param shelf  a sheet below the lamp; a moving one goes from x = 0.5 to 0.9
    /// @param scale  of all lengths
    explicit LampRoom(std::vector<model::Keyframe> keys, Shelf shelf = Shelf::None, double scale = 1.0) {
        set.patches = support::box(Vec3(0), Vec3(2, 2, 2), support::Facing::Inwards);
        set.patches.push_back(support::rectangle(Vec3(0.2, 0.8, 1.7), Vec3(0, 0.4, 0), Vec3(0.4, 0, 0),
                                                 ObjectId(1), MaterialId(1)));
        if (shelf != Shelf::None)
            set.patches.push_back(
                support::rectangle(Vec3(0.5, 0.5, 1.0), Vec3(0.6, 0, 0), Vec3(0, 1, 0), ObjectId(2)));
        scene.materials.push_back({"lamp", {0.6}, {1.0}, model::Sides::Front});
        add_motion(1, "lamp", std::move(keys), Vec3(0.4, 1.0, 1.7), scale);
        if (shelf == Shelf::Moving) {
            add_motion(2, "shelf",
                       {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)}, {1.0, Vec3(0.4, 0, 0), Quat(1, 0, 0, 0)}},
                       Vec3(0.0), scale);
            plan.moving_objects.push_back(ObjectId(2));
        }
        scene.time = {0.0, 1.0, 41};
        for (model::Patch& patch : set.patches) {
            patch.surface.origin *= scale;
            for (Vec2& point : patch.points) point *= scale;
        }
    }

    visibility::Occluders occluders() const {
        auto bodies = visibility::bodies_of(set, scene);
        for (const ObjectId object : plan.moving_objects) bodies[object.value].moves = true;
        return visibility::Occluders(std::move(bodies));
    }

private:
    void add_motion(std::size_t object, const char* name, std::vector<model::Keyframe> keys,
                    const Vec3& pivot, double scale) {
        model::Motion motion;
        motion.name = name;
        motion.pivot = scale * pivot;
        for (model::Keyframe& key : keys) key.translation *= scale;
        motion.keyframes = std::move(keys);
        scene.objects[object].motion = MotionId(scene.motions.size());
        scene.motions.push_back(motion);
    }
};

inline model::Keyframe key(double time_s, const Vec3& moved, double angle = 0.0,
                           const Vec3& axis = Vec3(0, 0, 1)) {
    return {time_s, moved, glm::angleAxis(angle, glm::normalize(axis))};
}

/// The lamp's ways: along a predefined axis, along none, turning in place, and both at once.
inline std::vector<model::Keyframe> slide() { return {key(0.0, Vec3(0)), key(1.0, Vec3(1.0, 0, 0))}; }
inline std::vector<model::Keyframe> bend() {
    return {key(0.0, Vec3(0)), key(0.5, Vec3(0.6, 0.2, -0.05)), key(1.0, Vec3(0.8, -0.4, 0.02))};
}
inline std::vector<model::Keyframe> spin() {
    return {key(0.0, Vec3(0)), key(1.0, Vec3(0), 0.5, Vec3(1, 0.4, 0))};
}
inline std::vector<model::Keyframe> spin_and_slide() {
    return {key(0.0, Vec3(0)), key(1.0, Vec3(1.0, 0, 0), 0.5, Vec3(1, 0.4, 0))};
}

/// A room with its elements and the blocks of what rests.
struct PreparedRoom {
    LampRoom room;
    std::vector<geometry::ElementShape> shapes;
    visibility::Occluders occluders;
    kernel::TransportOptions options;
    model::Coefficients coefficients;

    PreparedRoom(LampRoom lamp_room, int n, double tolerance = 1e-3)
        : room(std::move(lamp_room)),
          shapes(support::shapes_of(room.set, n, room.plan.degree)),
          occluders(room.occluders()),
          options{.tolerance = tolerance},
          coefficients(
              coefficients::compute_coefficients(shapes, room.scene, room.plan, occluders, options, 1e6)) {}

    std::vector<geometry::Pose> poses(std::uint32_t frame) const {
        return geometry::object_poses(room.scene, room.scene.time.time_of_frame(frame));
    }
};

} // namespace kinelux::motion
