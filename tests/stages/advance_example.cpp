// SPDX-License-Identifier: GPL-3.0-or-later
// Light of a room whose lamp somebody moves: one pose after the other, nothing known of the next. Prints what each frame
// took and how far it is from integrating all that changed. docs/motion.md explains it.
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <fmt/format.h>

#include "core/log.h"
#include "support/moving_rooms.h"

using namespace kinelux;

int main() {
    core::configure_log(core::Verbosity::Quiet, {});
    // The room's own motion only says that the lamp is one of the bodies that can move.
    support::PreparedRoom room(support::sliding_lamp(2));
    constexpr double tolerance = 1e-2;
    motion::OnlineEngine engine(room.coefficients, room.shapes, room.room.plan, room.occluders,
                                room.room.options, room.importance(), tolerance, motion::Watched::All);
    const auto exact = room.exact();

    std::vector<double> exitance, reflectance;
    for (const auto& shape : room.shapes) {
        const model::Material& material = room.room.scene.materials[shape.material.value];
        exitance.push_back(material.exitance.front());
        reflectance.push_back(material.reflectance.front());
    }
    exitance = solve::constant_coefficients(room.coefficients.layout, 1, room.areas, exitance);
    solve::BlockOperator transport(room.coefficients.layout, room.coefficients.static_blocks);

    std::vector<double> light;
    double largest = 0.0;
    std::uint64_t integrated = 0, changing = 0;
    for (int frame = 0; frame < 40; ++frame) {
        // The hand that holds the lamp: a curve that no keyframe knows, and a jump in its middle.
        const double t = frame / 25.0, jump = frame < 20 ? 0.0 : 0.4;
        std::vector<geometry::Pose> poses(room.room.scene.objects.size());
        poses[1] = {.rotation = glm::angleAxis(0.3 * std::sin(2.0 * t), Vec3(0, 0, 1)),
                    .translation = Vec3(0.5 * t + jump, 0.3 * std::sin(std::numbers::pi * t), -0.3 * t)};

        const motion::FrameBlocks changed = engine.advance(t, poses);
        transport.replace(changed.pairs, changed.blocks);
        // From the light of the frame before.
        const auto solved = solve::solve_system({transport, 1, exitance, reflectance, room.areas}, {}, light);
        light = solved.radiosity;

        const double off = room.difference(light, room.light(exact->advance(t, poses)));
        fmt::print("frame {:2}: {:3} of {:3} blocks integrated, {} sweeps, {:.3f} % off\n", frame,
                   changed.computed, changed.pairs.size(), solved.sweeps, 100.0 * off);
        largest = std::max(largest, off);
        integrated += changed.computed;
        changing += changed.pairs.size();
    }
    fmt::print("{} of {} blocks integrated, {:.3f} % off at most, {:.2f} MiB\n", integrated, changing,
               100.0 * largest, static_cast<double>(engine.bytes()) / 1048576.0);
    return largest <= tolerance && 3 * integrated < 2 * changing ? EXIT_SUCCESS : EXIT_FAILURE;
}
