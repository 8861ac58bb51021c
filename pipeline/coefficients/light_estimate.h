// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "model/coefficients.h"
#include "model/scene.h"

namespace kinelux::coefficients {

/// How bright elements are about to be, mean of the channels: what the errors of links are weighed with.
struct LightEstimate {
    std::vector<double> exitance, reflectance; ///< one per element
    std::vector<double> radiosity;             ///< one per element, same unit as exitance
    std::vector<double> irradiance;            ///< one per element, same unit
};

/// Light of lamps at their brightest, spread evenly, as in a closed scene: E = flux / (area (1 - mean reflectance)). Without light E = B = 1.
LightEstimate even_light(std::span<const geometry::ElementShape> elements, const model::Scene& scene);

/// The same after a few bounces through links, which the pairs of near elements are missing from; nowhere below a tenth
/// of the even light.
/// @param hierarchy  with links
LightEstimate linked_light(const LightEstimate& even, std::span<const geometry::ElementShape> elements,
                           const model::Hierarchy& hierarchy);

} // namespace kinelux::coefficients
