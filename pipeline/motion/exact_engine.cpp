// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/exact_engine.h"

#include "core/parallel.h"

namespace kinelux::motion {

ExactEngine::ExactEngine(const model::Coefficients& coefficients,
                         std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan,
                         visibility::Occluders& occluders, const kernel::TransportOptions& options,
                         Watched watched)
    : changing_(coefficients, rest_elements, plan, occluders, options, watched) {}

FrameBlocks ExactEngine::advance(double /*time_s*/, std::span<const geometry::Pose> poses) {
    FrameBlocks result;
    changing_.set_poses(poses);
    // Every pair is examined in parallel into its own slot, then the slots are gathered in order.
    struct Slot {
        Change change = Change::None;
        kernel::TransportBlock block;
    };
    const std::span<const model::ElementPair> pairs = changing_.pairs();
    std::vector<Slot> slots(pairs.size());
    core::parallel_for(pairs.size(), [&](std::size_t k) {
        const Change change = changing_.change(k);
        if (change == Change::None || change == Change::Zero) return; // no static block either
        slots[k] = {change, changing_.block(k, change)};
    });
    for (std::size_t k = 0; k < slots.size(); ++k) {
        if (slots[k].change == Change::None) continue;
        result.pairs.push_back(pairs[k]);
        ++result.computed;
        const kernel::TransportBlock& block = slots[k].block;
        result.rays += block.rays;
        if (block.values.empty()) continue;
        result.blocks.entries.push_back(
            {pairs[k].i, pairs[k].j, result.blocks.values.size(), static_cast<float>(block.error)});
        for (const double value : block.values) result.blocks.values.push_back(static_cast<float>(value));
    }
    return result;
}

} // namespace kinelux::motion
