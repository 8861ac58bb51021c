// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/vec.h"
#include "geometry/pose.h"
#include "visibility/loops.h"
#include "visibility/occluders.h"
#include "visibility/shaft.h"

namespace kinelux::visibility {

/// A planar polygon that can come between two elements; its loops are PolygonBlockers::loops_of.
struct PolygonBlocker {
    HalfSpace plane;                  ///< normal to the front
    double area = 0.0;                ///< [m2]
    Vec3 box_low{0.0}, box_high{0.0}; ///< axis-aligned bounds [m]
    std::uint32_t body = 0;
    bool convex = true; ///< one convex loop
    bool fine = false;  ///< one triangle of a curved or finely divided surface
    std::uint32_t first_loop = 0, loop_count = 0;
    std::uint32_t first_piece = 0, piece_count = 0;
};

/// All surfaces of a scene that can hide one element from another, as planar polygons: one per outline of a body, one per
/// triangle that no outline holds. Back-to-back copies are one polygon. Resting and moving bodies apart, each in a tree of
/// boxes that shafts are asked against. Polygons are numbered, resting ones first, by body and outline.
class PolygonBlockers {
public:
    /// @throws GeometryError  an outline names points or triangles out of range (carries its body)
    explicit PolygonBlockers(std::span<const Body> bodies);

    /// Moves the bodies. @param poses  one per body; those of resting bodies are ignored. Not while queries run.
    void set_poses(std::span<const geometry::Pose> poses);

    std::size_t size() const { return resting_.polygons.size() + moving_.polygons.size(); }
    std::size_t resting() const { return resting_.polygons.size(); } ///< of size(), the first ones
    const PolygonBlocker& operator[](std::uint32_t polygon) const;
    std::span<const Vec3> loop_of(std::uint32_t polygon, std::size_t loop) const; ///< outer ones first
    /// Convex polygons without overlap that make up one that is not convex itself; none for a convex one.
    std::span<const Vec3> piece_of(std::uint32_t polygon, std::size_t piece) const;

    /// What is called with every polygon found; returns the area [m2] that further ones must have, infinity to stop.
    using Visitor = std::function<double(std::uint32_t)>;
    /// Visits the polygons that a shaft does not miss, in an order that depends on the scene alone.
    void visit(const Shaft& shaft, Among among, const Visitor& visitor) const;
    /// Their numbers. @param most  the search ends when more than this many are found
    void find(const Shaft& shaft, Among among, std::size_t most, std::vector<std::uint32_t>& found) const;

private:
    struct Node {
        Vec3 low{0.0}, high{0.0};
        double largest_area = 0.0; ///< of the polygons below [m2]
        std::uint32_t first =
            0; ///< of a leaf: into `order`; else the second child, the first is the next node
        std::uint32_t count = 0; ///< of a leaf: its polygons; 0 = not a leaf
    };
    struct Set {
        std::vector<PolygonBlocker> polygons;
        Loops3 loops, pieces;
        std::vector<Node> nodes;
        std::vector<std::uint32_t> order; ///< polygons by leaf

        void add_body(const Body& body, std::uint32_t index);
        void add_outline(const Body& body, std::uint32_t index, const Outline& outline);
        void add_triangle(const Body& body, std::uint32_t index, const model::Triangle& triangle);
        bool finish_polygon(PolygonBlocker polygon);
        void keep_one_of_each_sheet();
        void build_tree();
        std::uint32_t build_node(std::size_t first, std::size_t last);
        std::size_t split(std::size_t first, std::size_t last);
        void measure(PolygonBlocker& polygon) const;
        void measure(Node& node, std::uint32_t index) const;
        bool visit(const Shaft& shaft, std::uint32_t number_offset, double& least_area,
                   const Visitor& visitor) const;
        std::span<const Vec3> points_of(const PolygonBlocker& polygon) const;
    };
    const Set& set_of(std::uint32_t& polygon) const;

    Set resting_, moving_;
    std::vector<Vec3> rest_points_, rest_pieces_; ///< of moving_ at rest
    std::vector<HalfSpace> rest_planes_;
    std::size_t bodies_ = 0;
};

} // namespace kinelux::visibility
