// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coefficients/coefficients.h"
#include "model/cluster_tree.h"
#include "model/patch_set.h"

namespace kinelux::coefficients {

/// The elements that form factors need: planar patches whole; pieces of curved patches and clusters as they are.
model::ClusterTree whole_patch_elements(const model::PatchSet& patches, const model::ClusterTree& tree);

/// Form factors between groups of elements of degree 0, straight from pairs: by the double contour integral where both
/// are planar and nothing stands between, else by kernel::transport. Parallel; the result does not depend on threads.
/// @param elements  in place, in order of ElementId
/// @param group_of  one group number per element
std::vector<FormFactor> whole_patch_factors(std::span<const geometry::ElementShape> elements,
                                            const visibility::Occluders& occluders,
                                            const kernel::TransportOptions& options,
                                            std::span<const std::uint32_t> group_of, std::uint32_t groups);

} // namespace kinelux::coefficients
