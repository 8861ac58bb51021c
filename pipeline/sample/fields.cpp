// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "core/sequence.h"
#include "geometry/facet_surface.h"
#include "sample/gather.h"
#include "sample/receivers.h"
#include "sample/sampler.h"

namespace kinelux::sample {

namespace {

constexpr double same_place = 1e-6;        ///< of the mesh's extent
constexpr double same_direction = 0.985;   ///< 10 degrees
constexpr std::size_t points_at_once = 64; ///< of one task

// What an element's basis is evaluated at, at a point on it.
Vec2 parameter_at(const geometry::ElementShape& element, const Vec3& x) {
    if (!element.surface) return geometry::facet_parameter(facet_at(element, x), x);
    double nearest = std::numeric_limits<double>::infinity();
    Vec2 parameter{0.0};
    for (const geometry::Facet& facet : element.facets) {
        const geometry::FacetSurface surface(element, facet);
        const auto at = surface.at(surface.nearest(x));
        const double distance = glm::distance(at.position, x);
        if (distance >= nearest) continue;
        nearest = distance;
        parameter = at.parameter;
    }
    return parameter;
}

struct Cell {
    std::int64_t x, y, z;
    bool operator==(const Cell&) const = default;
};
struct CellHash {
    std::size_t operator()(const Cell& c) const {
        return core::mix(core::mix(static_cast<std::uint64_t>(c.x), static_cast<std::uint64_t>(c.y)),
                         static_cast<std::uint64_t>(c.z));
    }
};

Cell cell_of(const Vec3& x, const Vec3& origin, double size) {
    const Vec3 c = glm::floor((x - origin) / size);
    return {static_cast<std::int64_t>(c.x), static_cast<std::int64_t>(c.y), static_cast<std::int64_t>(c.z)};
}

// For each point the points of the same object at the same place that face the same way, itself included.
std::vector<std::vector<std::uint32_t>> neighbours_of(const model::DisplayMesh& mesh) {
    Vec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const Vec3& x : mesh.points) {
        low = glm::min(low, x);
        high = glm::max(high, x);
    }
    const double tolerance =
        std::max(same_place * glm::length(high - low), std::numeric_limits<double>::min());
    const double size = 4.0 * tolerance;
    std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells;
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p)
        cells[cell_of(mesh.points[p], low, size)].push_back(p);

    std::vector<std::vector<std::uint32_t>> result(mesh.points.size());
    core::parallel_for(mesh.points.size(), [&](std::size_t p) {
        const Vec3& x = mesh.points[p];
        const Cell from = cell_of(x - tolerance, low, size), to = cell_of(x + tolerance, low, size);
        for (Cell c = from; c.x <= to.x; ++c.x)
            for (c.y = from.y; c.y <= to.y; ++c.y)
                for (c.z = from.z; c.z <= to.z; ++c.z)
                    if (const auto found = cells.find(c); found != cells.end())
                        for (const std::uint32_t q : found->second)
                            if (mesh.point_objects[p] == mesh.point_objects[q] &&
                                glm::distance(x, mesh.points[q]) <= tolerance &&
                                glm::dot(mesh.normals[p], mesh.normals[q]) > same_direction)
                                result[p].push_back(q);
        std::sort(result[p].begin(), result[p].end());
    });
    return result;
}

model::NamedArray array_of(std::string name, const model::Scene& scene, std::size_t points) {
    model::NamedArray array;
    array.name = std::move(name);
    array.components = static_cast<std::uint32_t>(scene.channels.size());
    array.component_names = scene.channels;
    array.values.resize(points * scene.channels.size());
    return array;
}

model::NamedArray error_array(const model::DisplayMesh& mesh, const model::FrameSolution& frame,
                              const std::string& unit) {
    model::NamedArray array;
    array.name = "ErrorEstimate_" + unit;
    array.values.reserve(mesh.elements.size());
    for (const ElementId element : mesh.elements) array.values.push_back(frame.element_error[element.value]);
    return array;
}

} // namespace

SurfaceSampler::SurfaceSampler(const model::DisplayMesh& mesh,
                               std::span<const geometry::ElementShape> rest_elements,
                               const model::Scene& scene, double clearance)
    : mesh_(mesh), elements_(rest_elements), scene_(scene) {
    Incidence around(mesh.points.size());
    materials_.resize(mesh.points.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (const std::uint32_t corner : mesh.triangles[t]) {
            around[corner].push_back(t);
            materials_[corner] = mesh.materials[t];
        }
    receivers_.resize(mesh.points.size());
    core::parallel_for(mesh.points.size(), [&](std::size_t p) {
        receivers_[p] =
            receiver_on(mesh, rest_elements, mesh.points[p], mesh.normals[p], around[p], clearance);
    });
    std::vector<std::vector<Contribution>> own;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) own.push_back(locate(p, around[p]));
    share_between_neighbours(own);
}

// The elements around a point, each with the values of its basis there.
std::vector<SurfaceSampler::Contribution> SurfaceSampler::locate(std::size_t point,
                                                                 const std::vector<std::uint32_t>& around) {
    std::vector<Contribution> result;
    for (const std::uint32_t t : around) {
        const ElementId id = mesh_.elements[t];
        if (std::any_of(result.begin(), result.end(), [&](const Contribution& c) { return c.element == id; }))
            continue;
        const geometry::ElementShape& element = elements_[id.value];
        const Vec3& x = mesh_.points[point];
        result.push_back({id, basis_values_.size()});
        basis_values_.resize(basis_values_.size() + element.basis.size());
        element.basis.evaluate(parameter_at(element, x),
                               std::span(basis_values_).subspan(result.back().first_value));
    }
    return result;
}

