// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/vec.h"
#include "geometry/element_shape.h"

namespace kinelux::visibility {

/// The points x with dot(normal, x) >= offset.
struct HalfSpace {
    Vec3 normal{0.0}; ///< unit, into it
    double offset = 0.0;

    double distance(const Vec3& x) const { return glm::dot(normal, x) - offset; } ///< [m], > 0 inside
};

/// One end of a shaft: a convex polygon with a front, or a box around anything else. Made once per element.
struct ShaftEnd {
    static constexpr std::size_t most_points = 12; ///< of a polygon; one with more is replaced by a rectangle

    std::array<Vec3, most_points> points; ///< counter-clockwise seen from the front [m]
    std::size_t count = 0;                ///< of `points`; 0 = a box
    Vec3 normal{0.0};                     ///< of the polygon, unit, to the front
    Vec3 box_low{0.0}, box_high{0.0};     ///< axis-aligned bounds [m]

    bool planar() const { return count > 0; }
};

/// The convex hull of points in one plane; quick where they are a convex outline, counter-clockwise from the front.
/// @param normal  unit, of the plane, to the front
ShaftEnd shaft_end(std::span<const Vec3> points, const Vec3& normal);
/// A box, exchanging light through all its sides.
ShaftEnd shaft_end(const Vec3& low, const Vec3& high);
/// An element: the hull of its outline where it is planar, else its box.
ShaftEnd shaft_end(const geometry::ElementShape& element);

/// How far two ends are apart at least, by planes between them: of their own, across the line between their middles, of
/// the axes. 0 where none of these parts them. [m]
double separation(const ShaftEnd& a, const ShaftEnd& b);

/// Where the segments between two elements run that leave one in front and arrive at the other in front: an
/// intersection of half spaces. Exact for two convex polygons, a superset where a box is involved. What only touches it
/// is outside: neighbours that share an edge with an element, or lie in its plane, hide nothing.
/// @cite Haines, Wallace, Shaft culling for efficient ray-cast radiosity, Eurographics Workshop on Rendering 1991
class Shaft {
public:
    Shaft(const ShaftEnd& a, const ShaftEnd& b);

    /// Neither end has a point in front of the other: nothing can be between.
    bool empty() const { return count_a_ == 0; }
    /// Whether a box is outside. May say no of one that is, never yes of one that is not.
    bool misses(const Vec3& low, const Vec3& high) const;
    /// The same of a polygon, by its points and its plane.
    bool misses(std::span<const Vec3> points, const HalfSpace& plane) const;

    std::span<const HalfSpace> half_spaces() const { return std::span(half_spaces_).first(count_); }
    /// Corners of the ends' parts in front of each other.
    std::span<const Vec3> points_a() const { return std::span(points_a_).first(count_a_); }
    std::span<const Vec3> points_b() const { return std::span(points_b_).first(count_b_); }
    double size() const { return size_; }      ///< diagonal of its box [m]
    double touching() const { return touch_; } ///< what reaches less deep into it only touches [m]

private:
    static constexpr std::size_t most_end_points = ShaftEnd::most_points + 1; // a cut adds one

    void take_front_parts(const ShaftEnd& a, const ShaftEnd& b);
    void measure();
    void add_tangents(std::span<const Vec3> polygon, std::span<const Vec3> other);
    void add_box_tangents(const ShaftEnd& a, const ShaftEnd& b);
    void add_if_bounding(const HalfSpace& half_space);

    std::array<HalfSpace, 2 * most_end_points + 2> half_spaces_;
    std::array<Vec3, most_end_points> points_a_, points_b_;
    std::size_t count_ = 0, count_a_ = 0, count_b_ = 0;
    Vec3 low_{0.0}, high_{0.0};
    double size_ = 0.0, touch_ = 0.0;
};

} // namespace kinelux::visibility
