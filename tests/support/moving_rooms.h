// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "coefficients/coefficients.h"
#include "motion/exact_engine.h"
#include "motion/offline_engine.h"
#include "motion/online_engine.h"
#include "solve/animation.h"
#include "support/shapes.h"

namespace kinelux::support {

/// A box room of 2 m with lamps and bodies that move in it; material 0 is grey, 1 shines.
struct MovingRoom {
    model::PatchSet set;
    model::Scene scene = plain_scene(1, 0.5);
    model::Plan plan{.degree = 1, .bounces = 10};
    int n = 2; ///< elements along the edge of a patch
    kernel::TransportOptions options{.tolerance = 1e-3, .sight_tolerance = 3e-3};

    explicit MovingRoom(std::uint32_t frames, int elements = 2) : n(elements) {
        set.patches = box(Vec3(0), Vec3(2), Facing::Inwards);
        scene.materials.push_back({"lamp", {0.0}, {10.0}, model::Sides::Front});
        scene.time = {0.0, 1.0, frames};
    }
    /// A new body of no patches yet.
    ObjectId body(const std::string& name) {
        scene.objects.push_back({.name = name});
        return ObjectId(scene.objects.size() - 1);
    }
    /// One side of a parallelogram.
    void side(ObjectId object, const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v,
              bool shines = false) {
        set.patches.push_back(rectangle(corner, edge_u, edge_v, object, MaterialId(shines ? 1 : 0)));
    }
    /// Both sides.
    void panel(ObjectId object, const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v) {
        side(object, corner, edge_u, edge_v);
        side(object, corner, edge_v, edge_u);
    }
    void move(const std::vector<ObjectId>& objects, std::vector<model::Keyframe> keys,
              const Vec3& pivot = Vec3(0),
              model::Interpolation interpolation = model::Interpolation::Linear) {
        model::Motion motion;
        motion.name = "motion";
        motion.interpolation = interpolation;
        motion.pivot = pivot;
        motion.keyframes = std::move(keys);
        for (const ObjectId object : objects) {
            scene.objects[object.value].motion = MotionId(scene.motions.size());
            plan.moving_objects.push_back(object);
        }
        scene.motions.push_back(std::move(motion));
    }
    void slide(ObjectId object, const Vec3& by) {
        move({object}, {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)}, {1.0, by, Quat(1, 0, 0, 0)}});
    }
    /// A full turn or a part of it about an axis through a point, in quarters.
    void turn(ObjectId object, const Vec3& axis, double degrees, const Vec3& pivot) {
        std::vector<model::Keyframe> keys;
        for (int k = 0; k <= 4; ++k)
            keys.push_back({0.25 * k, Vec3(0.0), glm::angleAxis(glm::radians(0.25 * k * degrees), axis)});
        move({object}, std::move(keys), pivot);
    }
    /// The same in another unit of length.
    MovingRoom scaled(double factor) const {
        MovingRoom room = *this;
        for (model::Patch& patch : room.set.patches) {
            patch.surface.origin *= factor;
            for (Vec2& point : patch.points) point *= factor;
        }
        for (model::Motion& motion : room.scene.motions) {
            motion.pivot *= factor;
            for (model::Keyframe& key : motion.keyframes) key.translation *= factor;
        }
        return room;
    }
};

/// A room with its blocks, ready for engines.
struct PreparedRoom {
    MovingRoom room;
    model::ClusterTree tree;
    std::vector<geometry::ElementShape> shapes;
    visibility::Occluders occluders;
    model::Coefficients coefficients;
    std::vector<double> areas;

    explicit PreparedRoom(MovingRoom made)
        : room(std::move(made)),
          tree(uniform_elements(room.set, room.n)),
          shapes(geometry::element_shapes(room.set, tree, room.plan.degree, 0)),
          occluders(visibility::bodies_of(room.set, room.scene)),
          coefficients(coefficients::compute_coefficients(shapes, room.scene, room.plan, occluders,
                                                          room.options, 1e6)) {
        for (const auto& shape : shapes) areas.push_back(shape.area);
    }
    PreparedRoom(const PreparedRoom&) = delete;
    PreparedRoom& operator=(const PreparedRoom&) = delete;

