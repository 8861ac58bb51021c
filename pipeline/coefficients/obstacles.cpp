// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/obstacles.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "geometry/pose.h"

namespace kinelux::coefficients {

namespace {

using geometry::ElementShape;
using geometry::Pose;

// Distance from a plane that counts as touching it, of the size of the riders.
constexpr double touching = 1e-6;

/// Collects balls; one that has moved by less than half its radius since the last is merged with it.
class BallTrack {
public:
    void add(const Vec3& centre, double radius) {
        if (current_ && glm::distance(current_->centre, centre) < 0.5 * radius) {
            current_->radius = std::max(current_->radius, glm::distance(current_->centre, centre) + radius);
            return;
        }
        if (current_) balls_.push_back(*current_);
        current_ = Ball{centre, radius};
    }
    void finish_into(std::vector<Ball>& result) {
        if (current_) balls_.push_back(*current_);
        result.insert(result.end(), balls_.begin(), balls_.end());
    }

private:
    std::optional<Ball> current_;
    std::vector<Ball> balls_;
};

struct Box {
    Vec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

    void add(const ElementShape& element) {
        low = glm::min(low, element.box_low);
        high = glm::max(high, element.box_high);
    }
    bool empty() const { return !(low.x <= high.x); }
    Vec3 centre() const { return 0.5 * (low + high); }
    double radius() const { return 0.5 * glm::length(high - low); }

    // Whether no corner lies truly behind a plane, or none before it.
    bool on_one_side(const Vec3& point, const Vec3& normal) const {
        bool before = false, behind = false;
        for (unsigned corner = 0; corner < 8; ++corner) {
            const Vec3 x((corner & 1U) != 0 ? high.x : low.x, (corner & 2U) != 0 ? high.y : low.y,
                         (corner & 4U) != 0 ? high.z : low.z);
            const double distance = glm::dot(x - point, normal);
            before = before || distance > touching * radius();
            behind = behind || distance < -touching * radius();
        }
        return !(before && behind);
    }
};

// Poses of all others seen from the riders: at rest, then at each frame; without motion the first entry of its list.
using Views = std::vector<Pose>;

Views views_of(const model::Scene& scene, MotionId carrier, const std::optional<MotionId>& other) {
    Views views{Pose{}};
    for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame) {
        const double time_s = scene.time.time_of_frame(frame);
        const Pose pose = other ? geometry::pose_at(scene, *other, time_s) : Pose{};
        views.push_back(geometry::pose_at(scene, carrier, time_s).inverse().after(pose));
    }
    return views;
}

} // namespace

std::vector<Ball> swept_balls(std::span<const ElementShape> rest_elements, const model::Scene& scene,
                              const model::Plan& plan) {
    std::vector<Ball> result;
    for (const ObjectId object : plan.moving_objects) {
        Box box;
        for (const ElementShape& element : rest_elements)
            if (element.object == object) box.add(element);
        if (box.empty()) continue;
        const MotionId motion = *scene.objects[object.value].motion;
        BallTrack track;
        for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame)
            track.add(geometry::pose_at(scene, motion, scene.time.time_of_frame(frame)).point(box.centre()),
                      box.radius());
        track.finish_into(result);
    }
    return result;
}

std::vector<Ball> obstacles_of_riders(std::span<const ElementShape> rest_elements, const model::Scene& scene,
                                      MotionId carrier) {
    const auto motion_of = [&](const ElementShape& element) {
        return scene.objects[element.object.value].motion;
    };
    Box riders;
    for (const ElementShape& element : rest_elements)
        if (motion_of(element) == carrier) riders.add(element);
    std::vector<Ball> result;
    if (riders.empty()) return result;
    std::map<std::optional<MotionId>, Views> views;
    for (const ElementShape& element : rest_elements) {
        const auto motion = motion_of(element);
        if (motion == carrier) continue;
        Views& seen = views[motion];
        if (seen.empty()) seen = views_of(scene, carrier, motion);
        BallTrack track;
        for (const Pose& pose : seen) {
            const Vec3 centre = pose.point(element.centre);
            if (glm::distance(centre, riders.centre()) > riders.radius() + element.radius) continue;
            if (element.planar && riders.on_one_side(centre, pose.direction(element.mean_normal))) continue;
            track.add(centre, element.radius);
        }
        track.finish_into(result);
    }
    return result;
}

} // namespace kinelux::coefficients
