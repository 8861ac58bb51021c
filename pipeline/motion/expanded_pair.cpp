// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/expanded_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "motion/pair_geometry.h"
#include "motion/translation_series.h"

namespace kinelux::motion {

namespace {

using geometry::ElementShape;
using geometry::SurfaceNode;

constexpr std::array<Turning, 2> both_ends{Turning::First, Turning::Second};

// An element at a pose; only what moves is copied.
class Placed {
public:
    Placed(const ElementShape& rest, const geometry::Pose& pose) : rest_(rest) {
        if (!(pose == geometry::Pose{})) moved_ = geometry::moved(rest, pose);
    }
    const ElementShape& operator*() const { return moved_ ? *moved_ : rest_; }

private:
    const ElementShape& rest_;
    std::optional<ElementShape> moved_;
};

} // namespace

void ExpandedPair::reset(kernel::TransportBlock block, const ElementShape& a, const ElementShape& b,
                         bool clear, std::shared_ptr<const PairTrack> track) {
    reference_ = std::move(block);
    track_ = std::move(track);
    clear_ = clear;
    measured_ = false;
    facing_ = wholly_facing(a, b);
    least_distance_ = least_distance(a, b);
    normals_ = {a.mean_normal, b.mean_normal};
    terms_.clear();
}

bool ExpandedPair::needs(std::size_t expansion) const {
    if (expansion < axis_count) return track_->stairs().steps()[expansion] != 0.0;
    return track_->turn(expansion == turn_of(Turning::First) ? Turning::First : Turning::Second).angle > 0.0;
}

const std::vector<double>* ExpandedPair::find(std::size_t expansion) const {
    for (const Terms& terms : terms_)
        if (terms.expansion == expansion) return &terms.blocks;
    return nullptr;
}

// With r' the true and s the staircase's place, n' the turned and n the old normals, the expansion is
// K(s, n) + K(r, n') - K(r, n): its error is that of the series, plus K(s, n' - n) - K(r, n' - n), plus the product of both
// turns, plus K(r', n') - K(s, n'). All terms in units of 1/(pi r^2).
ExpandedPair::Bounds ExpandedPair::bounds(const ElementShape& rest_a, const ElementShape& rest_b,
                                          int order) const {
    const double r = least_distance_, s = glm::length(track_->stairs().position());
    if (!(s < r)) {
        constexpr double none = std::numeric_limits<double>::infinity();
        return {none, none};
    }
    std::array<double, axis_count> shares{};
    for (std::size_t a = 0; a < axis_count; ++a) shares[a] = std::abs(track_->stairs().steps()[a]) / r;
    const double nearer = r / (r - s);
    const auto displaced = [&](double way) { return nearer * nearer * series_tail(way / (r - s), 0); };
    const double series = staircase_tail(shares, s / r, order);

    const double turn_a = track_->turn(Turning::First).change_of_normals();
    const double turn_b = track_->turn(Turning::Second).change_of_normals();
    const double sweep = track_->sweep(Turning::First, rest_a) + track_->sweep(Turning::Second, rest_b);
    const double turned = turn_a + turn_b + turn_a * turn_b;
    return {series + displaced(track_->lag()),
            series + turned * series_tail(s / r, 0) + turn_a * turn_b + displaced(track_->lag() + sweep)};
}

bool ExpandedPair::holds(bool facing, const ElementShape& rest_a, const ElementShape& rest_b,
                         const ExpansionOptions& options) const {
    if (!track_) return false;
    if (track_->still()) return true;
    if (options.horizons == Horizons::Refresh && !(facing && facing_)) return false;
    if (!(least_distance_ > 0.0)) return false;
    const Bounds error = bounds(rest_a, rest_b, options.order);
    if (!std::isfinite(error.whole)) return false;
    if (options.rule == ExpansionRule::Certified)
        return error.translation <= options.translation_tolerance &&
               error.whole - error.translation <= options.rotation_quality;
    const auto condition =
        options.rule == ExpansionRule::Printed ? rotation_condition_printed : rotation_condition_scale_free;
    for (const Turning end : both_ends) {
        const double angle = track_->turn(end).angle;
        if (!(angle > 0.0)) continue;
        const double arm = track_->arm(end, end == Turning::First ? rest_a : rest_b);
        if (!condition(least_distance_, arm, angle, options.rotation_quality)) return false;
    }
    return series_condition(least_distance_, track_->stairs().length());
}

// The visible share, and the size of what bounds are relative to.
void ExpandedPair::measure(const PairNodes& nodes) {
    node_error_ = nodes.error();
    double square = 0.0;
    const auto block =
        nodes.project(1, [&](const SurfaceNode& x, const SurfaceNode& y, std::span<double> value) {
            const Vec3 r = y.position - x.position;
            const double unit = std::numbers::inv_pi / glm::dot(r, r);
            square += x.weight * y.weight * unit * unit;
            value[0] = facing_kernel(x, y);
        });
    size_ = std::sqrt(square);
    const double whole = block[0], slack = node_error_.kernel + reference_.error;
    if (clear_ || (!reference_.values.empty() && reference_.values[0] >= whole - slack))
        share_ = 1.0;
    else
        share_ = reference_.values.empty() ? 0.0 : std::clamp(reference_.values[0] / whole, 0.0, 1.0);
    measured_ = true;
}

void ExpandedPair::complete(const ElementShape& rest_a, const ElementShape& rest_b,
                            const ExpansionOptions& options, double tolerance) {
    std::vector<std::size_t> lacking;
    for (std::size_t expansion = 0; expansion < axis_count + both_ends.size(); ++expansion)
        if (needs(expansion) && find(expansion) == nullptr) lacking.push_back(expansion);
    if (measured_ && lacking.empty()) return;

    const Placed a(rest_a, track_->reference(Turning::First)), b(rest_b, track_->reference(Turning::Second));
    const PairNodes nodes(*a, *b, tolerance);
    if (!measured_) measure(nodes);
    for (const std::size_t expansion : lacking) {
        if (expansion < axis_count) {
            terms_.push_back(
                {expansion, translation_blocks(nodes, predefined_axes()[expansion], options.order)});
            continue;
        }
        const bool first = expansion == turn_of(Turning::First);
        terms_.push_back({expansion, rotation_blocks(nodes, first ? Turning::First : Turning::Second,
                                                     (first ? rest_a : rest_b).planar)});
    }
}

kernel::TransportBlock ExpandedPair::block(const ElementShape& rest_a, const ElementShape& rest_b,
                                           const ExpansionOptions& options, double tolerance) {
    if (track_->still()) return reference_;
    if (reference_.values.empty() && !clear_) return {};
    complete(rest_a, rest_b, options, tolerance);
    kernel::TransportBlock block{.values = reference_.values, .error = reference_.error};
    if (block.values.empty()) block.values.assign(rest_a.basis.size() * rest_b.basis.size(), 0.0);
    const Staircase& stairs = track_->stairs();
    for (std::size_t axis = 0; axis < axis_count; ++axis)
        if (needs(axis)) add_translation(*find(axis), stairs.steps()[axis], share_, block.values);
    double turned = 0.0;
    for (const Turning end : both_ends) {
        if (!needs(turn_of(end))) continue;
        const Turn& turn = track_->turn(end);
        add_rotation(*find(turn_of(end)), turn.R, normals_[end == Turning::First ? 0 : 1], share_,
                     block.values);
        turned += turn.change_of_normals();
    }
    const double walked = std::min(stairs.length() / least_distance_, 1.0);
    block.error += share_ * (size_ * bounds(rest_a, rest_b, options.order).whole +
                             node_error_.of_move(walked) + turned * node_error_.kernel);
    return block;
}

} // namespace kinelux::motion
