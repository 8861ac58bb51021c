// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "model/scene.h"

namespace kinelux::geometry {

/// Whether what follows a motion is at two different poses in two frames of the scene.
bool changes_pose(const model::Scene& scene, MotionId motion);

/// What settling did to one object.
enum class Settled : std::uint8_t {
    AsItWas, ///< without motion, or it keeps the one it had
    AtRest,  ///< its motion never changes its pose in the frames: it was put there and has no motion any more
    WithOthers ///< it keeps its place relative to a body before it: both follow one motion now
};

/// Rewrites the rest positions and motions of bodies so that bodies follow different motions exactly if they move
/// relative to each other between frames, and none where they do not move at all. Whatever the motions are called and
/// however they are composed, their poses in the frames decide; every body's place in every frame stays what it was.
/// Motions that nothing follows any more are kept.
/// @return  one per object
std::vector<Settled> settle_motions(model::Scene& scene);

} // namespace kinelux::geometry
