// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
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

/// Whether distant groups of elements exchange light as one.
enum class Grouping : std::uint8_t {
    Auto,  ///< above GroupingOptions::most_elements, and where the blocks of all pairs would not fit
    Never, ///< every pair of elements has its own block
    Always,
};

struct GroupingOptions {
    Grouping use = Grouping::Auto;
    std::size_t most_elements =
        8000; ///< up to so many every pair is stored: below about 1 GiB, at one unknown each
    double share =
        0.5; ///< of the scene's accuracy that links may take, the rest is the blocks' and the basis' [1]
};

/// Where a computation that was interrupted goes on, and who keeps what this one has done.
struct Checkpoint {
    model::CoefficientsSoFar from; ///< of the same scene and options; empty: from the beginning
    std::function<void(const model::CoefficientsSoFar&)>
        save; ///< called between rows, by one thread; may throw to stop
};

/// The blocks of all pairs at rest relative to each other, with the occlusion by bodies that never move; and the lists
/// of pairs that change: bodies in relative motion, and pairs at rest that a moving body may come between (judged by the
/// pair's bounding spheres and the mover's bounds over all frames), or on one body that others reach into. In large
/// scenes links between groups take the
/// place of the blocks of distant pairs at rest that no moving body can come between (docs/hierarchy.md). Rows are computed in parallel; the result does
/// not depend on threads, nor on where it was interrupted (links are made anew then).
/// @param rest_elements  at rest, in order of ElementId
/// @param scene          settled, as clean leaves it (geometry::settle_motions): bodies on one motion, and no others,
///                       keep their distance
/// @throws ResourceError  the blocks would need more than memory_limit_mib
model::Coefficients compute_coefficients(std::span<const geometry::ElementShape> rest_elements,
                                         const model::Scene& scene, const model::Plan& plan,
                                         const visibility::Occluders& occluders,
                                         const kernel::TransportOptions& options, double memory_limit_mib,
                                         const GroupingOptions& grouping = {}, Checkpoint checkpoint = {});

/// A few of the rows that compute_coefficients would compute, evenly spread, and the time each took: what all would take.
struct RowSample {
    std::vector<std::size_t> rows;
    std::vector<double> seconds;      ///< of one thread, per row [s]
    model::Coefficients coefficients; ///< of these rows alone
};
/// Without groups. @param count  rows, at least 1; all where there are fewer @param others  as compute_coefficients
RowSample sample_rows(std::span<const geometry::ElementShape> rest_elements, const model::Scene& scene,
                      const model::Plan& plan, const visibility::Occluders& occluders,
                      const kernel::TransportOptions& options, std::size_t count);

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

/// The share of what leaves each element uniformly that reaches any other, blocks and links together: 1 in a closed
/// scene. @return  one per element [1]
std::vector<double> element_row_sums(const model::Coefficients& coefficients,
                                     std::span<const geometry::ElementShape> elements);

} // namespace kinelux::coefficients
