// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coefficients/element_tree.h"
#include "coefficients/light_estimate.h"
#include "kernel/transport.h"
#include "model/coefficients.h"
#include "visibility/occluders.h"

namespace kinelux::coefficients {

/// A ball that no link may reach across, for a moving body enters it.
struct Ball {
    Vec3 centre{0.0}; ///< [m]
    double radius = 0.0;
};

struct LinkOptions {
    double tolerance =
        5e-3; ///< relative L2 error of irradiance that all links together may be expected to add [1]
    std::span<const Ball> movers; ///< pairs that a mover may come between stay element pairs
    bool refine_light = true;     ///< by the first links: where all light comes from elements of the tree
};

/// Transport divided between links and pairs of elements.
struct LinkedPairs {
    model::BlockSet links;                ///< between nodes of the tree
    std::vector<model::ElementPair> near; ///< all other pairs that may exchange light, sorted
    double error_estimate = 0.0;          ///< relative L2 error of irradiance [1]
    double rays = 0.0;
};

/// Refines the pair (root, root) until the expected error is within tolerance: always the links with the largest errors
/// are divided, round by round with a falling limit. A link's block is a product of both nodes' rules with a ray per
/// pair of rule nodes; its error is estimated from what the kernel at these nodes keeps outside the bases of both nodes
/// (Bessel's inequality), from the number of rays, and from the distance, and weighted with the radiosity that the tree
/// estimates (docs/hierarchy.md). Pairs of touching groups are divided down to elements. Pairs that normal cones prove
/// to face away are in neither list. Deterministic.
/// @param tree     of two elements or more
/// @param light    even light; refined by the first links unless a body that moves emits
/// @param options  occlusion and occluders as for blocks
LinkedPairs link_groups(const ElementTree& tree, std::span<const geometry::ElementShape> elements,
                        const LightEstimate& light, const visibility::Occluders& occluders,
                        const kernel::TransportOptions& options, const LinkOptions& link_options);

} // namespace kinelux::coefficients
