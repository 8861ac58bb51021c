// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "kernel/near_pair.h"
#include "kernel/polygon_moments.h"
#include "visibility/loops.h"

namespace kinelux::kernel {

/// The inner integral over flat facets that need not lie in one plane: per facet its centre or three nodes where what
/// that leaves out is below the accuracy, else the closed form over the part above the point's horizon.
class FacetSum : public PointGather {
public:
    /// @param element   without a surface; must outlive this
    /// @param accuracy  of the values, Euclidean norm [1/m]
    FacetSum(const geometry::ElementShape& element, double accuracy);
    void gather(const geometry::SurfaceNode& x, std::span<double> values) override;

private:
    struct Ball {
        Vec3 centre;   ///< of the corners
        double radius; ///< [m]
        Vec2 parameter;
    };

    void add_node(const geometry::SurfaceNode& x, const geometry::SurfaceNode& y, const Vec2& parameter,
                  std::span<double> values);
    void add_exact(std::size_t facet, const geometry::SurfaceNode& x, std::span<double> values);

    const geometry::ElementShape& element_;
    double facet_accuracy_; ///< [1/m]
    double function_scale_; ///< of the basis functions' norm at a point [1/m]
    std::vector<Ball> balls_;
    std::vector<PolygonMoments> moments_; ///< where the basis is not constant
    std::vector<double> phi_, part_;
    visibility::LoopCutter<Vec3> cutter_;
    visibility::Loops3 loops_;
    visibility::Loops2 flat_;
};

/// The outer integral over triangles for elements of many small facets: the centre alone where a facet is small beside
/// its distance from the inner element, else rules of low degree whose differences say where they are divided.
/// @param inner   what `gather` integrates over
OuterResult integrate_facets(const geometry::ElementShape& outer, std::span<const OuterPiece> pieces,
                             const geometry::ElementShape& inner, PointGather& gather,
                             const OuterOptions& options);

} // namespace kinelux::kernel
