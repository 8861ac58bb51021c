// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/online_engine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace kinelux::motion {

namespace {

constexpr std::uint64_t longest_shaded = 8; ///< frames from one integration to the next where V may vary
constexpr std::uint64_t longest_unsure = 3; ///< the same where it may vary by more than a glimpse tells
constexpr std::uint64_t longest_clear = 16; ///< the same where nothing stands between
constexpr double better_than_asked =
    3.0;                       ///< most blocks in most frames; with 3 the light is off by half the tolerance
constexpr double safety = 2.0; ///< of a measured error, for what it grows to until the next measurement
constexpr double memory_of_error = 0.3; ///< a larger error measured before still counts by this much
constexpr double bends =
    0.25; ///< of the change per frame: what an edge of a shadow or a horizon may take with it
constexpr double nothing = 0.3; ///< of the tolerance: blocks below it may be continued as they like

double frobenius(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

} // namespace

OnlineEngine::OnlineEngine(const model::Coefficients& coefficients,
                           std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan,
                           visibility::Occluders& occluders, const kernel::TransportOptions& options,
                           Importance importance, double tolerance, Watched watched)
    : rest_(rest_elements),
      changing_(coefficients, rest_elements, plan, occluders, options, watched),
      tracks_(rest_elements, plan),
      importance_(std::move(importance)),
      tolerance_(tolerance),
      memories_(changing_.pairs().size()) {}

// Whether the newest block still is what would be integrated.
bool OnlineEngine::unmoved(std::size_t k, const Memory& memory) const {
    if (memory.known == 0) return false;
    const auto [i, j] = changing_.pairs()[k];
    if (memory.change == Change::Shaded) return tracks_.any_moved_at() <= memory.frame;
    return tracks_.moved_at(rest_[i].object) <= memory.frame &&
           tracks_.moved_at(rest_[j].object) <= memory.frame;
}

std::vector<double> OnlineEngine::continued(const Memory& memory, double time_s, std::size_t size) const {
    std::vector<double> values(size, 0.0);
    for (std::size_t n = 0; n < memory.known; ++n) {
        double weight = 1.0;
        for (std::size_t m = 0; m < memory.known; ++m)
            if (m != n) weight *= (time_s - memory.times_s[m]) / (memory.times_s[n] - memory.times_s[m]);
        for (std::size_t v = 0; v < size; ++v)
            values[v] += weight * static_cast<double>(memory.values[n * size + v]);
    }
    return values;
}

// The remainder of the quadratic grows with the product of the differences of times.
double OnlineEngine::expected_error(const Memory& memory, double time_s) const {
    double product = memory.third;
    for (const double known : memory.times_s) product *= time_s - known;
    return safety * product;
}

// Whether a few segments see no more of what came or went than the block that is continued.
bool OnlineEngine::foretold(std::size_t k, const Memory& memory, double constant, double allowed) const {
    const double change = constant - static_cast<double>(memory.values[0]);
    return std::abs(changing_.glimpse(k).visible - memory.glimpse.visible - change) <= allowed;
}

void OnlineEngine::integrate(std::size_t k, double time_s, Memory& memory, Slot& slot) {
    const auto [i, j] = changing_.pairs()[k];
    const std::size_t size = rest_[i].basis.size() * rest_[j].basis.size();
    kernel::TransportBlock block = changing_.block(k, memory.change);
    slot.integrated = true;
    slot.rays = block.rays;
    slot.error = block.error;
    block.values.resize(size, 0.0);
    if (memory.known == most_known) {
        std::vector<double> off = continued(memory, time_s, size);
        for (std::size_t v = 0; v < size; ++v) off[v] -= block.values[v];
        double product = 1.0;
        for (const double known : memory.times_s) product *= time_s - known;
        const double third = frobenius(off) / product;
        memory.third = memory.measured ? std::max(third, memory_of_error * memory.third) : third;
        memory.measured = true;
    }
    if (memory.known > 0) {
        double change = 0.0;
        for (std::size_t v = 0; v < size; ++v) {
            const double difference = block.values[v] - static_cast<double>(memory.values[v]);
            change += difference * difference;
        }
        memory.rate = std::max(memory.rate, std::sqrt(change) / static_cast<double>(frame_ - memory.frame));
    }
    memory.gap = memory.known > 0 ? frame_ - memory.frame : 1;
    memory.values.resize(std::min<std::size_t>(memory.known + 1u, most_known) * size);
    std::copy_backward(memory.values.begin(), memory.values.end() - static_cast<std::ptrdiff_t>(size),
                       memory.values.end());
    for (std::size_t v = 0; v < size; ++v) memory.values[v] = static_cast<float>(block.values[v]);
    memory.times_s = {time_s, memory.times_s[0], memory.times_s[1]};
    memory.known = static_cast<std::uint8_t>(std::min<std::size_t>(memory.known + 1u, most_known));
    memory.frame = frame_;
    memory.error = std::max(static_cast<float>(block.error), memory.known > 1 ? memory.error : 0.0f);
    memory.norm = frobenius(block.values);
    memory.glimpse = memory.change == Change::Shaded ? changing_.glimpse(k) : Glimpse{};
    slot.values = std::move(block.values);
}

OnlineEngine::Slot OnlineEngine::look(std::size_t k, double time_s, const ErrorBudget& budget) {
    const auto [i, j] = changing_.pairs()[k];
    Memory& memory = memories_[k];
    const Change change = changing_.change(k, tracks_.step(rest_[i].object) + tracks_.step(rest_[j].object));
    Slot slot{.change = change};
    const std::size_t size = rest_[i].basis.size() * rest_[j].basis.size();
    if (change == memory.change && unmoved(k, memory)) {
        slot.values.assign(memory.values.begin(), memory.values.begin() + static_cast<std::ptrdiff_t>(size));
        slot.error = static_cast<double>(memory.error);
        return slot;
    }
    const bool off = change == Change::Shaded
                         ? tracks_.any_jumped()
                         : tracks_.jumped(rest_[i].object) || tracks_.jumped(rest_[j].object);
    if (change != memory.change || off) memory = {.change = change};
    if (change == Change::None || change == Change::Zero) return slot;

    const double allowed = budget.of(i, j);
    // A glimpse resolves no less than what a few of its segments see.
    constexpr double resolved = 2.0 / Glimpse::segments;
    const std::uint64_t longest_here = change != Change::Shaded                     ? longest_clear
                                       : resolved * memory.glimpse.whole <= allowed ? longest_shaded
                                                                                    : longest_unsure;
    const std::uint64_t longest = std::min(longest_here, 2 * memory.gap + 1);
    const std::uint64_t since = frame_ - memory.frame;
    if (memory.known > 1 && since < longest && change != Change::Near) {
        const double drift = memory.rate * static_cast<double>(since);
        // The edge of a shadow may come after any number of frames in which nothing changed.
        const double bend = change == Change::Clear ? 0.0 : bends * drift;
        const double expected = std::max(expected_error(memory, time_s), bend);
        if (memory.norm + 2.0 * drift <= nothing * allowed) {
            slot.values.assign(memory.values.begin(),
                               memory.values.begin() + static_cast<std::ptrdiff_t>(size));
            slot.error = static_cast<double>(memory.error) + nothing * allowed;
        } else if (memory.measured && expected <= allowed) {
            slot.values = continued(memory, time_s, size);
            slot.error = static_cast<double>(memory.error) + expected;
        }
        if (!slot.values.empty() &&
            (change != Change::Shaded || foretold(k, memory, slot.values[0], allowed)))
            return slot;
    }
    integrate(k, time_s, memory, slot);
    return slot;
}

FrameBlocks OnlineEngine::advance(double time_s, std::span<const geometry::Pose> poses) {
    if (frame_ > 0 && !(time_s > time_s_)) {
        tracks_.forget();
        for (Memory& memory : memories_) memory = {};
    }
    ++frame_;
    time_s_ = time_s;
    tracks_.follow(frame_, time_s, poses);
    changing_.set_poses(poses);
    const ErrorBudget budget(importance_, tolerance_, changing_before_, better_than_asked);
    std::vector<Slot> slots(memories_.size());
    core::parallel_for(slots.size(), [&](std::size_t k) { slots[k] = look(k, time_s, budget); });

    FrameBlocks result;
    changing_before_ = 0;
    for (std::size_t k = 0; k < slots.size(); ++k) {
        const Slot& slot = slots[k];
        if (slot.change == Change::None || slot.change == Change::Zero) continue;
        const auto [i, j] = changing_.pairs()[k];
        ++changing_before_;
        result.pairs.push_back({i, j});
        result.computed += slot.integrated ? 1 : 0;
        result.rays += slot.rays;
        if (std::all_of(slot.values.begin(), slot.values.end(), [](double v) { return v == 0.0; })) continue;
        result.blocks.entries.push_back({i, j, result.blocks.values.size(), static_cast<float>(slot.error)});
        for (const double value : slot.values) result.blocks.values.push_back(static_cast<float>(value));
    }
    return result;
}

std::size_t OnlineEngine::bytes() const {
    std::size_t sum = memories_.capacity() * sizeof(Memory);
    for (const Memory& memory : memories_) sum += memory.values.capacity() * sizeof(float);
    return sum;
}

} // namespace kinelux::motion
