// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/changing_pairs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "kernel/far_pair.h"
#include "visibility/pair_blockers.h"
#include "visibility/polygon_blockers.h"

namespace kinelux::motion {

using geometry::ElementShape;
using model::ElementPair;
using visibility::Among;

ChangingPairs::ChangingPairs(const model::Coefficients& coefficients,
                             std::span<const ElementShape> rest_elements, const model::Plan& plan,
                             visibility::Occluders& occluders, const kernel::TransportOptions& options,
                             Watched watched)
    : coefficients_(coefficients),
      rest_(rest_elements),
      plan_(plan),
      occluders_(occluders),
      options_(options) {
    options_.occluders = plan.moving_occlusion ? Among::All : Among::Resting;
    std::size_t objects = 0;
    for (const ElementShape& element : rest_)
        objects = std::max<std::size_t>(objects, element.object.value + 1);
    for (const ObjectId object : plan.moving_objects)
        objects = std::max<std::size_t>(objects, object.value + 1);
    moving_.assign(objects, 0);
    for (const ObjectId object : plan.moving_objects) moving_[object.value] = 1;
    list_pairs(watched);
    ends_.reserve(rest_.size());
    for (const ElementShape& element : rest_) ends_.push_back(visibility::shaft_end(element));
}

void ChangingPairs::list_pairs(Watched watched) {
    std::vector<std::pair<ElementPair, Kind>> listed;
    for (const ElementPair& pair : coefficients_.moving_pairs) listed.emplace_back(pair, Kind::Moving);
    const auto add = [&](const ElementPair& pair) {
        const Kind kind = moves(pair.i) ? Kind::Riding : Kind::Resting;
        if (kind == Kind::Riding ? options_.occlusion : plan_.moving_occlusion)
            listed.emplace_back(pair, kind);
    };
    if (watched == Watched::All)
        for (const model::BlockEntry& entry : coefficients_.static_blocks.entries) add({entry.i, entry.j});
    else
        for (const ElementPair& pair : coefficients_.crossed_pairs) add(pair);
    if (plan_.moving_objects.empty()) listed.clear();
    std::sort(listed.begin(), listed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [pair, kind] : listed) {
        pairs_.push_back(pair);
        kinds_.push_back(kind);
    }
    if (std::find(kinds_.begin(), kinds_.end(), Kind::Riding) != kinds_.end()) find_others();
}

// Bodies that move are carried along with each other when no pair of their elements is in relative motion.
void ChangingPairs::find_others() {
    others_.assign(moving_.size(), {});
    for (const ObjectId object : plan_.moving_objects) {
        auto& others = others_[object.value];
        others.resize(moving_.size());
        for (std::size_t other = 0; other < others.size(); ++other)
            others[other] = moving_[other] == 0 ? 1 : 0;
    }
    for (const ElementPair& pair : coefficients_.moving_pairs) {
        const std::size_t a = rest_[pair.i].object.value, b = rest_[pair.j].object.value;
        if (a == b || moving_[a] == 0 || moving_[b] == 0) continue;
        others_[a][b] = 1;
        others_[b][a] = 1;
    }
}

void ChangingPairs::set_poses(std::span<const geometry::Pose> poses, std::span<const std::uint8_t> wanted) {
    occluders_.set_poses(poses);
    elements_.emplace(rest_, plan_, poses, wanted);
    for (const ElementShape& element : elements_->moving())
        ends_[element.id.value] = visibility::shaft_end(element);
    if (wanted.empty()) bound_movers();
}

void ChangingPairs::bound_movers() {
    std::map<ObjectId, std::pair<Vec3, Vec3>> boxes;
    for (const ElementShape& element : elements_->moving()) {
        const auto [entry, fresh] = boxes.try_emplace(element.object, element.box_low, element.box_high);
        entry->second.first = glm::min(entry->second.first, element.box_low);
        entry->second.second = glm::max(entry->second.second, element.box_high);
    }
    movers_.clear();
    for (const auto& [object, box] : boxes)
        movers_.push_back({0.5 * (box.first + box.second), 0.5 * glm::length(box.second - box.first)});
}

bool ChangingPairs::mover_near(const ElementPair& pair) const {
    return std::any_of(movers_.begin(), movers_.end(), [&](const Ball& ball) {
        return geometry::may_pass_between(rest_[pair.i], rest_[pair.j], ball.centre, ball.radius);
    });
}

Change ChangingPairs::unshaded(const ElementPair& pair, double step_m) const {
    if (step_m > 0.0 && visibility::separation(ends_[pair.i], ends_[pair.j]) < step_m) return Change::Near;
    return kernel::cut_by_horizon((*elements_)[pair.i], (*elements_)[pair.j]) ? Change::Horizon
                                                                              : Change::Clear;
}

Change ChangingPairs::change(std::size_t k, double step_m) const {
    const ElementPair& pair = pairs_[k];
    if (kinds_[k] == Kind::Resting && !mover_near(pair)) return Change::None;
    if (kinds_[k] == Kind::Moving) {
        if (!kernel::may_exchange((*elements_)[pair.i], (*elements_)[pair.j])) return Change::Zero;
        if (!options_.occlusion || occluders_.empty()) return unshaded(pair, step_m);
    }
    thread_local visibility::PairBlockers blockers;
    const Among among = kinds_[k] == Kind::Resting ? Among::Moving : options_.occluders;
    const std::span<const std::uint8_t> counts =
        kinds_[k] == Kind::Riding ? std::span<const std::uint8_t>(others_[rest_[pair.i].object.value])
                                  : std::span<const std::uint8_t>();
    const bool between =
        blockers.any_between(ends_[pair.i], ends_[pair.j], occluders_.polygons(), among, counts);
    if (between) return Change::Shaded;
    return kinds_[k] == Kind::Moving ? unshaded(pair, step_m) : Change::None;
}

Glimpse ChangingPairs::glimpse(std::size_t k) const {
    constexpr std::size_t stride = 7; // pairs every node with others
    const ElementShape& a = (*elements_)[pairs_[k].i];
    const ElementShape& b = (*elements_)[pairs_[k].j];
    const auto& xs = a.rules[1].nodes;
    const auto& ys = b.rules[1].nodes;
    const Among among = kinds_[k] == Kind::Resting ? Among::Moving : options_.occluders;
    Glimpse sum;
    double weights = 0.0;
    for (std::size_t s = 0; s < Glimpse::segments; ++s) {
        const auto& x = xs[s * xs.size() / Glimpse::segments];
        const auto& y = ys[(stride * s) % ys.size()];
        const double weight = x.weight * y.weight, kernel = kernel::kernel_value(x, y);
        weights += weight;
        if (!(kernel > 0.0)) continue;
        sum.whole += weight * kernel;
        if (!occluders_.occluded(x.sight_point(), y.sight_point(), among)) sum.visible += weight * kernel;
    }
    const double scale = std::sqrt(a.area * b.area) / weights;
    return {scale * sum.visible, scale * sum.whole};
}

kernel::TransportBlock ChangingPairs::block(std::size_t k, Change change) const {
    if (change == Change::Zero) return {};
    kernel::TransportOptions options = options_;
    if (change != Change::Shaded) options.occlusion = false;
    return kernel::transport((*elements_)[pairs_[k].i], (*elements_)[pairs_[k].j], occluders_, options);
}

} // namespace kinelux::motion
