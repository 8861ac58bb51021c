// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "geometry/element_shape.h"
#include "visibility/polygon_blockers.h"

namespace kinelux::coefficients {

/// What a few operations can be certain of about a pair of elements at rest.
enum class Screened : std::uint8_t {
    Apart,    ///< they face away from each other, or lie in one plane: no exchange
    Clear,    ///< nothing stands between
    Hidden,   ///< one polygon hides all of one from all of the other
    Undecided ///< the kernel has to look
};

/// Sorts pairs before any shaft, rule or ray is made for them. Per element it holds a bound, its plane, and for every
/// resting polygon on which side of it the element lies and whether any of the polygon is in front of the element: a
/// polygon can only be between two elements if it is in front of both and has not both on one side. Of the few
/// polygons left, convex ones are compared edge by edge with where segments between the elements cross their planes,
/// which are the convex hulls of the crossings of segments between corners.
class PairScreen {
public:
    /// @param elements  at rest; must outlive the screen
    /// @param polygons  what may stand between; must outlive the screen; null: nothing does
    PairScreen(std::span<const geometry::ElementShape> elements, const visibility::PolygonBlockers* polygons);

    /// Whether kernel::may_exchange holds, by bounds first.
    bool may_exchange(std::size_t i, std::size_t j) const;
    Screened look(std::size_t i, std::size_t j) const;

private:
    struct Bound {
        Vec3 normal;   ///< unit, of a planar element; else zero
        double offset; ///< of its plane [m]
        Vec3 centre;   ///< of the bounding sphere [m]
        double radius; ///< [m]
        std::uint32_t
            plane; ///< number shared by neighbours in the list that lie in one plane, facing one way
        bool planar;
    };
    /// A line that bounds a convex polygon, by a plane through it perpendicular to the polygon's.
    struct Border {
        Vec3 inwards; ///< unit
        double offset;
    };
    struct Sieve {
        visibility::HalfSpace plane;
        std::uint32_t first_border = 0, border_count = 0; ///< none: not convex, never decided
    };
    enum class Cover : std::uint8_t { None, All, Unknown };

    void number_planes();
    void add_polygons(const visibility::PolygonBlockers& polygons);
    void set_masks(std::size_t element, const visibility::PolygonBlockers& polygons);
    Screened look_through(std::size_t i, std::size_t j) const;
    Cover cover(const Sieve& polygon, std::size_t i, std::size_t j) const;
    Cover cover_by_corners(const Sieve& polygon, std::size_t i, std::size_t j) const;

    std::span<const geometry::ElementShape> elements_;
    std::vector<Bound> bounds_;
    std::vector<Sieve> sieves_;
    std::vector<Border> borders_;
    std::size_t words_ = 0; ///< of a mask: a bit per polygon
    /// Per element: polygons that have no point of it behind them, none before them, and a point in front of it.
    std::vector<std::uint64_t> before_, behind_, in_front_;
    bool screens_ = true; ///< false where there are too many polygons to hold a bit of each
};

} // namespace kinelux::coefficients
