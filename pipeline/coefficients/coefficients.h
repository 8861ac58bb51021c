// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "kernel/transport.h"
#include "model/coefficients.h"
#include "model/plan.h"
#include "model/scene.h"
#include "visibility/occluders.h"

namespace kinelux::coefficients {

/// Transport options for a scene's accuracy, its reflectances and the plan's effects: errors of rows are multiplied by
/// the bounces, rho / (1 - rho), so blocks must be the better the brighter the scene.
kernel::TransportOptions transport_options_for(const model::Scene& scene, const model::Plan& plan,
                                               std::span<const geometry::ElementShape> elements);

/// How the unknowns of all elements follow each other. @param elements  in order of ElementId
model::UnknownLayout unknown_layout(std::span<const geometry::ElementShape> elements);

/// The blocks of all pairs at rest relative to each other, with the occlusion by bodies that never move; and the lists
/// of pairs that change: bodies in relative motion, and pairs at rest that a moving body may come between (judged by
/// the pair's bounding spheres and the mover's bounds over all frames). Rows are computed in parallel; the result does
/// not depend on threads.
/// @param rest_elements  at rest, in order of ElementId
/// @throws ResourceError  the blocks would need more than memory_limit_mib
model::Coefficients compute_coefficients(std::span<const geometry::ElementShape> rest_elements,
                                         const model::Scene& scene, const model::Plan& plan,
                                         const visibility::Occluders& occluders,
                                         const kernel::TransportOptions& options, double memory_limit_mib);

/// Form factors between groups of elements (objects, or patches): F_ab is the share of what leaves a uniformly that
/// reaches b; rows of a closed scene sum to 1.
struct FormFactor {
    std::uint32_t from, to;
    double value;          ///< [1]
    double error_estimate; ///< [1]
};
/// @param group_of  one group number per element
std::vector<FormFactor> form_factors(const model::Coefficients& coefficients,
                                     std::span<const geometry::ElementShape> elements,
                                     std::span<const std::uint32_t> group_of, std::uint32_t groups);

} // namespace kinelux::coefficients
