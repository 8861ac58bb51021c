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
};

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

} // namespace kinelux::coefficients
