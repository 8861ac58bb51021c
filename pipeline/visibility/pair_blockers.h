// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "visibility/loops.h"
#include "visibility/polygon_blockers.h"
#include "visibility/shaft.h"
#include "visibility/visible_polygon.h"

namespace kinelux::visibility {

/// How much stands between two elements.
enum class Sight : std::uint8_t {
    Clear,  ///< nothing: every segment between them is free
    Hidden, ///< one polygon hides all of one from all of the other
    Few,    ///< the polygons listed, and no others, may hide a part
    Many    ///< more than were asked for
};

/// The polygons that stand between two elements. Keeps its memory: one object per thread, used again.
class PairBlockers {
public:
    /// Exact for convex planar elements; Clear and Hidden hold for others too, which are taken as their boxes.
    /// @param a, b   ends of the pair, made once per element
    /// @param among  which bodies count
    /// @param most   polygons to list; with more the pair is Many, unless a single one hides all
    Sight between(const ShaftEnd& a, const ShaftEnd& b, const PolygonBlockers& polygons, Among among,
                  std::size_t most);

    /// Whether a polygon of a body that counts reaches into the shaft of a pair; the same test as for Clear, ended by the
    /// first one found.
    /// @param counts  one per body, 0 = looked through; bodies beyond its end count
    bool any_between(const ShaftEnd& a, const ShaftEnd& b, const PolygonBlockers& polygons, Among among,
                     std::span<const std::uint8_t> counts = {});

    /// Of the last pair: the polygons between when Few, ordered with convex ones first; the first ones found when Many.
    std::span<const PlanarBlocker> blockers() const { return std::span(blockers_).first(count_); }

private:
    bool take(std::uint32_t polygon, const PolygonBlockers& polygons, const Shaft& shaft);
    bool cut_by_shaft(const PlanarBlocker& blocker, const Shaft& shaft);
    void add_pieces(std::uint32_t polygon, const PolygonBlockers& polygons, const Shaft& shaft);

    std::vector<PlanarBlocker> blockers_;
    std::size_t count_ = 0;
    Loops3 cut_;
    LoopCutter<Vec3> cutter_;
};

} // namespace kinelux::visibility
