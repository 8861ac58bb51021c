// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fit/faces.h"
#include "model/surface.h"

namespace kinelux::fit {

/// Connected faces of one body, material and sidedness whose corners lie on one cylinder, cone, sphere or torus.
struct RoundChart {
    std::size_t body = 0;
    std::vector<std::uint32_t> faces; ///< into Body::faces, ascending
    MaterialId material;
    bool two_sided = false;
    model::Surface surface;     ///< oriented as the faces are
    double area = 0.0;          ///< of the faces [m2]
    double deviation_max = 0.0; ///< of the faces' corners from the surface [m]
    double deviation_rms = 0.0; ///< [m]
    double chord_max = 0.0;     ///< of the faces' centroids from the surface [m]
};

struct RoundOptions {
    double distance_tolerance = 0.0; ///< of a corner from the surface [m]
    double face_turn_deg = 0.0;      ///< from face to face over an edge [deg]
    double least_area = 0.0;         ///< of the faces of a chart [m2]
};

/// Gathers faces into round charts by region growing. Faces that continue each other smoothly are tried as one surface;
/// where they are not, surfaces grow from pieces of them, the simplest of those that take most.
/// @param candidates  one per face of the body, 1 = may be taken
std::vector<RoundChart> grow_round_charts(const Body& body, std::size_t body_index,
                                          std::span<const std::uint8_t> candidates,
                                          const RoundOptions& options);

} // namespace kinelux::fit
