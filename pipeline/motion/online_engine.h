// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "motion/body_tracks.h"
#include "motion/changing_pairs.h"
#include "motion/engine.h"
#include "motion/importance.h"

namespace kinelux::motion {

/// For poses that come one frame at a time, the future unknown: each block that changes is continued by the quadratic
/// through the last three times it was integrated, for as long as the light allows. What the quadratic is off by is
/// measured whenever the block is integrated anew; nothing is continued before it has been measured once. Whether
/// something stands between is decided by the shaft test in every frame; while it does a block is integrated at least
/// every third frame. A body that leaves its path, and a frame that is not later than the one before, start anew.
class OnlineEngine : public Engine {
public:
    /// Everything but `importance` must outlive the engine. @param occluders  is moved to each frame's poses
    /// @param tolerance  relative L2 error of radiosity that continuing may add in any frame [1]
    OnlineEngine(const model::Coefficients& coefficients,
                 std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan,
                 visibility::Occluders& occluders, const kernel::TransportOptions& options,
                 Importance importance, double tolerance, Watched watched = Watched::All);

    FrameBlocks advance(double time_s, std::span<const geometry::Pose> poses) override;

    /// From a newer estimate of the light.
    void set_importance(Importance importance) { importance_ = std::move(importance); }

    std::size_t bytes() const override;

private:
    static constexpr std::size_t most_known = 3;

    /// What is known of one pair's block.
    struct Memory {
        Change change = Change::None;
        bool measured = false;                    ///< `third` holds
        std::uint8_t known = 0;                   ///< times below that hold
        std::array<double, most_known> times_s{}; ///< of exact blocks, newest first [s]
        std::uint64_t frame = 0;                  ///< of the newest
        std::uint64_t gap = 1;                    ///< frames between the last two
        double third = 0.0;        ///< error of continuing per product of time differences [1/s3]
        double norm = 0.0;         ///< of the newest
        Glimpse glimpse;           ///< then, where something stands between
        double rate = 0.0;         ///< largest difference of two successive ones per frame
        float error = 0.0f;        ///< of integration, the largest of them
        std::vector<float> values; ///< of the blocks, newest first
    };
    struct Slot {
        Change change = Change::None;
        bool integrated = false;
        double error = 0.0;
        std::uint32_t rays = 0;
        std::vector<double> values; ///< empty: zero
    };

    Slot look(std::size_t k, double time_s, const ErrorBudget& budget);
    bool unmoved(std::size_t k, const Memory& memory) const;
    std::vector<double> continued(const Memory& memory, double time_s, std::size_t size) const;
    double expected_error(const Memory& memory, double time_s) const;
    bool foretold(std::size_t k, const Memory& memory, double constant, double allowed) const;
    void integrate(std::size_t k, double time_s, Memory& memory, Slot& slot);

    std::span<const geometry::ElementShape> rest_;
    ChangingPairs changing_;
    BodyTracks tracks_;
    Importance importance_;
    double tolerance_;
    std::vector<Memory> memories_; ///< per pair
    std::uint64_t frame_ = 0;      ///< frames fed
    double time_s_ = 0.0;          ///< of the last one
    std::size_t changing_before_ = 0;
};

} // namespace kinelux::motion
