// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "geometry/pose.h"
#include "kernel/transport.h"
#include "model/coefficients.h"
#include "model/plan.h"
#include "model/scene.h"
#include "visibility/occluders.h"

namespace kinelux::motion {

/// The transport blocks that differ from the static ones at one time.
struct FrameBlocks {
    model::BlockSet blocks;                ///< replace or add to the static blocks; a listed pair without an
                                           ///< entry in `blocks` is zero now
    std::vector<model::ElementPair> pairs; ///< all pairs whose block is not the static one, sorted
    std::uint64_t rays = 0;
};

/// Recomputes what changes from frame to frame: blocks between bodies in relative motion, and static blocks that a
/// moving body really shades (found by rays against the moving bodies alone).
class FrameUpdater {
public:
    /// All arguments must outlive the updater. @param occluders  is moved to each frame's poses
    FrameUpdater(const model::Coefficients& coefficients,
                 std::span<const geometry::ElementShape> rest_elements, const model::Scene& scene,
                 const model::Plan& plan, visibility::Occluders& occluders,
                 const kernel::TransportOptions& options);

    /// The blocks at a time [s]; frames may be asked for in any order.
    FrameBlocks at(double time_s);

private:
    const model::Coefficients& coefficients_;
    std::span<const geometry::ElementShape> rest_;
    const model::Scene& scene_;
    const model::Plan& plan_;
    visibility::Occluders& occluders_;
    kernel::TransportOptions options_;
};

} // namespace kinelux::motion
