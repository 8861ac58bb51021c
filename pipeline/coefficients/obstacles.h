// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
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

/// Per motion whether in some frame anything that it does not carry reaches into the box of all that it does.
/// @param scene  settled (geometry::settle_motions): bodies that keep their distance are on one motion
std::vector<std::uint8_t> met_motions(std::span<const geometry::ElementShape> rest_elements,
                                      const model::Scene& scene);

} // namespace kinelux::coefficients
