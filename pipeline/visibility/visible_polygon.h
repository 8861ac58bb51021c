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
    // A set of points in the target's plane, counted `weight` times.
    struct Region {
        std::uint32_t first_loop = 0, loop_count = 0; ///< of loops_
        int weight = 0;
        bool convex = false; ///< one convex loop
        Vec2 low{0.0}, high{0.0};
    };
    enum class Meeting : std::uint8_t { None, Part, WholeRegion, WholeOther };

    void look_at(const Vec3& x, const Loops3& target, const Vec3& normal);
    void make_cone();
    Vec3 seen(const Vec3& p) const;
    bool project(const Loops3& loops, double turn, Loops2& projected);
    void subtract(const PlanarBlocker& blocker);
    Meeting meet(std::size_t region, const PlanarBlocker& blocker, double turn);
    Meeting cut_other(std::size_t region);
    Meeting cut_region(std::size_t region, std::span<const Vec2> window);
    void add_region(std::uint32_t first_loop, int weight, bool convex);
    const Loops3& visible_loops();

    Vec3 x_{0.0}, axis_u_{0.0}, axis_v_{0.0}, normal_{0.0};
    double height_ = 0.0, reach_ = 0.0, target_area_ = 0.0;
    bool target_is_window_ = false;
    std::vector<Vec2> window_;
    std::vector<Vec3> cone_;
    Loops2 loops_, other_, piece_;
    bool other_convex_ = false;
    std::vector<Region> regions_;
    LoopCutter<Vec3> cutter_;
    LoopCutter<Vec2> flat_cutter_;
    std::vector<Vec3> seen_;
    Loops3 visible_;
};

} // namespace kinelux::visibility
