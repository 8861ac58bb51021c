// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "visibility/loops.h"
#include "visibility/shaft.h"

namespace kinelux::visibility {

/// A planar polygon that stands between.
struct PlanarBlocker {
    Loops3 loops;       ///< counter-clockwise seen from its front, holes clockwise [m]
    Loops3 pieces;      ///< convex polygons without overlap that make it up; empty where it is convex
    HalfSpace plane;    ///< normal to the front
    bool convex = true; ///< one convex loop
    bool fine = false;  ///< one triangle of a curved or finely divided surface
};

/// Whether one blocker hides all of one end of a shaft from all of the other: its plane parts them, and it fills the
/// shaft's section with that plane but for 1e-9 of its area.
bool covers_all(const PlanarBlocker& blocker, const Shaft& shaft);

/// The part of a planar polygon that is visible from a point. Keeps its memory: one object per thread, used again.
class VisiblePolygon {
public:
    /// @param x         [m]; where it is not in front of the target nothing is visible
    /// @param target    loops in one plane, counter-clockwise seen from the front, holes clockwise [m]
    /// @param normal    unit, of the target, to its front
    /// @param blockers  planar polygons anywhere; what is behind x or behind the target hides nothing, nor does a blocker
    ///                  whose plane holds x
    /// @return  loops around what is visible, orientated like the target: their winding numbers sum to 1 there and to 0
    ///          elsewhere, so that areas and contour integrals add up; they may share edges that cancel. `target` itself
    ///          where nothing hides it, no loop where all but 1e-12 of its area is hidden. Valid until the next call.
    const Loops3& from(const Vec3& x, const Loops3& target, const Vec3& normal,
                       std::span<const PlanarBlocker> blockers);

private:
    // A line in the target's plane; normal unit, to its inner side.
    struct Line {
        Vec2 normal{0.0};
        double offset = 0.0;
        double distance(const Vec2& p) const { return glm::dot(normal, p) + offset; }
    };
    struct Range {
        std::uint32_t first = 0, count = 0;
    };
    // A set of points in the target's plane, counted `weight` times.
    struct Region {
        Range loops;
        int weight = 0;
        Range windows; ///< of members_: the convex blockers whose section it is; none: not known to be convex
    };
    enum class Meeting : std::uint8_t { None, Part, WholeRegion, WholeOther };

    void look_at(const Vec3& x, const Loops3& target, const Vec3& normal);
    void make_cone(const Vec2& low, const Vec2& high);
    Vec3 seen(const Vec3& p) const;
    bool project(const Loops3& loops, double turn);
    void subtract(const PlanarBlocker& blocker);
    void add_lines(std::span<const Vec3> seen_loop, double turn, const Vec3& plane_normal);
    Meeting meet(const Region& region, const PlanarBlocker& blocker, double turn);
    Meeting cut_other(const Region& region);
    Meeting cut_region(const Region& region, Range lines);
    bool holds(Range lines, const Region& region) const;
    void keep_within(Range lines);
    void add_region(std::uint32_t first_loop, int weight, Range windows);
    void add_section(std::uint32_t first_loop, const Region& region);
    const Loops3& visible_loops();

    Vec3 x_{0.0}, axis_u_{0.0}, axis_v_{0.0}, normal_{0.0};
    double height_ = 0.0, reach_ = 0.0, target_area_ = 0.0;
    bool target_is_window_ = false;
    std::vector<Vec3> cone_, seen_;
    Loops2 loops_; ///< of all regions
    std::vector<Region> regions_;
    std::vector<Line> lines_;
    std::vector<Range> members_; ///< of lines_
    Loops2 other_;               ///< the blocker at hand, projected
    Range other_lines_;          ///< none: not convex
    LoopCutter<Vec3> cutter_;
    LoopCutter<Vec2> flat_cutter_;
    Loops3 visible_;
};

} // namespace kinelux::visibility
