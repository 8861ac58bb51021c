// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "coefficients/links.h"
#include "geometry/element_shape.h"
#include "model/plan.h"
#include "model/scene.h"

namespace kinelux::coefficients {

/// Balls that cover each moving body at all frames; neighbouring positions share one.
std::vector<Ball> swept_balls(std::span<const geometry::ElementShape> rest_elements,
                              const model::Scene& scene, const model::Plan& plan);

/// What may come between bodies that ride on one motion: balls around elements of all others, resting or moving, at
/// rest and at all frames, in the place where the riders see them from their own rest position. Flat elements that have
/// all riders on one side in a frame come between none of them and are left out of it.
/// @param carrier  a motion that some moving object follows; the scene is settled (geometry::settle_motions)
std::vector<Ball> obstacles_of_riders(std::span<const geometry::ElementShape> rest_elements,
                                      const model::Scene& scene, MotionId carrier);

} // namespace kinelux::coefficients
