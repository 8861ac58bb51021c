// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/pose.h"
#include "model/coefficients.h"

namespace kinelux::motion {

/// The transport blocks that differ from the static ones at one time.
struct FrameBlocks {
    model::BlockSet blocks;                ///< replace or add to the static blocks; a listed pair without an
                                           ///< entry in `blocks` is zero now
    std::vector<model::ElementPair> pairs; ///< all pairs whose block is not the static one, sorted
    std::uint64_t computed = 0;            ///< blocks integrated for it; the others were expanded or kept
    std::uint64_t rays = 0;
};

/// How blocks change when bodies move: one way to get them at a time.
class Engine {
public:
    virtual ~Engine() = default;

    /// The blocks at the poses of one frame.
    /// @param time_s  of the frame [s]
    /// @param poses   world_from_rest, one per object of the scene
    virtual FrameBlocks advance(double time_s, std::span<const geometry::Pose> poses) = 0;

    /// Whether the blocks of a frame depend on the frames asked for before. An animation that is taken up again leads
    /// such an engine through those first.
    virtual bool remembers() const { return true; }

    virtual std::size_t bytes() const { return 0; }      ///< held for blocks at other times [B]
    virtual std::uint64_t prepared() const { return 0; } ///< blocks integrated before the first frame
};

} // namespace kinelux::motion
