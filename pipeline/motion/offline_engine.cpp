// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/offline_engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"

namespace kinelux::motion {

namespace {

// With 3 the light of motion_bench's rooms is off by a third to a ninth of the tolerance.
constexpr double better_than_asked = 5.0;

const model::BlockEntry* entry_of(const model::BlockSet& blocks, const model::ElementPair& pair) {
    const auto found = std::lower_bound(blocks.entries.begin(), blocks.entries.end(), pair,
                                        [](const model::BlockEntry& entry, const model::ElementPair& p) {
                                            return model::ElementPair{entry.i, entry.j} < p;
                                        });
    return found != blocks.entries.end() && found->i == pair.i && found->j == pair.j ? &*found : nullptr;
}

bool has_block(Change change) { return change != Change::None && change != Change::Zero; }

} // namespace

// A block on its way into FrameBlocks.
struct OfflineEngine::Slot {
    bool changed = false;
    bool integrated = false;
    double error = 0.0;
    std::vector<double> values;
};

OfflineEngine::OfflineEngine(const model::Coefficients& coefficients,
                             std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan,
                             visibility::Occluders& occluders, const kernel::TransportOptions& options,
                             const PosePath& path, const Importance& importance, double tolerance)
    : coefficients_(coefficients), times_s_(path.times_s), visits_(rest_elements.size()) {
    if (path.times_s.empty() || path.times_s.size() != path.poses.size())
        throw core::OptionError("the path of an animation needs frames, each with a time and poses");
    ChangingPairs changing(coefficients, rest_elements, plan, occluders, options);
    if (changing.pairs().empty()) return;
    BodyTracks tracks(rest_elements, plan);
    find_runs(changing, tracks, path, rest_elements);
    const ErrorBudget budget(importance, tolerance, most_at_once_, better_than_asked);
    while (std::any_of(paths_.begin(), paths_.end(), [](const BlockPath& p) { return !p.finished(); })) {
        integrate(changing, path);
        core::parallel_for(paths_.size(), [&](std::size_t p) {
            if (!paths_[p].finished()) paths_[p].judge(budget.of(elements_[p].i, elements_[p].j));
        });
    }
    core::parallel_for(paths_.size(), [&](std::size_t p) { paths_[p].compact(); });
    for (const BlockPath& one : paths_) prepared_ += one.integrated();
    visits_ = {};
}

// Norm of the static block, which nothing that comes between makes larger; infinite where there is none.
double OfflineEngine::bound_of(const model::ElementPair& pair, std::size_t size) const {
    const model::BlockEntry* entry = entry_of(coefficients_.static_blocks, pair);
    if (entry == nullptr) return INFINITY;
    double square = 0.0;
    for (std::size_t v = 0; v < size; ++v) {
        const auto value = static_cast<double>(coefficients_.static_blocks.values[entry->offset + v]);
        square += value * value;
    }
    return std::sqrt(square);
}

// Frame by frame what is known of all pairs without integrating: runs of frames through which that stays the same and
// bodies go smoothly. Where one leaves its path between two frames, the run is parted at both.
void OfflineEngine::find_runs(ChangingPairs& changing, BodyTracks& tracks, const PosePath& path,
                              std::span<const geometry::ElementShape> rest) {
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    const std::span<const model::ElementPair> pairs = changing.pairs();
    std::vector<std::uint32_t> path_of(pairs.size(), none), since(pairs.size(), 0);
    std::vector<Change> before(pairs.size(), Change::None), now(pairs.size(), Change::None);
    std::vector<std::pair<std::size_t, BlockPath>> found;
    const auto close = [&](std::size_t k, std::uint32_t last) {
        if (path_of[k] == none) {
            const std::size_t size = rest[pairs[k].i].basis.size() * rest[pairs[k].j].basis.size();
            path_of[k] = static_cast<std::uint32_t>(found.size());
            found.emplace_back(k, BlockPath(size, bound_of(pairs[k], size)));
        }
        found[path_of[k]].second.add_run(before[k], since[k], last);
    };
    const auto off_path = [&](std::size_t k) {
        return now[k] == Change::Shaded
                   ? tracks.any_jumped()
                   : tracks.jumped(rest[pairs[k].i].object) || tracks.jumped(rest[pairs[k].j].object);
    };
    const auto frames = static_cast<std::uint32_t>(path.poses.size());
    for (std::uint32_t frame = 0; frame <= frames; ++frame) {
        if (frame < frames) {
            tracks.follow(frame + 1, path.times_s[frame], path.poses[frame]);
            changing.set_poses(path.poses[frame]);
            core::parallel_for(pairs.size(), [&](std::size_t k) {
                now[k] = changing.change(k, tracks.step(rest[pairs[k].i].object) +
                                                tracks.step(rest[pairs[k].j].object));
            });
        } else {
            std::fill(now.begin(), now.end(), Change::None);
        }
        std::size_t at_once = 0;
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            at_once += has_block(now[k]) ? 1 : 0;
            if (now[k] != before[k]) {
                if (has_block(before[k])) close(k, frame - 1);
                before[k] = now[k];
                since[k] = frame;
            } else if (has_block(now[k]) && off_path(k)) {
                close(k, frame - 1);
                since[k] = frame - 1;
                close(k, frame);
                since[k] = frame;
            }
        }
        most_at_once_ = std::max(most_at_once_, at_once);
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto& [k, one] : found) {
        pairs_.push_back(k);
        elements_.push_back(pairs[k]);
        paths_.push_back(std::move(one));
    }
}

