// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/vec.h"
#include "geometry/element_shape.h"

namespace kinelux::sample {

/// A flat piece of a source: facets in one plane, and the outline of their union.
struct LightPanel {
    struct Edge {
        Vec3 from, to;
    };
    std::vector<Edge> outline; ///< edges of one facet only; inside is on the left seen from the front
    std::vector<std::array<Vec3, 3>> facets;
    std::vector<double> cumulative_area; ///< of the facets [m2]
    Vec3 normal{0.0};                    ///< unit
    Vec3 centre{0.0};                    ///< of the area [m]
    double radius = 0.0;                 ///< no corner is farther from the centre [m]

    double area() const { return cumulative_area.back(); }
    /// The point at the image of the unit square under a map that preserves area.
    Vec3 point(const Vec2& square) const;
};

/// Panels of the facets of some elements: those in one plane with an equal normal are one panel.
std::vector<LightPanel> light_panels(std::span<const geometry::ElementShape* const> elements);

/// Configuration factor of a small flat piece to a panel, unoccluded [1]: exact, but the one-point rule where the
/// panel is seen under less than 0.05 rad. 0 where the point lies in the panel's plane.
double point_to_panel(const Vec3& x, const Vec3& normal, const LightPanel& panel);

} // namespace kinelux::sample
