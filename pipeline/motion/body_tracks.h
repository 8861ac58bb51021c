// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "geometry/pose.h"
#include "model/plan.h"

namespace kinelux::motion {

/// Follows the bodies that move from frame to frame: which of them stand still, and which leave the path that their last
/// places led to expect (a start, a stop, a corner, a teleport).
class BodyTracks {
public:
    BodyTracks(std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan);

    /// Takes in one more frame. @param frame  its number, counting all frames fed, increasing
    /// @param time_s  later than that of the frame before; otherwise call forget() first
    void follow(std::uint64_t frame, double time_s, std::span<const geometry::Pose> poses);
    /// No expectations from what was seen so far; who moves with the next frame is still noticed.
    void forget();

    /// The last frame in which a body was elsewhere than in the frame before; 0 for bodies at rest.
    std::uint64_t moved_at(ObjectId object) const;
    std::uint64_t any_moved_at() const { return any_moved_at_; }
    /// Whether in the last frame a body was not where it was expected; nothing is expected of the frame after that.
    bool jumped(ObjectId object) const;
    bool any_jumped() const { return any_jumped_; }
    /// How far any point of a body moved to get to the last frame, at most; 0 for bodies at rest and in the first frame [m].
    double step(ObjectId object) const;

private:
    using Points = std::array<Vec3, 4>;
    struct Track {
        Points rest;
        double size;                  ///< of the body [m]
        std::array<Points, 3> places; ///< newest first
        std::size_t known = 0;        ///< places since it last left its path
        std::uint64_t moved_at = 0;
        bool jumped = false;
        double step = 0.0; ///< to the newest place [m]
    };
    Points expected(const Track& track, double time_s) const;

    std::vector<Track> tracks_;
    std::vector<std::size_t> track_of_; ///< per object; `none`
    std::array<double, 3> times_s_{};   ///< newest first
    bool placed_ = false;               ///< places[0] is that of the frame before
    std::uint64_t any_moved_at_ = 0;
    bool any_jumped_ = false;
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
};

} // namespace kinelux::motion
