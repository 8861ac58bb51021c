// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/paper_engine.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "motion/pair_geometry.h"
#include "motion/posed_elements.h"
#include "motion/translation_series.h"
#include "visibility/pair_blockers.h"

namespace kinelux::motion {

namespace {

using geometry::ElementShape;
using model::ElementPair;
using visibility::Sight;

void require_range(const char* name, double value, double low, double high) {
    if (!(value >= low && value <= high))
        throw core::OptionError("option " + std::string(name) + " of the paper engine is " +
                                std::to_string(value) + "; it must be between " + std::to_string(low) +
                                " and " + std::to_string(high));
}

void append(const ElementPair& pair, const kernel::TransportBlock& block, FrameBlocks& result) {
    result.pairs.push_back(pair);
    result.rays += block.rays;
    if (block.values.empty()) return;
    result.blocks.entries.push_back(
        {pair.i, pair.j, result.blocks.values.size(), static_cast<float>(block.error)});
    for (const double value : block.values) result.blocks.values.push_back(static_cast<float>(value));
}

// Two sets of blocks of different pairs as one, in order.
FrameBlocks merged(const FrameBlocks& a, const FrameBlocks& b) {
    FrameBlocks result{.computed = a.computed + b.computed, .rays = a.rays + b.rays};
    std::merge(a.pairs.begin(), a.pairs.end(), b.pairs.begin(), b.pairs.end(),
               std::back_inserter(result.pairs));
    const auto take = [&](const FrameBlocks& from, std::size_t k) {
        const auto& entries = from.blocks.entries;
        model::BlockEntry entry = entries[k];
        const std::size_t end = k + 1 < entries.size() ? entries[k + 1].offset : from.blocks.values.size();
        const auto values = std::span(from.blocks.values).subspan(entry.offset, end - entry.offset);
        entry.offset = result.blocks.values.size();
        result.blocks.entries.push_back(entry);
        result.blocks.values.insert(result.blocks.values.end(), values.begin(), values.end());
    };
    const auto& ea = a.blocks.entries;
    const auto& eb = b.blocks.entries;
    std::size_t ka = 0, kb = 0;
    while (ka < ea.size() || kb < eb.size()) {
        const bool first = kb == eb.size() || (ka < ea.size() && ElementPair{ea[ka].i, ea[ka].j} <
                                                                     ElementPair{eb[kb].i, eb[kb].j});
        first ? take(a, ka++) : take(b, kb++);
    }
    return result;
}

} // namespace

PaperEngine::PaperEngine(const model::Coefficients& coefficients, std::span<const ElementShape> rest_elements,
                         const model::Plan& plan, visibility::Occluders& occluders,
                         const kernel::TransportOptions& options, PaperOptions paper)
    : coefficients_(coefficients),
      rest_(rest_elements),
      plan_(plan),
      occluders_(occluders),
      options_(options),
      paper_(std::move(paper)),
      bodies_(moving_bodies(rest_elements, plan)),
      pairs_(coefficients.moving_pairs.size()) {
    require_range("order", paper_.expansion.order, 1, most_orders);
    require_range("translation_tolerance", paper_.expansion.translation_tolerance, 0.0, 1.0);
    require_range("rotation_quality", paper_.expansion.rotation_quality, 0.0, 1.0);
    require_range("moves_per_frame", paper_.moves_per_frame, 1, 16);
    options_.occluders = plan.moving_occlusion ? visibility::Among::All : visibility::Among::Resting;
    crossed_.layout = coefficients.layout;
    std::copy_if(coefficients.crossed_pairs.begin(), coefficients.crossed_pairs.end(),
                 std::back_inserter(crossed_.crossed_pairs),
                 [&](const ElementPair& pair) { return shadows_exactly(pair); });
    crossed_engine_.emplace(crossed_, rest_elements, plan, occluders, options);
}

bool PaperEngine::shadows_exactly(const ElementPair& pair) const {
    if (paper_.occlusion == PaperOcclusion::Exact) return true;
    const auto emits = [&](std::uint32_t element) {
        return std::find(paper_.sources.begin(), paper_.sources.end(), rest_[element].material) !=
               paper_.sources.end();
    };
    return emits(pair.i) || emits(pair.j);
}

FrameBlocks PaperEngine::advance(double time_s, std::span<const geometry::Pose> poses) {
    FrameBlocks crossed = crossed_engine_->advance(time_s, poses); // moves the occluders
    counts_ = {};
    if (plan_.moving_objects.empty()) return crossed;
    const PosedElements elements(rest_, plan_, poses);
    const std::vector<TrackPointer> fresh = begin_frame(poses);
    std::vector<Slot> slots(pairs_.size());
    core::parallel_for(slots.size(), [&](std::size_t k) {
        const ElementPair& pair = coefficients_.moving_pairs[k];
        slots[k] = update(k, elements[pair.i], elements[pair.j], fresh[k]);
    });
    end_frame();

    FrameBlocks result;
    for (std::size_t k = 0; k < slots.size(); ++k) {
        append(coefficients_.moving_pairs[k], slots[k].block, result);
        counts_.refreshed += slots[k].origin == Origin::Refreshed ? 1 : 0;
        counts_.expanded += slots[k].origin == Origin::Expanded ? 1 : 0;
        counts_.dark += slots[k].origin == Origin::Dark ? 1 : 0;
        counts_.sets += slots[k].sets;
    }
    result.computed = counts_.refreshed;
    return merged(result, crossed);
}

// Moves all tracks to the frame's poses and begins one per pair of bodies here. @return  the new one of each moving pair
std::vector<PaperEngine::TrackPointer> PaperEngine::begin_frame(std::span<const geometry::Pose> poses) {
    for (const auto& track : tracks_) track->advance(poses, paper_.moves_per_frame);
    std::map<std::pair<ObjectId, ObjectId>, TrackPointer> by_bodies;
    std::vector<TrackPointer> fresh;
    fresh.reserve(pairs_.size());
    for (const ElementPair& pair : coefficients_.moving_pairs) {
        const std::pair bodies(rest_[pair.i].object, rest_[pair.j].object);
        TrackPointer& track = by_bodies[bodies];
        if (!track) {
            tracks_.push_back(std::make_shared<PairTrack>(bodies.first, bodies.second, bodies_, poses));
            track = tracks_.back();
        }
        fresh.push_back(track);
    }
    return fresh;
}

PaperEngine::Slot PaperEngine::update(std::size_t k, const ElementShape& a, const ElementShape& b,
                                      const TrackPointer& fresh) {
    if (!kernel::may_exchange(a, b)) return {};
    const ElementPair& ends = coefficients_.moving_pairs[k];
    const ElementShape& rest_a = rest_[ends.i];
    const ElementShape& rest_b = rest_[ends.j];
    ExpandedPair& pair = pairs_[k];
    const bool exact = shadows_exactly(ends);
    Sight sight = Sight::Clear;
    if (exact && options_.occlusion && !occluders_.empty()) {
        thread_local visibility::PairBlockers blockers;
        sight = blockers.between(visibility::shaft_end(a), visibility::shaft_end(b), occluders_.polygons(),
                                 options_.occluders, options_.most_blockers);
        if (sight == Sight::Hidden) return {};
    }
    const bool sees_as_before = !exact || (sight == Sight::Clear && pair.clear());
    if (sees_as_before && pair.holds(wholly_facing(a, b), rest_a, rest_b, paper_.expansion)) {
        const std::size_t before = pair.sets();
        kernel::TransportBlock block = pair.block(rest_a, rest_b, paper_.expansion, options_.tolerance);
        return {Origin::Expanded, std::move(block), pair.sets() - before};
    }
    kernel::TransportBlock block = kernel::transport(a, b, occluders_, options_);
    pair.reset(block, a, b, exact && sight == Sight::Clear, fresh);
    return {Origin::Refreshed, std::move(block), 0};
}

// Forgets the tracks that no pair refers to any more.
void PaperEngine::end_frame() {
    std::erase_if(tracks_, [](const auto& track) { return track.use_count() == 1; });
}

} // namespace kinelux::motion
