// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geometry/element_shape.h"
#include "kernel/transport.h"
#include "model/coefficients.h"
#include "model/plan.h"
#include "motion/engine.h"
#include "visibility/occluders.h"

namespace kinelux::motion {

/// Integrates anew what changes from frame to frame: blocks between bodies in relative motion, and static blocks that a
/// moving body really shades (found by rays against the moving bodies alone). Frames may come in any order.
class ExactEngine : public Engine {
public:
    /// All arguments must outlive the engine. @param occluders  is moved to each frame's poses
    ExactEngine(const model::Coefficients& coefficients,
                std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan,
                visibility::Occluders& occluders, const kernel::TransportOptions& options);

    FrameBlocks advance(double time_s, std::span<const geometry::Pose> poses) override;
    bool remembers() const override { return false; }

private:
    const model::Coefficients& coefficients_;
    std::span<const geometry::ElementShape> rest_;
    const model::Plan& plan_;
    visibility::Occluders& occluders_;
    kernel::TransportOptions options_;
};

} // namespace kinelux::motion
