// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/ids.h"
#include "geometry/element_shape.h"
#include "geometry/pose.h"
#include "model/plan.h"
#include "motion/rotation_series.h"
#include "motion/staircase.h"

namespace kinelux::motion {

/// A body as its motion sees it.
struct MovingBody {
    bool moves = false;
    Vec3 centre{0.0};    ///< of its box at rest, what it turns about [m]
    double radius = 0.0; ///< of its box [m]
};

/// One entry per object. @param rest  elements in order of ElementId
std::vector<MovingBody> moving_bodies(std::span<const geometry::ElementShape> rest, const model::Plan& plan);

/// How far a body has turned since a reference pose.
struct Turn {
    Mat3 R{1.0};              ///< of directions, now from reference
    Vec3 axis{0.0, 0.0, 1.0}; ///< unit
    double angle = 0.0;       ///< [rad], 0..pi

    double change_of_normals() const; ///< largest |n' - n| = 2 sin(angle/2) [1]
};

/// The motion of two bodies relative to each other since a reference time: the translation of their centres, as a
/// staircase along the predefined axes, and how far each has turned about its centre.
class PairTrack {
public:
    /// @param bodies  of both ends; poses of bodies that do not move are taken as the identity
    PairTrack(ObjectId first, ObjectId second, std::span<const MovingBody> bodies,
              std::span<const geometry::Pose> poses);

    ObjectId object(Turning end) const { return ends_[index(end)].object; }
    /// @param moves  of the staircase, >= 1
    void advance(std::span<const geometry::Pose> poses, int moves);

    /// Nothing has moved since the reference.
    bool still() const;
    /// Pose at the reference, world_from_rest.
    const geometry::Pose& reference(Turning end) const { return ends_[index(end)].reference; }
    const Turn& turn(Turning end) const { return ends_[index(end)].turn; }
    /// Longest way of any point of an element by its body's turn alone, 2 a sin(angle / 2) [m].
    double sweep(Turning end, const geometry::ElementShape& rest) const;
    /// Longest distance a between the axis of the turn and a point of an element [m].
    double arm(Turning end, const geometry::ElementShape& rest) const;

    const Staircase& stairs() const { return stairs_; } ///< of the second body as seen from the first
    double lag() const { return lag_; }                 ///< distance of the staircase from the path [m]

private:
    struct End {
        ObjectId object;
        MovingBody body;
        geometry::Pose reference;
        Turn turn;
        Vec3 moved{0.0}; ///< of the centre since the reference [m]
    };
    static std::size_t index(Turning end) { return end == Turning::First ? 0 : 1; }

    std::array<End, 2> ends_;
    Staircase stairs_;
    double lag_ = 0.0;
};

} // namespace kinelux::motion
