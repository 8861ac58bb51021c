// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.h"
#include "geometry/element_shape.h"
#include "kernel/transport.h"
#include "model/coefficients.h"
#include "model/plan.h"
#include "motion/engine.h"
#include "motion/exact_engine.h"
#include "motion/expanded_pair.h"
#include "visibility/occluders.h"

namespace kinelux::motion {

/// How the engine treats what stands between two elements.
enum class PaperOcclusion : std::uint8_t {
    /// As the publication, section 4.2: a moving pair keeps its visible share until its block is computed anew, and
    /// what movers do to pairs at rest is ignored; pairs with a source excepted, which are exact.
    Publication,
    Exact, ///< every pair: clear ones are expanded, hidden ones zero, all others computed anew in each frame
};

struct PaperOptions {
    ExpansionOptions expansion;
    int moves_per_frame = 1; ///< of each staircase, 1..16; the publication makes one
    PaperOcclusion occlusion = PaperOcclusion::Publication;
    std::vector<MaterialId> sources; ///< materials that emit; what Publication treats apart
};

/// How the blocks of the last frame were had.
struct PaperCounts {
    std::uint64_t refreshed = 0; ///< computed anew, of moving pairs
    std::uint64_t expanded = 0;  ///< from coefficients, or kept where nothing moved
    std::uint64_t dark = 0;      ///< zero without computing: turned away, or wholly hidden
    std::uint64_t sets = 0;      ///< sets of coefficients computed, one per pair and axis or turning body
};

/// The publication's method: where bodies move relative to each other, blocks are expanded from the time they were last
/// computed, as a power series along predefined axes for translations, linearly in the normals for rotations, and
/// computed anew when a condition fails (docs/paper-engine.md). Frames must come in the order of their time for
/// staircases to mean what they should; any order gives valid blocks. The same bytes at any thread count.
/// @cite Biri, Michelin, Arquès, Dynamic Radiosity using Higher Order Functions Bases and Temporal Coherence,
/// Journal of WSCG 11, 2003
class PaperEngine : public Engine {
public:
    /// All arguments but the last two must outlive the engine. @param occluders  is moved to each frame's poses
    /// @throws OptionError  an option out of its range
    PaperEngine(const model::Coefficients& coefficients,
                std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan,
                visibility::Occluders& occluders, const kernel::TransportOptions& options,
                PaperOptions paper);

    PaperEngine(const PaperEngine&) = delete;
    PaperEngine& operator=(const PaperEngine&) = delete;

    /// Errors of expanded blocks hold for what stood between at the reference: with PaperOcclusion::Publication the
    /// cost of a share of visibility that has changed since is not in them.
    FrameBlocks advance(double time_s, std::span<const geometry::Pose> poses) override;

    const PaperCounts& counts() const { return counts_; } ///< of the last frame

private:
    enum class Origin : std::uint8_t { Refreshed, Expanded, Dark };
    struct Slot {
        Origin origin = Origin::Dark;
        kernel::TransportBlock block;
        std::uint64_t sets = 0;
    };
    using TrackPointer = std::shared_ptr<const PairTrack>;

    bool shadows_exactly(const model::ElementPair& pair) const;
    std::vector<TrackPointer> begin_frame(std::span<const geometry::Pose> poses);
    Slot update(std::size_t pair, const geometry::ElementShape& a, const geometry::ElementShape& b,
                const TrackPointer& fresh);
    void end_frame();

    const model::Coefficients& coefficients_;
    std::span<const geometry::ElementShape> rest_;
    const model::Plan& plan_;
    visibility::Occluders& occluders_;
    kernel::TransportOptions options_;
    PaperOptions paper_;
    model::Coefficients crossed_;               ///< only pairs at rest whose shadows by movers count
    std::optional<ExactEngine> crossed_engine_; ///< for those
    std::vector<MovingBody> bodies_;
    std::vector<ExpandedPair> pairs_;                ///< one per moving pair
    std::vector<std::shared_ptr<PairTrack>> tracks_; ///< that some pair still refers to
    PaperCounts counts_;
};

} // namespace kinelux::motion
