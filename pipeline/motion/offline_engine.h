// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "motion/block_path.h"
#include "motion/body_tracks.h"
#include "motion/changing_pairs.h"
#include "motion/engine.h"
#include "motion/importance.h"

namespace kinelux::motion {

/// Where all bodies are at the frames of an animation.
struct PosePath {
    std::vector<double> times_s;                    ///< increasing [s]
    std::vector<std::vector<geometry::Pose>> poses; ///< per frame, one per object
};

/// For paths that are known: each block that changes is made a piecewise polynomial in time, once, as exact as the light
/// needs it; blocks at any time within the path are then expanded from it, in any order. Which pairs change, and where
/// something may stand between, is decided by the shaft test at every frame. Between frames blocks are interpolated.
class OfflineEngine : public Engine {
public:
    /// Makes the polynomials. Everything but `path` and `importance` must outlive the engine.
    /// @param tolerance  relative L2 error of radiosity that interpolation may add in any frame [1]
    OfflineEngine(const model::Coefficients& coefficients,
                  std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan,
                  visibility::Occluders& occluders, const kernel::TransportOptions& options,
                  const PosePath& path, const Importance& importance, double tolerance);

    /// @param time_s  within the path; outside of it the nearest end is taken
    /// @param poses   not used: the path has them
    FrameBlocks advance(double time_s, std::span<const geometry::Pose> poses) override;

    bool remembers() const override { return false; }
    std::size_t bytes() const override;
    std::uint64_t prepared() const override { return prepared_; }

private:
    struct Slot;
    void find_runs(ChangingPairs& changing, BodyTracks& tracks, const PosePath& path,
                   std::span<const geometry::ElementShape> rest);
    double bound_of(const model::ElementPair& pair, std::size_t size) const;
    void integrate(ChangingPairs& changing, const PosePath& path);
    double position_of(double time_s) const;
    void add_static(const model::ElementPair& pair, double weight, Slot& slot) const;
    Slot slot_at(std::size_t path, double position) const;

    const model::Coefficients& coefficients_;
    std::vector<double> times_s_;
    std::vector<std::size_t> pairs_; ///< into ChangingPairs::pairs(), of those that change, increasing
    std::vector<model::ElementPair> elements_; ///< of them
    std::vector<BlockPath> paths_;             ///< of them
    std::vector<std::uint8_t> visits_;         ///< per element, scratch: belongs to a task
    std::size_t most_at_once_ = 0;             ///< pairs that change in one frame
    std::uint64_t prepared_ = 0;
};

} // namespace kinelux::motion