// All blocks that the paths ask for now, frame by frame.
void OfflineEngine::integrate(ChangingPairs& changing, const PosePath& path) {
    std::vector<std::vector<std::uint32_t>> tasks(path.poses.size());
    std::vector<std::vector<BlockPath::Request>> requests(paths_.size());
    core::parallel_for(paths_.size(), [&](std::size_t p) { requests[p] = paths_[p].requests(); });
    for (std::size_t p = 0; p < paths_.size(); ++p)
        for (const BlockPath::Request& request : requests[p])
            tasks[request.frame].push_back(static_cast<std::uint32_t>(p));
    for (std::uint32_t frame = 0; frame < tasks.size(); ++frame)
        if (!tasks[frame].empty()) {
            std::fill(visits_.begin(), visits_.end(), std::uint8_t{0});
            for (const std::uint32_t p : tasks[frame]) visits_[elements_[p].i] = visits_[elements_[p].j] = 1;
            changing.set_poses(path.poses[frame], visits_);
            core::parallel_for(tasks[frame].size(), [&](std::size_t t) {
                const std::uint32_t p = tasks[frame][t];
                const auto request = std::lower_bound(
                    requests[p].begin(), requests[p].end(), frame,
                    [](const BlockPath::Request& r, std::uint32_t f) { return r.frame < f; });
                paths_[p].set(frame, changing.block(pairs_[p], request->change));
            });
        }
}

// In frames from the first; between frames by time.
double OfflineEngine::position_of(double time_s) const {
    const auto after = std::upper_bound(times_s_.begin(), times_s_.end(), time_s);
    if (after == times_s_.begin()) return 0.0;
    const auto frame = static_cast<std::size_t>(after - times_s_.begin()) - 1;
    if (after == times_s_.end()) return static_cast<double>(frame);
    return static_cast<double>(frame) + (time_s - times_s_[frame]) / (times_s_[frame + 1] - times_s_[frame]);
}

void OfflineEngine::add_static(const model::ElementPair& pair, double weight, Slot& slot) const {
    const auto* entry = entry_of(coefficients_.static_blocks, pair);
    if (entry == nullptr) return;
    for (std::size_t v = 0; v < slot.values.size(); ++v)
        slot.values[v] += weight * static_cast<double>(coefficients_.static_blocks.values[entry->offset + v]);
    slot.error += weight * static_cast<double>(entry->error);
}

OfflineEngine::Slot OfflineEngine::slot_at(std::size_t path, double position) const {
    const BlockPath& one = paths_[path];
    const auto below = static_cast<std::uint32_t>(std::floor(position));
    const auto above = static_cast<std::uint32_t>(std::ceil(position));
    Slot slot;
    if (one.covers(below, above)) {
        slot.values.resize(one.size());
        const BlockPath::Value value = one.at(position, slot.values);
        return {true, value.integrated, value.error, std::move(slot.values)};
    }
    // Between two frames of which at most one has a block of its own the block is a mixture of both.
    if (!one.covers(below, below) && !one.covers(above, above)) return slot;
    slot.changed = true;
    slot.values.assign(one.size(), 0.0);
    std::vector<double> own(one.size());
    for (const std::uint32_t frame : {below, above}) {
        const double weight = frame == below ? above - position : position - below;
        if (!one.covers(frame, frame)) {
            add_static(elements_[path], weight, slot);
            continue;
        }
        slot.error += weight * one.at(frame, own).error;
        for (std::size_t v = 0; v < own.size(); ++v) slot.values[v] += weight * own[v];
    }
    return slot;
}

FrameBlocks OfflineEngine::advance(double time_s, std::span<const geometry::Pose> /*poses*/) {
    const double position = position_of(time_s);
    std::vector<Slot> slots(paths_.size());
    core::parallel_for(paths_.size(), [&](std::size_t p) { slots[p] = slot_at(p, position); });
    FrameBlocks result;
    for (std::size_t p = 0; p < slots.size(); ++p) {
        if (!slots[p].changed) continue;
        result.pairs.push_back(elements_[p]);
        result.computed += slots[p].integrated ? 1 : 0;
        if (std::all_of(slots[p].values.begin(), slots[p].values.end(), [](double v) { return v == 0.0; }))
            continue;
        result.blocks.entries.push_back({elements_[p].i, elements_[p].j, result.blocks.values.size(),
                                         static_cast<float>(slots[p].error)});
        for (const double value : slots[p].values) result.blocks.values.push_back(static_cast<float>(value));
    }
    return result;
}

std::size_t OfflineEngine::bytes() const {
    std::size_t sum =
        pairs_.capacity() * sizeof(std::size_t) + elements_.capacity() * sizeof(model::ElementPair);
    for (const BlockPath& one : paths_) sum += one.bytes();
    return sum;
}

} // namespace kinelux::motion
