// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/element_shape.h"
#include "kernel/transport.h"
#include "motion/pair_nodes.h"
#include "motion/pair_track.h"

namespace kinelux::motion {

/// When an expansion is given up and the block computed anew.
enum class ExpansionRule : std::uint8_t {
    Printed,   ///< (14) and (20) of the publication, with its lengths in metres
    ScaleFree, ///< (14), and (20) as it is without a unit of length
    Certified, ///< proven bounds of the error: of the translation, and of what turns add to it
};

/// What becomes of a pair of which a part is behind the other's horizon. The series know no clamps, and the publication
/// does not mention them.
enum class Horizons : std::uint8_t {
    Refresh, ///< computed anew in every frame
    Kept, ///< points that faced each other at the reference are expanded, the others stay dark; errors do not hold this
};

struct ExpansionOptions {
    int order = 6; ///< of the translation series, 1..16; the publication's choice
    ExpansionRule rule = ExpansionRule::Printed;
    Horizons horizons = Horizons::Refresh;
    double translation_tolerance = 1e-2; ///< Certified: of the kernel in units of 1/(pi r^2) [1], >= 0
    double rotation_quality = 0.1; ///< S of (20); Certified: as translation_tolerance, of turns [1], >= 0
};

/// What one pair of elements keeps from the time its block was last computed, its reference, and the expansion from there.
class ExpandedPair {
public:
    /// Starts anew from a block: all errors of expansions are erased, all coefficients dropped.
    /// @param a, b   in world position at the reference
    /// @param clear  nothing stands between; else the visible share is what the block has of one that sees everything
    /// @param track  must advance with the bodies from here
    void reset(kernel::TransportBlock block, const geometry::ElementShape& a, const geometry::ElementShape& b,
               bool clear, std::shared_ptr<const PairTrack> track);

    /// Whether the expansion may be used where the track now stands. @param facing  both elements now wholly face each
    /// other; @param rest_a, rest_b  at rest
    bool holds(bool facing, const geometry::ElementShape& rest_a, const geometry::ElementShape& rest_b,
               const ExpansionOptions& options) const;

    /// The block where the track now stands. Computes what coefficients it lacks, once per axis and turning body.
    /// @param tolerance  of the nodes' rules, relative to the block [1]
    /// @return  error: that of the reference, plus the bound of the expansion over the pair, plus the nodes'; not what a
    ///          visible share that has changed since may cost
    kernel::TransportBlock block(const geometry::ElementShape& rest_a, const geometry::ElementShape& rest_b,
                                 const ExpansionOptions& options, double tolerance);

    bool clear() const { return clear_; }
    /// Sets of coefficients computed since the reference.
    std::size_t sets() const { return terms_.size(); }

private:
    struct Bounds {
        double translation; ///< of the staircase's series and its distance from the path
        double whole;       ///< with turns, and what is missing between turns and translation
    };
    Bounds bounds(const geometry::ElementShape& rest_a, const geometry::ElementShape& rest_b,
                  int order) const;
    /// Coefficients of one expansion: an axis by its number, then the turn of the first and of the second body.
    struct Terms {
        std::size_t expansion;
        std::vector<double> blocks;
    };
    static constexpr std::size_t turn_of(Turning end) { return axis_count + (end == Turning::First ? 0 : 1); }
    /// Whether the motion since the reference calls for an expansion.
    bool needs(std::size_t expansion) const;
    const std::vector<double>* find(std::size_t expansion) const;
    void complete(const geometry::ElementShape& rest_a, const geometry::ElementShape& rest_b,
                  const ExpansionOptions& options, double tolerance);
    void measure(const PairNodes& nodes);

    kernel::TransportBlock reference_;
    std::shared_ptr<const PairTrack> track_;
    bool facing_ = false, clear_ = false, measured_ = false;
    double least_distance_ = 0.0; ///< at the reference [m]
    double share_ = 0.0;          ///< visible at the reference, 0..1
    double size_ = 0.0;           ///< Frobenius norm that a kernel of 1/(pi r^2) would have at most [1]
    NodeError node_error_;
    std::array<Vec3, 2> normals_{}; ///< mean normals at the reference
    std::vector<Terms> terms_;      ///< those computed, in the order in which they were first needed
};

} // namespace kinelux::motion
