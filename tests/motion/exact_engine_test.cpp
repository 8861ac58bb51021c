// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/exact_engine.h"

#include <gtest/gtest.h>

#include "coefficients/coefficients.h"
#include "solve/transport_operator.h"
#include "support/shapes.h"

namespace kinelux::motion {
namespace {

// A box room with a lamp that slides under the ceiling.
struct LampRoom {
    model::PatchSet set;
    model::Scene scene = support::plain_scene(3, 0.6);
    model::Plan plan{.degree = 2, .moving_objects = {ObjectId(1)}};

    explicit LampRoom(bool with_shelf) {
        set.patches = support::box(Vec3(0), Vec3(2, 2, 2), support::Facing::Inwards);
        set.patches.push_back(
            support::rectangle(Vec3(0.2, 0.8, 1.8), Vec3(0, 0.4, 0), Vec3(0.4, 0, 0), ObjectId(1)));
        if (with_shelf)
            set.patches.push_back(
                support::rectangle(Vec3(0.5, 0.5, 1.0), Vec3(1, 0, 0), Vec3(0, 1, 0), ObjectId(2)));
        model::Motion motion;
        motion.name = "slide";
        motion.keyframes = {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)}, {1.0, Vec3(1.2, 0.0, 0.0), Quat(1, 0, 0, 0)}};
        scene.motions = {motion};
        scene.objects[1].motion = MotionId(0);
        scene.time = {0.0, 1.0, 5};
    }
    visibility::Occluders occluders() const {
        auto bodies = visibility::bodies_of(set, scene);
        bodies[1].moves = true;
        return visibility::Occluders(std::move(bodies));
    }
};

// The same room built anew with the lamp where it is at a time, everything at rest.
model::Coefficients from_scratch(const LampRoom& room, double time_s, int n) {
    LampRoom still = room;
    const auto pose = geometry::pose_at(room.scene.motions[0], time_s);
    for (auto& patch : still.set.patches)
        if (patch.object == ObjectId(1)) patch.surface.origin = pose.point(patch.surface.origin);
    still.scene.objects[1].motion.reset();
    const auto shapes = support::shapes_of(still.set, n, 2);
    const auto occluders = support::occluders_of(still.set, still.scene);
    return coefficients::compute_coefficients(shapes, still.scene, {.degree = 2}, occluders,
                                              {.tolerance = 1e-3}, 1e6);
}

TEST(ExactEngine, frames_equal_a_scene_built_anew) {
    for (const bool with_shelf : {false, true}) {
        LampRoom room(with_shelf);
        const int n = 2;
        const auto shapes = support::shapes_of(room.set, n, 2);
        auto occluders = room.occluders();
        const kernel::TransportOptions options{.tolerance = 1e-3};
        const auto coefficients =
            coefficients::compute_coefficients(shapes, room.scene, room.plan, occluders, options, 1e6);
        ExactEngine engine(coefficients, shapes, room.plan, occluders, options);
        solve::BlockOperator moving(coefficients.layout, coefficients.static_blocks);
        std::vector<double> x(coefficients.layout.unknowns());
        for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::sin(static_cast<double>(k));
        std::vector<double> y(x.size()), expected(x.size());
        for (const double time : {0.0, 0.5, 1.0, 0.25}) {
            const auto frame = engine.advance(time, geometry::object_poses(room.scene, time));
            moving.replace(frame.pairs, frame.blocks);
            solve::apply(moving, 1, x, y);
            const auto anew = from_scratch(room, time, n);
            const solve::BlockOperator still(anew.layout, anew.static_blocks);
            solve::apply(still, 1, x, expected);
            double difference = 0.0, size = 0.0;
            for (std::size_t k = 0; k < x.size(); ++k) {
                difference += (y[k] - expected[k]) * (y[k] - expected[k]);
                size += expected[k] * expected[k];
            }
            // Quadrature is planned anew, and turns by rounding.
            EXPECT_LT(std::sqrt(difference / size), 1e-3) << "time " << time << " shelf " << with_shelf;
        }
    }
}

} // namespace
} // namespace kinelux::motion