void SurfaceSampler::share_between_neighbours(const std::vector<std::vector<Contribution>>& own) {
    const std::vector<std::vector<std::uint32_t>> neighbours = neighbours_of(mesh_);
    first_contribution_ = {0};
    for (std::size_t p = 0; p < own.size(); ++p) {
        for (const std::uint32_t q : neighbours[p])
            contributions_.insert(contributions_.end(), own[q].begin(), own[q].end());
        first_contribution_.push_back(static_cast<std::uint32_t>(contributions_.size()));
    }
}

void SurfaceSampler::indirect(std::size_t point, const model::UnknownLayout& layout,
                              std::span<const double> coefficients, std::span<double> value) const {
    std::fill(value.begin(), value.end(), 0.0);
    const std::uint32_t first = first_contribution_[point], last = first_contribution_[point + 1];
    for (std::uint32_t i = first; i < last; ++i) {
        const Contribution& contribution = contributions_[i];
        const std::size_t offset = layout.offsets[contribution.element.value];
        for (std::size_t k = 0; k < layout.count(contribution.element.value); ++k)
            for (std::size_t c = 0; c < value.size(); ++c)
                value[c] += basis_values_[contribution.first_value + k] *
                            coefficients[(offset + k) * value.size() + c];
    }
    for (double& v : value) v /= std::max(1u, last - first);
}

model::SurfaceFields SurfaceSampler::fields(const model::UnknownLayout& layout,
                                            const model::FrameSolution& frame,
                                            std::span<const geometry::Pose> poses,
                                            const visibility::Occluders& occluders,
                                            const DirectLightOptions& options, IndirectLight from) const {
    const std::size_t points = mesh_.points.size(), channels = scene_.channels.size();
    const bool radiometric = scene_.quantity == model::Quantity::Radiometric;
    const std::string unit = radiometric ? "W_m2" : "lx";
    model::SurfaceFields fields;
    fields.time_s = frame.time_s;
    fields.points.resize(points);
    fields.point_arrays = {array_of(radiometric ? "Radiosity_W_m2" : "Radiosity_lm_m2", scene_, points),
                           array_of("Irradiance_" + unit, scene_, points),
                           array_of("Direct_" + unit, scene_, points),
                           array_of("Indirect_" + unit, scene_, points)};
    if (frame.element_error.size() == elements_.size())
        fields.cell_arrays.push_back(error_array(mesh_, frame, unit));

    const DirectLight direct_light(moved_sources(elements_, scene_, poses), scene_, frame.time_s, occluders,
                                   options);
    std::vector<geometry::ElementShape> moved_elements; // that light is gathered from
    if (from == IndirectLight::Gathered)
        for (const geometry::ElementShape& element : elements_)
            moved_elements.push_back(geometry::moved(element, poses[element.object.value]));
    const Gather gather(moved_elements, scene_, layout, frame, occluders);
    const auto exitances = model::exitances_at(scene_, frame.time_s);
    const auto evaluate = [&](std::size_t p, std::vector<double>& direct, std::vector<double>& bounced) {
        const geometry::Pose& pose = poses[mesh_.point_objects[p]];
        fields.points[p] = pose.point(mesh_.points[p]);
        const Receiver receiver = moved(receivers_[p], pose);
        direct_light.irradiance(receiver, p, direct);
        if (from == IndirectLight::Gathered)
            // Beside an edge, not on it, where what is seen of the face beyond jumps. The error follows the channels.
            bounced = gather.indirect({receiver.ray_origin.value_or(receiver.position), receiver.normal});
        else
            indirect(p, layout, frame.irradiance_indirect, bounced);
        const std::vector<double>& exitance = exitances[materials_[p].value];
        const std::vector<double>& reflectance = scene_.materials[materials_[p].value].reflectance;
        for (std::size_t c = 0; c < channels; ++c) {
            const double irradiance = std::max(0.0, direct[c] + bounced[c]);
            const std::array<double, 4> values{exitance[c] + reflectance[c] * irradiance, irradiance,
                                               direct[c], bounced[c]};
            for (std::size_t a = 0; a < values.size(); ++a)
                fields.point_arrays[a].values[p * channels + c] = static_cast<float>(values[a]);
        }
    };
    core::parallel_for((points + points_at_once - 1) / points_at_once, [&](std::size_t task) {
        std::vector<double> direct(channels), bounced(channels);
        for (std::size_t p = task * points_at_once; p < std::min(points, (task + 1) * points_at_once); ++p)
            evaluate(p, direct, bounced);
    });
    return fields;
}

model::SurfaceFields surface_fields(const model::DisplayMesh& mesh,
                                    std::span<const geometry::ElementShape> rest_elements,
                                    const model::Scene& scene, const model::UnknownLayout& layout,
                                    const model::FrameSolution& frame, std::span<const geometry::Pose> poses,
                                    const visibility::Occluders& occluders,
                                    const DirectLightOptions& options) {
    return SurfaceSampler(mesh, rest_elements, scene, occluders.end_offset())
        .fields(layout, frame, poses, occluders, options);
}

} // namespace kinelux::sample
