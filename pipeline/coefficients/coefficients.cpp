// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/coefficients.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "geometry/pose.h"

namespace kinelux::coefficients {

namespace {

using geometry::ElementShape;
using model::ElementPair;

struct Sphere {
    Vec3 centre;
    double radius;
};

// The motion that carries each object, or nothing for bodies at rest. Bodies on one motion keep their distance.
std::vector<std::optional<MotionId>> carriers(const model::Scene& scene, const model::Plan& plan) {
    std::vector<std::optional<MotionId>> result(scene.objects.size());
    for (const ObjectId object : plan.moving_objects)
        result[object.value] = scene.objects[object.value].motion;
    return result;
}

Sphere bounding_sphere(std::span<const ElementShape> elements, ObjectId object) {
    Vec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const ElementShape& element : elements)
        if (element.object == object) {
            low = glm::min(low, element.box_low);
            high = glm::max(high, element.box_high);
        }
    return {0.5 * (low + high), 0.5 * glm::length(high - low)};
}

// Spheres that cover each moving body at all frames; neighbouring positions share one.
std::vector<Sphere> swept_spheres(std::span<const ElementShape> elements, const model::Scene& scene,
                                  const model::Plan& plan) {
    std::vector<Sphere> result;
    for (const ObjectId object : plan.moving_objects) {
        const Sphere rest = bounding_sphere(elements, object);
        if (!std::isfinite(rest.radius)) continue;
        const model::Motion& motion = scene.motions[scene.objects[object.value].motion->value];
        std::optional<Sphere> current;
        for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame) {
            const Vec3 centre = geometry::pose_at(motion, scene.time.time_of_frame(frame)).point(rest.centre);
            if (current && glm::distance(current->centre, centre) < 0.5 * rest.radius) {
                current->radius =
                    std::max(current->radius, glm::distance(current->centre, centre) + rest.radius);
                continue;
            }
            if (current) result.push_back(*current);
            current = Sphere{centre, rest.radius};
        }
        result.push_back(*current);
    }
    return result;
}

struct Row {
    std::vector<model::BlockEntry> entries;
    std::vector<float> values;
    std::vector<ElementPair> moving, crossed;
    std::size_t examined = 0;
    std::uint64_t rays = 0;
};

class RowBuilder {
public:
    RowBuilder(std::span<const ElementShape> elements, const model::Scene& scene, const model::Plan& plan,
               const visibility::Occluders& occluders, const kernel::TransportOptions& options)
        : elements_(elements), occluders_(occluders), options_(options), carriers_(carriers(scene, plan)) {
        if (plan.moving_occlusion) movers_ = swept_spheres(elements, scene, plan);
    }

    bool at_rest(std::size_t i, std::size_t j) const {
        return carriers_[elements_[i].object.value] == carriers_[elements_[j].object.value];
    }

    Row build(std::size_t i) const {
        Row row;
        for (std::size_t j = i; j < elements_.size(); ++j) {
            const ElementPair pair{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)};
            if (!at_rest(i, j)) {
                row.moving.push_back(pair);
                continue;
            }
            ++row.examined;
            add_static_block(pair, row);
        }
        return row;
    }

private:
    void add_static_block(const ElementPair& pair, Row& row) const {
        const ElementShape& a = elements_[pair.i];
        const ElementShape& b = elements_[pair.j];
        kernel::TransportOptions options = options_;
        const bool rides = carriers_[a.object.value].has_value();
        options.occluders = rides ? visibility::Among::Moving : visibility::Among::Resting;
        const kernel::TransportBlock block = kernel::transport(a, b, occluders_, options);
        row.rays += block.rays;
        if (block.values.empty()) return;
        row.entries.push_back({pair.i, pair.j, row.values.size(), static_cast<float>(block.error)});
        for (const double value : block.values) row.values.push_back(static_cast<float>(value));
        if (!rides && std::any_of(movers_.begin(), movers_.end(), [&](const Sphere& mover) {
                return geometry::may_pass_between(a, b, mover.centre, mover.radius);
            }))
            row.crossed.push_back(pair);
    }

    std::span<const ElementShape> elements_;
    const visibility::Occluders& occluders_;
    kernel::TransportOptions options_;
    std::vector<std::optional<MotionId>> carriers_;
    std::vector<Sphere> movers_;
};

