// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "geometry/facet_surface.h"
#include "kernel/near_pair.h"
#include "visibility/loops.h"

namespace kinelux::kernel {

/// The inner integral over a curved patch by a tree of triangular cells of its parameters: a cell is divided until it is
/// small beside its distance from the point, or what it can add is below the accuracy; then it has a ready triangle rule.
/// Where the point's horizon or the surface's own crosses a small cell, the cell is cut along the straight line that
/// interpolates the clearance between its corners, which leaves an error of the fourth order in its size. Cheaper than
/// `curved_irradiance` by far, for cells and their nodes are kept from point to point.
class SurfaceCells : public PointGather {
public:
    /// Where the points lie: on a surface that meets the element's smoothly (its own) the kernel is bounded.
    enum class Points { Anywhere, OnTheSurface };

    /// @param element   with a surface; must outlive this
    /// @param accuracy  of the values, Euclidean norm [1/m]
    SurfaceCells(const geometry::ElementShape& element, double accuracy, Points points);
    void gather(const geometry::SurfaceNode& x, std::span<double> values) override;

private:
    static constexpr std::size_t rule_count = 3;
    struct Sample {
        Vec3 position, normal;
    };
    struct Cell {
        const geometry::Facet* facet;
        std::array<Vec2, 3> corners;   ///< local coordinates of the facet
        std::array<Sample, 7> samples; ///< corners, middles of the edges after them, centre
        Vec3 centre;                   ///< of a sphere around it
        double radius = 0.0;           ///< [m]
        double turn = 0.0;             ///< length of the largest difference of normals from the centre's [1]
        double area = 0.0;             ///< by its samples [m2]
        double roughness = 0.0;        ///< share of the area that its samples and a better rule disagree on
        int depth = 0;                 ///< of divisions
        std::uint32_t first_child = 0; ///< 0: not divided
        std::array<std::uint32_t, rule_count> first_node{}; ///< one past; 0: not made
    };
    /// Heights of the samples over the point's horizon, and of the point over theirs [m].
    struct Clearances {
        std::array<double, 7> here, there;
        double bend_here = 0.0,
               bend_there = 0.0; ///< how far they may rise above what is linear between samples
    };
    enum class View { None, Whole, Cut };
    /// What is known of a cell from a point.
    struct Look {
        View view = View::None;
        double distance = 0.0;  ///< of the centre [m]
        double most = 0.0;      ///< bound of the norm that the cell adds [1/m]
        double cut_error = 0.0; ///< of the straight cut [1/m]
        Clearances clearances;
    };

    std::uint32_t add_cell(const geometry::Facet& facet, const std::array<Vec2, 3>& corners, int depth);
    void divide(std::uint32_t index);
    Look look(const Cell& cell, const geometry::SurfaceNode& x) const;
    void look_closely(const Cell& cell, const geometry::SurfaceNode& x, Look& look) const;
    double bound(const Cell& cell, const geometry::SurfaceNode& x, const Look& look) const;
    void visit(std::uint32_t index, const geometry::SurfaceNode& x, std::span<double> values);
    std::size_t rule_for(const Cell& cell, const Look& look) const;
    void add_whole(Cell& cell, std::size_t rule, const geometry::SurfaceNode& x, std::span<double> values);
    void add_cut(const Cell& cell, const Look& look, std::size_t rule, const geometry::SurfaceNode& x,
                 std::span<double> values);
    void add_node(const geometry::SurfaceNode& x, const geometry::SurfaceNode& y, std::span<const double> phi,
                  std::span<double> values) const;
    void make_nodes(Cell& cell, std::size_t rule);
    geometry::SurfaceNode node_in(const Cell& cell, const std::array<Vec2, 3>& corners,
                                  const std::array<double, 3>& at, double weight, Vec2& parameter) const;

    const geometry::ElementShape& element_;
    double cell_accuracy_;  ///< [1/m]
    double function_scale_; ///< of the basis functions' norm at a point [1/m]
    Points points_;
    std::deque<Cell> cells_;
    std::uint32_t roots_ = 0;
    std::vector<geometry::SurfaceNode> nodes_;
    std::vector<double> basis_, phi_;
    visibility::LoopCutter<Vec2> cutter_;
};

} // namespace kinelux::kernel
