// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/exact_engine.h"

#include <algorithm>
#include <map>

#include "core/parallel.h"
#include "motion/posed_elements.h"

namespace kinelux::motion {

namespace {

using geometry::ElementShape;
using model::ElementPair;

struct Ball {
    Vec3 centre;
    double radius;
};

std::vector<Ball> bounds_of_movers(std::span<const ElementShape> moving) {
    std::map<ObjectId, std::pair<Vec3, Vec3>> boxes;
    for (const ElementShape& element : moving) {
        const auto [entry, fresh] = boxes.try_emplace(element.object, element.box_low, element.box_high);
        entry->second.first = glm::min(entry->second.first, element.box_low);
        entry->second.second = glm::max(entry->second.second, element.box_high);
    }
    std::vector<Ball> balls;
    balls.reserve(boxes.size());
    for (const auto& [object, box] : boxes)
        balls.push_back({0.5 * (box.first + box.second), 0.5 * glm::length(box.second - box.first)});
    return balls;
}

// Whether a moving body takes light from a pair: rays between their nodes, against the moving bodies alone.
bool shaded(const ElementShape& a, const ElementShape& b, const visibility::Occluders& occluders) {
    const auto& xs = a.rules[0].nodes;
    const auto& ys = b.rules[0].nodes;
    const std::size_t probes = std::max(xs.size(), ys.size());
    constexpr std::size_t stride =
        11; // coprime to the usual node counts: pairs each node with a far one of the other
    for (std::size_t k = 0; k < probes; ++k)
        if (occluders.occluded(xs[k % xs.size()].position, ys[(stride * k) % ys.size()].position,
                               visibility::Among::Moving))
            return true;
    return false;
}

} // namespace

ExactEngine::ExactEngine(const model::Coefficients& coefficients, std::span<const ElementShape> rest_elements,
                         const model::Plan& plan, visibility::Occluders& occluders,
                         const kernel::TransportOptions& options)
    : coefficients_(coefficients),
      rest_(rest_elements),
      plan_(plan),
      occluders_(occluders),
      options_(options) {}

FrameBlocks ExactEngine::advance(double /*time_s*/, std::span<const geometry::Pose> poses) {
    FrameBlocks result;
    occluders_.set_poses(poses);
    if (plan_.moving_objects.empty()) return result;
    const PosedElements elements(rest_, plan_, poses);
    const std::vector<Ball> movers = bounds_of_movers(elements.moving());

    // Every candidate is examined in parallel into its own slot, then the slots are gathered in order.
    std::vector<ElementPair> candidates = coefficients_.moving_pairs;
    const std::size_t moving = candidates.size();
    if (plan_.moving_occlusion)
        candidates.insert(candidates.end(), coefficients_.crossed_pairs.begin(),
                          coefficients_.crossed_pairs.end());
    struct Slot {
        bool changed = false;
        kernel::TransportBlock block;
    };
    std::vector<Slot> slots(candidates.size());
    kernel::TransportOptions options = options_;
    options.occluders = plan_.moving_occlusion ? visibility::Among::All : visibility::Among::Resting;
    core::parallel_for(candidates.size(), [&](std::size_t k) {
        const ElementShape& a = elements[candidates[k].i];
        const ElementShape& b = elements[candidates[k].j];
        if (k >= moving) {
            const bool near = std::any_of(movers.begin(), movers.end(), [&](const Ball& ball) {
                return geometry::may_pass_between(a, b, ball.centre, ball.radius);
            });
            if (!near || !shaded(a, b, occluders_)) return;
        }
        slots[k] = {true, kernel::transport(a, b, occluders_, options)};
    });

    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < slots.size(); ++k)
        if (slots[k].changed) order.push_back(k);
    std::sort(order.begin(), order.end(),
              [&](std::size_t x, std::size_t y) { return candidates[x] < candidates[y]; });
    for (const std::size_t k : order) {
        const kernel::TransportBlock& block = slots[k].block;
        result.pairs.push_back(candidates[k]);
        ++result.computed;
        result.rays += block.rays;
        if (block.values.empty()) continue;
        result.blocks.entries.push_back(
            {candidates[k].i, candidates[k].j, result.blocks.values.size(), static_cast<float>(block.error)});
        for (const double value : block.values) result.blocks.values.push_back(static_cast<float>(value));
    }
    return result;
}

} // namespace kinelux::motion
