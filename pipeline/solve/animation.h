// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "model/cluster_tree.h"
#include "model/coefficients.h"
#include "model/plan.h"
#include "model/scene.h"
#include "model/solution.h"
#include "motion/engine.h"
#include "motion/importance.h"
#include "solve/solve.h"

namespace kinelux::solve {

/// What an animation is solved from; everything must outlive the call.
struct Animation {
    const model::Scene& scene;
    const model::Plan& plan;
    const model::Coefficients& coefficients;
    std::span<const model::Element> elements; ///< in order of ElementId
    std::span<const double> areas;            ///< one per element [m2]
};

/// How an animation is interrupted and taken up again.
struct Checkpoint {
    model::SolutionSoFar from = {}; ///< of the first of the same frames; empty: begin at the first
    /// Called after each frame with all that is done so far.
    std::function<void(const model::Solution&, const model::SolverState&)> save = {};
};

/// Solves the frames one after the other: the blocks of each from the engine, the light from the frames before it.
/// Scenes in which all channels are proportional are solved once and scaled; a plan without bounces gives the direct
/// light alone. Each frame carries its error estimate: of irradiance per element from the errors of the blocks and the
/// residual, of radiosity over all.
/// @param frames    numbers of the frames to solve, ascending
/// @param progress  called after each frame and after `save`; what it throws ends the work
/// @param checkpoint  an animation taken up again gives the bytes of one that was never interrupted
model::Solution solve_animation(const Animation& animation, motion::Engine& engine,
                                std::span<const std::uint32_t> frames, const SolveOptions& options,
                                const std::function<void(const model::FrameSolution&)>& progress,
                                Checkpoint checkpoint = {});

/// How much the error of each pair's block matters, from the light of a few frames solved to a hundredth.
/// @param engine  may be coarse
/// @param frames  at least one; three say enough
motion::Importance importance_of(const Animation& animation, motion::Engine& engine,
                                 std::span<const std::uint32_t> frames);

/// All blocks as they are at one time: the static ones, with those of `frame` in their place.
model::BlockSet blocks_at(const model::BlockSet& static_blocks, const motion::FrameBlocks& frame);

/// RMS error of irradiance on each element that is to be expected: sqrt((sum_j (error_ij ||B_j||)^2 + basis_i) / A_i + r^2),
/// of the blocks (errors independent of each other), of the basis (how its degrees fall, in the indirect
/// irradiance) and of the solver's residual. Errors of links are spread over the elements of their groups. An estimate,
/// not a bound.
/// @param frame  with radiosity, indirect irradiance and residual
/// @return  one per element, the RMS over channels [W/m2 or lx]
std::vector<float> irradiance_errors(const model::UnknownLayout& layout,
                                     std::span<const model::BlockEntry> blocks, std::span<const double> areas,
                                     std::span<const double> exitance, const model::FrameSolution& frame,
                                     std::size_t channels, const model::Hierarchy& hierarchy = {});

} // namespace kinelux::solve
