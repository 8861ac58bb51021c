// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "fit/faces.h"
#include "fit/plane_fit.h"

namespace kinelux::fit {

/// Connected faces of one body, material and sidedness that lie in one plane within the tolerances.
struct Chart {
    std::size_t body = 0;
    std::vector<std::uint32_t> faces; ///< into Body::faces, ascending
    MaterialId material;
    bool two_sided = false;
    Plane plane;                ///< normal to the front
    double area = 0.0;          ///< of the faces [m2]
    double deviation_max = 0.0; ///< of the faces' corners from the plane [m]
    double deviation_rms = 0.0; ///< [m]
};

struct ChartOptions {
    double distance_tolerance = 0.0;   ///< of a corner from the plane [m]
    double normal_tolerance_deg = 0.0; ///< of a face's normal from the plane's [deg]
    double thin_height = 0.0;          ///< a face lower than this has no normal worth testing [m]
    double exact_distance = 0.0;       ///< a first plane this near to all corners is kept as it is [m]
};

/// Divides a body's faces into charts by region growing: the largest face left is the seed, its plane is refitted to
/// what has grown. Every face is in exactly one chart.
std::vector<Chart> grow_charts(const Body& body, std::size_t body_index, const ChartOptions& options);

} // namespace kinelux::fit