    double time(std::uint32_t frame) const { return room.scene.time.time_of_frame(frame); }
    std::vector<geometry::Pose> poses(std::uint32_t frame) const {
        return geometry::object_poses(room.scene, time(frame));
    }
    motion::PosePath path() const {
        motion::PosePath result;
        for (std::uint32_t frame = 0; frame < room.scene.time.frames; ++frame) {
            result.times_s.push_back(time(frame));
            result.poses.push_back(poses(frame));
        }
        return result;
    }
    solve::Animation animation() const { return {room.scene, room.plan, coefficients, tree.elements, areas}; }
    motion::Importance importance() {
        kernel::TransportOptions coarse = room.options;
        coarse.tolerance = coarse.sight_tolerance = 0.05;
        motion::ExactEngine engine(coefficients, shapes, room.plan, occluders, coarse);
        const std::uint32_t last = room.scene.time.frames - 1;
        return solve::importance_of(animation(), engine, std::vector<std::uint32_t>{0, last / 2, last});
    }
    std::unique_ptr<motion::Engine> exact() {
        return std::make_unique<motion::ExactEngine>(coefficients, shapes, room.plan, occluders,
                                                     room.options);
    }
    std::unique_ptr<motion::Engine> offline(double tolerance) {
        return std::make_unique<motion::OfflineEngine>(coefficients, shapes, room.plan, occluders,
                                                       room.options, path(), importance(), tolerance);
    }
    std::unique_ptr<motion::Engine> online(double tolerance, motion::Watched watched = motion::Watched::All) {
        return std::make_unique<motion::OnlineEngine>(coefficients, shapes, room.plan, occluders,
                                                      room.options, importance(), tolerance, watched);
    }
    /// Radiosity at one time, unknowns.
    std::vector<double> light(const motion::FrameBlocks& frame) const {
        solve::BlockOperator blocks(coefficients.layout, coefficients.static_blocks);
        blocks.replace(frame.pairs, frame.blocks);
        std::vector<double> exitance, reflectance;
        for (const auto& shape : shapes) {
            const auto& material = room.scene.materials[shape.material.value];
            exitance.push_back(material.exitance[0]);
            reflectance.push_back(material.reflectance[0]);
        }
        exitance = solve::constant_coefficients(coefficients.layout, 1, areas, exitance);
        return solve::solve_system({blocks, 1, exitance, reflectance, areas}, {.tolerance = 1e-9}, {})
            .radiosity;
    }
    /// Relative L2 difference over elements that do not emit.
    double difference(std::span<const double> found, std::span<const double> expected) const {
        double off = 0.0, size = 0.0;
        for (std::size_t e = 0; e < shapes.size(); ++e)
            for (std::size_t u = coefficients.layout.offsets[e]; u < coefficients.layout.offsets[e + 1];
                 ++u) {
                if (room.scene.materials[shapes[e].material.value].emits()) continue;
                off += (found[u] - expected[u]) * (found[u] - expected[u]);
                size += expected[u] * expected[u];
            }
        return std::sqrt(off / size);
    }
    std::vector<std::uint32_t> all_frames() const {
        std::vector<std::uint32_t> frames(room.scene.time.frames);
        std::iota(frames.begin(), frames.end(), 0u);
        return frames;
    }
};

/// What an engine gave at some frames.
struct Played {
    std::vector<std::vector<double>> light; ///< per frame fed
    std::uint64_t integrated = 0;           ///< blocks, before and during the frames
    std::uint64_t changing = 0;             ///< pairs that changed, over all frames
};

inline Played play(const PreparedRoom& room, motion::Engine& engine,
                   const std::vector<std::uint32_t>& frames) {
    Played result;
    for (const std::uint32_t frame : frames) {
        const auto blocks = engine.advance(room.time(frame), room.poses(frame));
        if (engine.prepared() == 0) result.integrated += blocks.computed;
        result.changing += blocks.pairs.size();
        result.light.push_back(room.light(blocks));
    }
    result.integrated += engine.prepared();
    return result;
}

/// The largest difference of light over the frames.
inline double largest_difference(const PreparedRoom& room, const Played& found, const Played& expected) {
    double largest = 0.0;
    for (std::size_t f = 0; f < expected.light.size(); ++f)
        largest = std::max(largest, room.difference(found.light[f], expected.light[f]));
    return largest;
}

/// A lamp that slides below the ceiling, nothing in between.
inline MovingRoom sliding_lamp(std::uint32_t frames, int n = 2) {
    MovingRoom room(frames, n);
    const ObjectId lamp = room.body("lamp");
    room.side(lamp, Vec3(0.2, 0.8, 1.7), Vec3(0, 0.4, 0), Vec3(0.4, 0, 0), true);
    room.slide(lamp, Vec3(1.2, 0.0, 0.0));
    return room;
}

/// A lamp that turns about its own centre, or about the room's.
inline MovingRoom turning_lamp(std::uint32_t frames, bool orbit, double degrees, int n = 2) {
    MovingRoom room(frames, n);
    const ObjectId lamp = room.body("lamp");
    const Vec3 corner = orbit ? Vec3(0.35, 0.8, 1.0) : Vec3(0.8, 0.8, 1.0);
    room.side(lamp, corner, Vec3(0, 0.4, 0), Vec3(0.4, 0, 0), true);
    room.turn(lamp, orbit ? Vec3(0, 0, 1) : Vec3(0, 1, 0), degrees, Vec3(1.0, 1.0, 1.0));
    return room;
}

/// A lamp at the ceiling, and a panel that slides between it and the floor.
inline MovingRoom sliding_panel(std::uint32_t frames, int n = 2) {
    MovingRoom room(frames, n);
    const ObjectId lamp = room.body("lamp"), panel = room.body("panel");
    room.side(lamp, Vec3(0.7, 0.7, 1.9), Vec3(0, 0.6, 0), Vec3(0.6, 0, 0), true);
    room.panel(panel, Vec3(0.1, 0.6, 1.1), Vec3(0.7, 0, 0), Vec3(0, 0.8, 0));
    room.slide(panel, Vec3(1.1, 0.0, 0.0));
    return room;
}

/// A lamp and a panel that pass each other, above a shelf that rests.
inline MovingRoom crossing_movers(std::uint32_t frames, int n = 2) {
    MovingRoom room(frames, n);
    const ObjectId lamp = room.body("lamp"), panel = room.body("panel"), shelf = room.body("shelf");
    room.side(lamp, Vec3(0.2, 0.8, 1.8), Vec3(0, 0.4, 0), Vec3(0.4, 0, 0), true);
    room.panel(panel, Vec3(1.2, 0.7, 1.3), Vec3(0.5, 0, 0), Vec3(0, 0.6, 0));
    room.panel(shelf, Vec3(0.1, 0.4, 0.6), Vec3(0.8, 0, 0), Vec3(0, 1.2, 0));
    room.slide(lamp, Vec3(1.2, 0.0, 0.0));
    room.slide(panel, Vec3(-0.9, 0.0, 0.0));
    return room;
}

} // namespace kinelux::support
