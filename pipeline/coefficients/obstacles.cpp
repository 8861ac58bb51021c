// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/obstacles.h"

#include <algorithm>
#include <limits>
#include <optional>

#include <glm/vector_relational.hpp>

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

    void add(const Vec3& box_low, const Vec3& box_high) {
        low = glm::min(low, box_low);
        high = glm::max(high, box_high);
    }
    // Whether more than the surfaces meet.
    bool meets(const Box& other) const {
        constexpr double touch = 1e-9; // of the size
        const double slack = touch * glm::length(high - low);
        return glm::all(glm::lessThan(low + slack, other.high)) &&
               glm::all(glm::lessThan(other.low, high - slack));
    }
    bool empty() const { return !(low.x <= high.x); }
    Vec3 centre() const { return 0.5 * (low + high); }
    double radius() const { return 0.5 * glm::length(high - low); }
};

Box posed_box(const ElementShape& element, const Pose& pose) {
    Box box;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3 x = pose.point({(corner & 1U) != 0 ? element.box_high.x : element.box_low.x,
                                   (corner & 2U) != 0 ? element.box_high.y : element.box_low.y,
                                   (corner & 4U) != 0 ? element.box_high.z : element.box_low.z});
        box.add(x, x);
    }
    return box;
}

} // namespace

std::vector<Ball> swept_balls(std::span<const ElementShape> rest_elements, const model::Scene& scene,
                              const model::Plan& plan) {
    std::vector<Ball> result;
    for (const ObjectId object : plan.moving_objects) {
        Box box;
        for (const ElementShape& element : rest_elements)
            if (element.object == object) box.add(element.box_low, element.box_high);
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

std::vector<std::uint8_t> met_motions(std::span<const ElementShape> rest_elements,
                                      const model::Scene& scene) {
    std::vector<std::uint8_t> result(scene.motions.size(), 0);
    for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame) {
        const auto poses = geometry::object_poses(scene, scene.time.time_of_frame(frame));
        std::vector<Box> carried(scene.motions.size()), boxes;
        for (const ElementShape& element : rest_elements) {
            boxes.push_back(posed_box(element, poses[element.object.value]));
            const auto& motion = scene.objects[element.object.value].motion;
            if (motion) carried[motion->value].add(boxes.back().low, boxes.back().high);
        }
        for (std::size_t e = 0; e < boxes.size(); ++e) {
            const auto& own = scene.objects[rest_elements[e].object.value].motion;
            for (std::size_t m = 0; m < carried.size(); ++m)
                if (!(own && own->value == m) && carried[m].meets(boxes[e])) result[m] = 1;
        }
    }
    return result;
}

} // namespace kinelux::coefficients
