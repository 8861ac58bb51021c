// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "model/scene.h"
#include "model/solution.h"
#include "sample/sampler.h"
#include "visibility/occluders.h"

namespace kinelux::sample {

/// Indirect irradiance at points on surfaces or off them: the sum over all elements of what they reflect
/// (radiosity less exitance) times kernel and visibility, at their quadrature nodes; elements that are near a point
/// are cut until each piece is small beside its distance.
class Gather {
public:
    /// @param elements   all, in world position; they, the scene and the occluders must outlive this
    Gather(std::span<const geometry::ElementShape> elements, const model::Scene& scene,
           const model::UnknownLayout& layout, const model::FrameSolution& frame,
           const visibility::Occluders& occluders);

    /// @return  one value per channel, then the estimated error [W/m2 or lx]
    std::vector<double> indirect(const Receiver& receiver) const;

private:
    struct Rays;
    void add_nodes(std::size_t element, const geometry::NodeSet& set, const Receiver& receiver,
                   Rays& rays) const;
    void add_piece(std::size_t element, const geometry::Facet& piece, const Receiver& receiver, int cuts,
                   Rays& rays) const;
    void reflected(std::size_t element, std::span<const double> basis, std::span<double> values) const;

    std::span<const geometry::ElementShape> elements_;
    const model::Scene& scene_;
    const model::UnknownLayout& layout_;
    const model::FrameSolution& frame_;
    const visibility::Occluders& occluders_;
    std::vector<std::vector<double>> exitances_; ///< per material, at the frame's time
    std::size_t channels_;
};

} // namespace kinelux::sample