double memory_bound_mib(std::span<const ElementShape> elements, const RowBuilder& builder) {
    std::vector<double> bytes(elements.size());
    core::parallel_for(elements.size(), [&](std::size_t i) {
        for (std::size_t j = i; j < elements.size(); ++j)
            if (builder.at_rest(i, j) && kernel::may_exchange(elements[i], elements[j]))
                bytes[i] +=
                    static_cast<double>(elements[i].basis.size() * elements[j].basis.size() * sizeof(float) +
                                        sizeof(model::BlockEntry));
    });
    double sum = 0.0;
    for (const double row : bytes) sum += row;
    return sum / (1024.0 * 1024.0);
}

} // namespace

kernel::TransportOptions transport_options_for(const model::Scene& scene, const model::Plan& plan,
                                               std::span<const ElementShape> elements) {
    double area = 0.0, reflected = 0.0;
    for (const ElementShape& element : elements) {
        const auto& rho = scene.materials[element.material.value].reflectance;
        area += element.area;
        reflected += element.area * *std::max_element(rho.begin(), rho.end());
    }
    const double mean = area > 0.0 ? reflected / area : 0.0;
    // The blocks' share of the error budget, and what bounces leave of it.
    constexpr double share = 0.2, brightest = 0.999;
    const double bounces = 1.0 / (1.0 - std::min(mean, brightest));
    kernel::TransportOptions options;
    options.tolerance = std::clamp(share * scene.accuracy.target / bounces, 1e-9, 0.1);
    // Errors of what stands between have random signs: a row holds many such blocks, all of them smaller than it.
    constexpr double scattered = 20.0;
    options.sight_tolerance = std::min(scattered * options.tolerance, 0.1);
    options.occlusion = plan.static_occlusion || plan.moving_occlusion;
    return options;
}

model::UnknownLayout unknown_layout(std::span<const ElementShape> elements) {
    model::UnknownLayout layout;
    layout.offsets.push_back(0);
    for (const ElementShape& element : elements)
        layout.offsets.push_back(layout.offsets.back() + static_cast<std::uint32_t>(element.basis.size()));
    return layout;
}

model::Coefficients compute_coefficients(std::span<const ElementShape> rest_elements,
                                         const model::Scene& scene, const model::Plan& plan,
                                         const visibility::Occluders& occluders,
                                         const kernel::TransportOptions& options, double memory_limit_mib) {
    const RowBuilder builder(rest_elements, scene, plan, occluders, options);
    const double bound_mib = memory_bound_mib(rest_elements, builder);
    if (bound_mib > memory_limit_mib)
        throw core::ResourceError(fmt::format("the transport blocks of {} elements may take {:.0f} MiB, "
                                              "{:.0f} MiB are allowed; ask for a lower "
                                              "accuracy, a larger element size, or raise --memory-limit",
                                              rest_elements.size(), bound_mib, memory_limit_mib));

    std::vector<Row> rows(rest_elements.size());
    core::Progress progress("coefficients", rows.size());
    core::parallel_for(rows.size(), [&](std::size_t i) {
        rows[i] = builder.build(i);
        progress.advance();
    });

    model::Coefficients result;
    result.layout = unknown_layout(rest_elements);
    result.degree = plan.degree;
    std::size_t values = 0;
    for (const Row& row : rows) values += row.values.size();
    result.static_blocks.values.reserve(values);
    for (Row& row : rows) {
        const std::uint64_t base = result.static_blocks.values.size();
        for (model::BlockEntry entry : row.entries) {
            entry.offset += base;
            result.static_blocks.entries.push_back(entry);
        }
        result.static_blocks.values.insert(result.static_blocks.values.end(), row.values.begin(),
                                           row.values.end());
        result.moving_pairs.insert(result.moving_pairs.end(), row.moving.begin(), row.moving.end());
        result.crossed_pairs.insert(result.crossed_pairs.end(), row.crossed.begin(), row.crossed.end());
        result.pairs_examined += static_cast<double>(row.examined);
        result.rays_cast += static_cast<double>(row.rays);
        row = Row{};
    }
    return result;
}

} // namespace kinelux::coefficients
