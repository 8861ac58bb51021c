// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "fit/charts.h"
#include "fit/faces.h"

namespace kinelux::fit {

struct CurvedOptions {
    double scene_extent = 0.0;    ///< longest edge of the scene's bounds [m]
    double small_area = 0.0;      ///< a chart below this is small whatever its shape [m2]
    double negligible_area = 0.0; ///< a chart below this carries no patch even if it stands alone [m2]
};

/// Which charts of a body are facets of curved surfaces, or specks, and stay small triangles. A chart is a facet if a
/// good part of its boundary continues smoothly into charts of other planes, it is small against the scene, and it is
/// not much wider than those neighbours (the flat side of a rounded box is no facet).
/// @param widths  of the charts: the shorter side of their bounds [m]
/// @return one per chart, 1 = small triangles
std::vector<std::uint8_t> curved_charts(const Body& body, const std::vector<Chart>& charts,
                                        const std::vector<double>& widths, const CurvedOptions& options);

} // namespace kinelux::fit
