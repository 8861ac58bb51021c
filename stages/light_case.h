// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/stage.h"
#include "coefficients/coefficients.h"
#include "geometry/element_shape.h"
#include "io/case_folder.h"
#include "kernel/transport.h"
#include "model/cluster_tree.h"
#include "model/coefficients.h"
#include "model/patch_set.h"
#include "model/plan.h"
#include "model/scene.h"
#include "visibility/occluders.h"

namespace kinelux::stages {

/// What every stage from coefficients on works with, read from a case.
struct LightCase {
    model::Scene scene;
    model::PatchSet patches;
    model::ClusterTree tree;
    model::Plan plan;
    std::vector<geometry::ElementShape> elements; ///< at rest
    visibility::Occluders occluders;

    kernel::TransportOptions transport_options(std::uint64_t seed) const;
    std::vector<double> areas() const; ///< one per element [m2]
};
LightCase read_light_case(const io::CaseFolder& folder);

/// Frames of a scene that an option (nothing: all) asks for. @throws OptionError  the scene has none of them
std::vector<std::uint32_t> frames_of(const model::Scene& scene, const std::optional<cli::FrameRange>& range);

/// Groups of elements that form factors are taken between: the scene's objects, or its patches and clusters.
struct Groups {
    std::vector<std::string> names;
    std::vector<std::uint32_t> group_of; ///< one per element
};
enum class GroupBy : std::uint8_t { Object, Patch };
Groups groups_of(const model::Scene& scene, const model::PatchSet& patches, const model::ClusterTree& tree,
                 GroupBy by);
Groups groups_of(const LightCase& light, GroupBy by);

/// Sum of the form factors from each group, as they are; 1 in a closed scene.
std::vector<double> row_sums(std::span<const coefficients::FormFactor> factors, std::size_t groups);

/// The blocks of all pairs at the time of a frame: coefficients whose static blocks are those of that frame.
model::Coefficients coefficients_at(model::Coefficients coefficients, LightCase& light, std::uint32_t frame,
                                    std::uint64_t seed);

} // namespace kinelux::stages
