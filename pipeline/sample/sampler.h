// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "geometry/pose.h"
#include "model/scene.h"
#include "model/solution.h"
#include "model/surface_field.h"
#include "visibility/occluders.h"

namespace kinelux::sample {

struct DirectLightOptions {
    int probe_rays = 16;   ///< per receiver and source; all alike = done, 4..256
    int shadow_rays = 256; ///< per receiver and source in penumbra, >= probe_rays, up to 4096
    std::uint64_t seed = 1;
};

/// Where irradiance is wanted.
struct Receiver {
    Vec3 position; ///< [m], on a surface (world)
    Vec3 normal;   ///< unit, to the lit side
};

/// Irradiance straight from sources: the closed form of each source's polygons as seen from the receiver (clipped at
/// its horizon) times the visible share, by shadow rays to a scrambled Sobol set on the source.
/// @param sources   elements whose material emits, in world position
/// @param result    receivers x channels, channel fastest [W/m2 or lx]
class DirectLight {
public:
    DirectLight(std::span<const geometry::ElementShape> sources, const model::Scene& scene,
                const visibility::Occluders& occluders, const DirectLightOptions& options);
    /// @param stream  a number that belongs to the receiver, so that its samples do not depend on threads
    void irradiance(const Receiver& receiver, std::uint64_t stream, std::span<double> result) const;

private:
    struct Source {
        std::vector<const geometry::Facet*> facets;
        std::vector<double> cumulative_area;
        std::vector<double> exitance; ///< per channel
    };
    std::vector<Source> sources_;
    const visibility::Occluders& occluders_;
    DirectLightOptions options_;
    std::size_t channels_;
};

/// A display mesh of the elements.
/// @param cell_size  largest edge of a display triangle on patches [m]
model::DisplayMesh display_mesh(std::span<const geometry::ElementShape> elements, const model::PatchSet& patches,
                                const model::ClusterTree& tree, double cell_size);

/// The fields of one frame on a display mesh: radiosity, irradiance (direct + indirect), direct, indirect, ids.
model::SurfaceFields surface_fields(const model::DisplayMesh& mesh, std::span<const geometry::ElementShape> rest_elements,
                                    const model::Scene& scene, const model::UnknownLayout& layout,
                                    const model::FrameSolution& frame, std::span<const geometry::Pose> poses,
                                    const visibility::Occluders& occluders, const DirectLightOptions& options);

/// Area means and fluxes per object and channel, and the points of grid meters.
std::vector<model::MeterReading> meter_readings(std::span<const geometry::ElementShape> rest_elements,
                                                const model::Scene& scene, const model::UnknownLayout& layout,
                                                const model::FrameSolution& frame, std::span<const geometry::Pose> poses,
                                                const visibility::Occluders& occluders,
                                                const DirectLightOptions& options);

} // namespace kinelux::sample
