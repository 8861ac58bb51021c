// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "geometry/pose.h"
#include "model/scene.h"
#include "model/solution.h"
#include "model/surface_field.h"
#include "sample/light_panels.h"
#include "visibility/occluders.h"

namespace kinelux::sample {

struct DirectLightOptions {
    int probe_rays = 16;  ///< per receiver and source, besides its corners; all alike = done, 4..256
    int shadow_rays = 64; ///< per receiver and source in penumbra, >= probe_rays, up to 4096
    std::uint64_t seed = 1;
};

/// Options for a scene's accuracy: as many shadow rays that their sampling stays below the target in penumbra.
DirectLightOptions direct_light_options_for(const model::Scene& scene);

/// How much of a source is seen from a receiver.
enum class Seen : std::uint8_t { Nothing, Partly, Whole };

/// Where irradiance is wanted.
struct Receiver {
    Vec3 position;                       ///< [m], on a surface (world)
    Vec3 normal;                         ///< unit, to the lit side
    std::optional<Vec3> ray_origin = {}; ///< where shadow rays start instead [m], beside the position
};

/// Irradiance straight from sources: the closed form of each source's polygons as seen from the receiver (clipped at
/// its horizon) times the visible share, by shadow rays to a scrambled Sobol set on the source.
class DirectLight {
public:
    /// @param sources    elements in world position; those whose material emits are the sources, one per object and
    ///                   material
    /// @param time_s     at which the sources are as bright as the scene's dimmings say [s]
    /// @param occluders  must outlive this, in the same pose
    DirectLight(std::span<const geometry::ElementShape> sources, const model::Scene& scene, double time_s,
                const visibility::Occluders& occluders, const DirectLightOptions& options);
    /// @param stream  a number that belongs to the receiver, so that its samples do not depend on threads
    /// @param result  one value per channel is set [W/m2 or lx]
    /// @param seen    one per source is set, if not empty
    void irradiance(const Receiver& receiver, std::uint64_t stream, std::span<double> result,
                    std::span<Seen> seen = {}) const;
    /// The same without rays, where it is known of every source that the whole or nothing of it is seen.
    void irradiance_unshadowed(const Receiver& receiver, std::span<const Seen> seen,
                               std::span<double> result) const;
    std::size_t source_count() const { return sources_.size(); }

private:
    struct Source {
        std::vector<LightPanel> panels;
        std::vector<double> exitance; ///< per channel
    };
    double visible_share(const Receiver& receiver, const Source& source,
                         std::span<const double> cumulative_factors, std::uint64_t seed) const;

    std::vector<Source> sources_;
    const visibility::Occluders& occluders_;
    DirectLightOptions options_;
};

/// A display mesh of the elements. Conforming inside each patch: cut along the lines of its element grid and finer ones.
/// @param elements   of all elements of the tree, at rest
/// @param cell_size  largest edge of a display triangle [m]
model::DisplayMesh display_mesh(std::span<const geometry::ElementShape> elements,
                                const model::PatchSet& patches, const model::ClusterTree& tree,
                                double cell_size);

/// Where indirect light at displayed points comes from.
enum class IndirectLight : std::uint8_t {
    Solution, ///< the polynomials of the solve
    Gathered  ///< one more reflection at every point: all elements times kernel and visibility
};

/// Evaluates the fields of any frame on a display mesh. What does not change with time is computed once: where each
/// point lies in the elements around it, and where its shadow rays start.
class SurfaceSampler {
public:
    /// @param clearance  least height of a receiver over its own bent surface [m]: Occluders::end_offset()
    SurfaceSampler(const model::DisplayMesh& mesh, std::span<const geometry::ElementShape> rest_elements,
                   const model::Scene& scene, double clearance);

    /// Radiosity, irradiance (direct + indirect), direct, indirect at points; the error estimate in cells.
    model::SurfaceFields fields(const model::UnknownLayout& layout, const model::FrameSolution& frame,
                                std::span<const geometry::Pose> poses, const visibility::Occluders& occluders,
                                const DirectLightOptions& options,
                                IndirectLight from = IndirectLight::Solution) const;

private:
    /// The share of one element in the value at a point.
    struct Contribution {
        ElementId element;
        std::size_t first_value; ///< of basis_values_
    };
    using Incidence = std::vector<std::vector<std::uint32_t>>; ///< triangles around each point
    std::vector<Contribution> locate(std::size_t point, const std::vector<std::uint32_t>& around);
    void share_between_neighbours(const std::vector<std::vector<Contribution>>& own);
    /// @param value  one per channel is set [W/m2 or lx]
    void indirect(std::size_t point, const model::UnknownLayout& layout, std::span<const double> coefficients,
                  std::span<double> value) const;

    const model::DisplayMesh& mesh_;
    std::span<const geometry::ElementShape> elements_;
    const model::Scene& scene_;
    std::vector<Receiver> receivers_;               ///< one per point, at rest
    std::vector<MaterialId> materials_;             ///< one per point
    std::vector<std::uint32_t> first_contribution_; ///< points + 1
    std::vector<Contribution> contributions_;
    std::vector<double> basis_values_;
};

/// The fields of one frame; SurfaceSampler is faster for many. @param poses  one per object
model::SurfaceFields surface_fields(const model::DisplayMesh& mesh,
                                    std::span<const geometry::ElementShape> rest_elements,
                                    const model::Scene& scene, const model::UnknownLayout& layout,
                                    const model::FrameSolution& frame, std::span<const geometry::Pose> poses,
                                    const visibility::Occluders& occluders,
                                    const DirectLightOptions& options);

/// Readings of one frame; grids that follow a motion are read where they are then. Per object and channel: "radiosity" and "irradiance" (area means), "flux" (leaving), and
/// "emitted flux". Per grid meter and channel: "irradiance" of each point (meter "name[column,row]") and of the grid
/// "mean irradiance", "least irradiance", "greatest irradiance".
std::vector<model::MeterReading> meter_readings(std::span<const geometry::ElementShape> rest_elements,
                                                const model::Scene& scene, const model::UnknownLayout& layout,
                                                const model::FrameSolution& frame,
                                                std::span<const geometry::Pose> poses,
                                                const visibility::Occluders& occluders,
                                                const DirectLightOptions& options);

} // namespace kinelux::sample
