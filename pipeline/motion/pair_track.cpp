// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/pair_track.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kinelux::motion {

namespace {

constexpr double negligible_move = 1e-9; ///< of the bodies' size: not worth a move of a staircase

Turn turn_between(const geometry::Pose& from, const geometry::Pose& to) {
    Turn turn;
    if (from.rotation == to.rotation) return turn;
    Quat rotation = to.rotation * glm::conjugate(from.rotation);
    if (rotation.w < 0.0) rotation = -rotation;
    const Vec3 vector(rotation.x, rotation.y, rotation.z);
    const double sine = glm::length(vector);
    if (!(sine > 0.0)) return turn;
    return {glm::mat3_cast(rotation), vector / sine, 2.0 * std::atan2(sine, rotation.w)};
}

} // namespace

std::vector<MovingBody> moving_bodies(std::span<const geometry::ElementShape> rest, const model::Plan& plan) {
    std::size_t count = 0;
    for (const geometry::ElementShape& element : rest)
        count = std::max<std::size_t>(count, element.object.value + 1);
    std::vector<MovingBody> bodies(count);
    for (const ObjectId object : plan.moving_objects) {
        Vec3 low(std::numeric_limits<double>::infinity()), high(-low);
        for (const geometry::ElementShape& element : rest)
            if (element.object == object) {
                low = glm::min(low, element.box_low);
                high = glm::max(high, element.box_high);
            }
        if (low.x <= high.x) bodies[object.value] = {true, 0.5 * (low + high), 0.5 * glm::length(high - low)};
    }
    return bodies;
}

double Turn::change_of_normals() const { return 2.0 * std::sin(0.5 * angle); }

PairTrack::PairTrack(ObjectId first, ObjectId second, std::span<const MovingBody> bodies,
                     std::span<const geometry::Pose> poses) {
    for (const Turning end : {Turning::First, Turning::Second}) {
        const ObjectId object = end == Turning::First ? first : second;
        const MovingBody& body = bodies[object.value];
        ends_[index(end)] = {.object = object,
                             .body = body,
                             .reference = body.moves ? poses[object.value] : geometry::Pose{},
                             .turn = {}};
    }
}

void PairTrack::advance(std::span<const geometry::Pose> poses, int moves) {
    for (End& end : ends_) {
        if (!end.body.moves) continue;
        const geometry::Pose& now = poses[end.object.value];
        end.turn = turn_between(end.reference, now);
        end.moved = now.point(end.body.centre) - end.reference.point(end.body.centre);
    }
    const Vec3 target = ends_[1].moved - ends_[0].moved;
    stairs_.follow(target, moves, negligible_move * std::max(ends_[0].body.radius, ends_[1].body.radius));
    lag_ = glm::distance(target, stairs_.position());
}

bool PairTrack::still() const {
    return stairs_.length() == 0.0 && lag_ == 0.0 && ends_[0].turn.angle == 0.0 && ends_[1].turn.angle == 0.0;
}

double PairTrack::arm(Turning end, const geometry::ElementShape& rest) const {
    const End& e = ends_[index(end)];
    return glm::length(glm::cross(e.turn.axis, e.reference.direction(rest.centre - e.body.centre))) +
           rest.radius;
}

double PairTrack::sweep(Turning end, const geometry::ElementShape& rest) const {
    const double angle = ends_[index(end)].turn.angle;
    return angle > 0.0 ? 2.0 * arm(end, rest) * std::sin(0.5 * angle) : 0.0;
}

} // namespace kinelux::motion
