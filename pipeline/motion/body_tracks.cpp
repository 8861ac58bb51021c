// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/body_tracks.h"

#include <algorithm>
#include <limits>

namespace kinelux::motion {

namespace {

// Of a step: who is further from where it was expected has left its path. On a circle the quadratic misses by the square
// of the angle, which is this for steps of 18 degrees.
constexpr double off_the_path = 0.1;
constexpr double off_the_line = 0.5; // the same where only two places are known: on a circle 30 degrees
constexpr double rounding = 1e-12;   // of a body's size and distance: steps below are none

} // namespace

BodyTracks::BodyTracks(std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan) {
    std::size_t objects = 0;
    for (const ObjectId object : plan.moving_objects)
        objects = std::max<std::size_t>(objects, object.value + 1);
    track_of_.assign(objects, none);
    for (const ObjectId object : plan.moving_objects) {
        Vec3 low(std::numeric_limits<double>::infinity()), high(-low);
        for (const geometry::ElementShape& element : rest_elements)
            if (element.object == object) {
                low = glm::min(low, element.box_low);
                high = glm::max(high, element.box_high);
            }
        if (!(low.x <= high.x)) continue;
        const double size = glm::length(high - low);
        const Vec3 centre = 0.5 * (low + high);
        track_of_[object.value] = tracks_.size();
        tracks_.push_back({.rest = {centre, centre + Vec3(size, 0, 0), centre + Vec3(0, size, 0),
                                    centre + Vec3(0, 0, size)},
                           .size = size,
                           .places = {}});
    }
}

// The polynomial through the last places, at a time.
BodyTracks::Points BodyTracks::expected(const Track& track, double time_s) const {
    Points result{};
    for (std::size_t n = 0; n < track.known; ++n) {
        double weight = 1.0;
        for (std::size_t m = 0; m < track.known; ++m)
            if (m != n) weight *= (time_s - times_s_[m]) / (times_s_[n] - times_s_[m]);
        for (std::size_t p = 0; p < result.size(); ++p) result[p] += weight * track.places[n][p];
    }
    return result;
}

void BodyTracks::forget() {
    for (Track& track : tracks_) track.known = 0;
}

void BodyTracks::follow(std::uint64_t frame, double time_s, std::span<const geometry::Pose> poses) {
    any_jumped_ = false;
    for (std::size_t object = 0; object < track_of_.size(); ++object) {
        if (track_of_[object] == none) continue;
        Track& track = tracks_[track_of_[object]];
        Points places{};
        for (std::size_t p = 0; p < places.size(); ++p) places[p] = poses[object].point(track.rest[p]);
        double step = 0.0, off = 0.0;
        const Points where = expected(track, time_s);
        for (std::size_t p = 0; p < places.size(); ++p) {
            step = std::max(step, glm::distance(places[p], track.places[0][p]));
            off = std::max(off, glm::distance(places[p], where[p]));
        }
        const double slack = rounding * (track.size + glm::length(places[0]));
        if (!placed_ || step > slack) {
            track.moved_at = frame;
            any_moved_at_ = frame;
        }
        track.step = placed_ ? step : 0.0;
        const double share = track.known > 2 ? off_the_path : off_the_line;
        track.jumped = track.known > 1 && off > share * step + slack;
        any_jumped_ = any_jumped_ || track.jumped;
        track.known = track.jumped ? 1 : std::min<std::size_t>(track.known + 1, track.places.size());
        track.places = {places, track.places[0], track.places[1]};
    }
    times_s_ = {time_s, times_s_[0], times_s_[1]};
    placed_ = true;
}

std::uint64_t BodyTracks::moved_at(ObjectId object) const {
    const bool tracked = object.value < track_of_.size() && track_of_[object.value] != none;
    return tracked ? tracks_[track_of_[object.value]].moved_at : 0;
}

bool BodyTracks::jumped(ObjectId object) const {
    return object.value < track_of_.size() && track_of_[object.value] != none &&
           tracks_[track_of_[object.value]].jumped;
}

double BodyTracks::step(ObjectId object) const {
    const bool tracked = object.value < track_of_.size() && track_of_[object.value] != none;
    return tracked ? tracks_[track_of_[object.value]].step : 0.0;
}

} // namespace kinelux::motion
