// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "motion/changing_pairs.h"
#include "motion/engine.h"

namespace kinelux::motion {

/// Integrates anew what changes from frame to frame: blocks between bodies in relative motion, and static blocks whose
/// shaft another body enters. Frames may come in any order.
class ExactEngine : public Engine {
public:
    /// All arguments must outlive the engine. @param occluders  is moved to each frame's poses
    ExactEngine(const model::Coefficients& coefficients,
                std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan,
                visibility::Occluders& occluders, const kernel::TransportOptions& options,
                Watched watched = Watched::Listed);

    FrameBlocks advance(double time_s, std::span<const geometry::Pose> poses) override;
    bool remembers() const override { return false; }

private:
    ChangingPairs changing_;
};

} // namespace kinelux::motion
