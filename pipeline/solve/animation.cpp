// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/animation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "geometry/pose.h"
#include "model/hierarchy.h"

namespace kinelux::solve {

namespace {

using model::FrameSolution;

double square_sum(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return sum;
}

/// Materials spread over the elements. Where all channels are proportional only the first is solved, and `scale` leads
/// back to the others.
struct Light {
    std::size_t channels = 0;        ///< solved
    std::vector<double> exitance;    ///< M as coefficients, unknowns x channels [W/m2 or lm/m2]
    std::vector<double> reflectance; ///< elements x channels [1]
    std::vector<double> scale;       ///< per channel of the scene; empty: all are solved [1]
    std::vector<bool> emits;         ///< per element
};

Light light_of(const Animation& animation) {
    const auto& materials = animation.scene.materials;
    Light light;
    light.channels = animation.plan.single_channel ? 1 : animation.scene.channels.size();
    std::vector<double> exitance;
    for (const model::Element& element : animation.elements) {
        const model::Material& material = materials[element.material.value];
        exitance.insert(exitance.end(), material.exitance.begin(),
                        material.exitance.begin() + static_cast<std::ptrdiff_t>(light.channels));
        light.reflectance.insert(light.reflectance.end(), material.reflectance.begin(),
                                 material.reflectance.begin() + static_cast<std::ptrdiff_t>(light.channels));
        light.emits.push_back(material.emits());
        if (animation.plan.single_channel && light.scale.empty() && material.exitance.front() > 0.0)
            for (const double value : material.exitance)
                light.scale.push_back(value / material.exitance.front());
    }
    if (animation.plan.single_channel) light.scale.resize(animation.scene.channels.size(), 0.0);
    light.exitance =
        constant_coefficients(animation.coefficients.layout, light.channels, animation.areas, exitance);
    return light;
}

/// One bounce is left out, so is all that follows it: B = M + rho G M.
FrameSolution direct_only(const TransportOperator& transport, const Light& light) {
    const auto& layout = transport.layout();
    FrameSolution frame;
    frame.irradiance_direct.resize(light.exitance.size());
    apply(transport, light.channels, light.exitance, frame.irradiance_direct);
    frame.irradiance_indirect.assign(light.exitance.size(), 0.0);
    frame.radiosity = light.exitance;
    for (std::size_t e = 0; e < layout.elements(); ++e)
        for (std::size_t u = layout.offsets[e]; u < layout.offsets[e + 1]; ++u)
            for (std::size_t c = 0; c < light.channels; ++c)
                frame.radiosity[u * light.channels + c] += light.reflectance[e * light.channels + c] *
                                                           frame.irradiance_direct[u * light.channels + c];
    frame.sweeps = 1;
    return frame;
}

/// Relative L2 error of radiosity over the elements that do not emit. An error of irradiance is reflected again and
/// again: at most 1 / (1 - rho) times as much arrives in the end, rho being the mean reflectance.
double radiosity_error(const model::UnknownLayout& layout, const Light& light, std::span<const double> areas,
                       const FrameSolution& frame) {
    double error = 0.0, size = 0.0, reflected = 0.0, area = 0.0;
    for (std::size_t e = 0; e < layout.elements(); ++e) {
        const auto rho = std::span(light.reflectance).subspan(e * light.channels, light.channels);
        const double rho_square = square_sum(rho) / static_cast<double>(light.channels);
        reflected += std::sqrt(rho_square) * areas[e];
        area += areas[e];
        if (light.emits[e]) continue;
        const double irradiance_error = static_cast<double>(frame.element_error[e]);
        error += rho_square * irradiance_error * irradiance_error * areas[e];
        size +=
            square_sum(std::span(frame.radiosity)
                           .subspan(layout.offsets[e] * light.channels, layout.count(e) * light.channels)) /
            static_cast<double>(light.channels);
    }
    if (!(size > 0.0)) return 0.0;
    return std::sqrt(error / size) / (1.0 - reflected / area);
}

std::vector<double> spread(std::span<const double> values, std::span<const double> scale) {
    std::vector<double> result;
    result.reserve(values.size() * scale.size());
    for (const double value : values)
        for (const double factor : scale) result.push_back(value * factor);
    return result;
}

/// One solved channel becomes all channels of the scene.
void spread_channels(const Light& light, FrameSolution& frame) {
    if (light.scale.empty()) return;
    for (auto* values : {&frame.radiosity, &frame.irradiance_direct, &frame.irradiance_indirect})
        *values = spread(*values, light.scale);
    const double rms = std::sqrt(square_sum(light.scale) / static_cast<double>(light.scale.size()));
    for (float& error : frame.element_error) error = static_cast<float>(rms * static_cast<double>(error));
}

model::ElementPair pair_of(const model::BlockEntry& entry) { return {entry.i, entry.j}; }

bool by_pair(const model::BlockEntry& a, const model::BlockEntry& b) { return pair_of(a) < pair_of(b); }

bool is_replaced(const motion::FrameBlocks& frame, const model::BlockEntry& entry) {
    return std::binary_search(frame.pairs.begin(), frame.pairs.end(), pair_of(entry));
}

/// The entries of all blocks as they are at one time; their offsets mean nothing.
std::vector<model::BlockEntry> entries_at(const model::BlockSet& static_blocks,
                                          const motion::FrameBlocks& frame) {
    std::vector<model::BlockEntry> entries;
    entries.reserve(static_blocks.entries.size() + frame.blocks.entries.size());
    for (const model::BlockEntry& entry : static_blocks.entries)
        if (!is_replaced(frame, entry)) entries.push_back(entry);
    entries.insert(entries.end(), frame.blocks.entries.begin(), frame.blocks.entries.end());
    std::sort(entries.begin(), entries.end(), by_pair);
    return entries;
}

} // namespace

model::BlockSet blocks_at(const model::BlockSet& static_blocks, const motion::FrameBlocks& frame) {
    model::BlockSet result;
    const auto add = [&](const model::BlockSet& from) {
        for (std::size_t k = 0; k < from.entries.size(); ++k) {
            model::BlockEntry entry = from.entries[k];
            if (&from == &static_blocks && is_replaced(frame, entry)) continue;
            const std::size_t end =
                k + 1 < from.entries.size() ? from.entries[k + 1].offset : from.values.size();
            const auto values = std::span(from.values).subspan(entry.offset, end - entry.offset);
            entry.offset = result.values.size();
            result.entries.push_back(entry);
            result.values.insert(result.values.end(), values.begin(), values.end());
        }
    };
    add(static_blocks);
    add(frame.blocks);
    std::sort(result.entries.begin(), result.entries.end(), by_pair);
    return result;
}

namespace {

/// What the basis of an element cannot hold of the indirect irradiance, judged by what its highest degree holds: of a
/// smooth function each degree is smaller than the one before. A constant says nothing of its own error; a tenth of it
/// is assumed. @return  integral over the element of the squared error, all channels
double discretisation_error(std::span<const double> irradiance, std::size_t functions, std::size_t channels) {
    constexpr double assumed_for_constants = 0.1;
    if (functions == 1) return assumed_for_constants * assumed_for_constants * square_sum(irradiance);
    std::size_t lower = 0; // functions below the highest degree
    for (std::size_t degree = 1; lower + degree < functions; ++degree) lower += degree;
    return square_sum(irradiance.subspan(lower * channels));
}

/// Adds the squared errors of links, each spread over the elements of its two nodes by their area.
void add_link_errors(const model::Hierarchy& hierarchy, std::span<const double> areas,
                     std::span<const double> radiosity, std::size_t channels, std::vector<double>& error) {
    if (hierarchy.empty()) return;
    const auto& layout = hierarchy.layout;
    const std::vector<double> sent = model::gather_groups(hierarchy, channels, radiosity);
    const auto size = [&](std::size_t node) {
        return square_sum(
            std::span(sent).subspan(layout.offsets[node] * channels, layout.count(node) * channels));
    };
    std::vector<double> at_node(layout.elements(), 0.0), area(areas.begin(), areas.end());
    for (const model::BlockEntry& link : hierarchy.links.entries) {
        const double square = static_cast<double>(link.error) * static_cast<double>(link.error);
        at_node[link.i] += square * size(link.j);
        at_node[link.j] += square * size(link.i);
    }
    for (const model::ElementGroup& group : hierarchy.groups)
        area.push_back(area[group.first] + area[group.second]);
    for (std::size_t node = area.size(); node-- > areas.size();) {
        const model::ElementGroup& group = hierarchy.groups[node - areas.size()];
        for (const std::uint32_t child : {group.first, group.second})
            at_node[child] += at_node[node] * area[child] / area[node];
    }
    for (std::size_t e = 0; e < error.size(); ++e) error[e] += at_node[e];
}

} // namespace

std::vector<float> irradiance_errors(const model::UnknownLayout& layout,
                                     std::span<const model::BlockEntry> blocks, std::span<const double> areas,
                                     std::span<const double> exitance, const FrameSolution& frame,
                                     std::size_t channels, const model::Hierarchy& hierarchy) {
    // ||B_j||^2 per element; the norms of coefficients are those of the functions, the bases being orthonormal.
    std::vector<double> size(layout.elements()), error(layout.elements());
    double total_area = 0.0;
    for (std::size_t e = 0; e < layout.elements(); ++e) {
        size[e] = square_sum(
            std::span(frame.radiosity).subspan(layout.offsets[e] * channels, layout.count(e) * channels));
        total_area += areas[e];
    }
    for (const model::BlockEntry& entry : blocks) {
        const double square = static_cast<double>(entry.error) * static_cast<double>(entry.error);
        error[entry.i] += square * size[entry.j];
        if (entry.i != entry.j) error[entry.j] += square * size[entry.i];
    }
    add_link_errors(hierarchy, areas, frame.radiosity, channels, error);
    // What the solver left is spread evenly: ||r||^2 = (residual ||M||)^2.
    const double residual = frame.residual * frame.residual * square_sum(exitance) / total_area;
    std::vector<float> result(layout.elements());
    for (std::size_t e = 0; e < layout.elements(); ++e) {
        const double basis =
            discretisation_error(std::span(frame.irradiance_indirect)
                                     .subspan(layout.offsets[e] * channels, layout.count(e) * channels),
                                 layout.count(e), channels);
        const double mean_square = (error[e] + basis) / areas[e] + residual;
        result[e] = static_cast<float>(std::sqrt(mean_square / static_cast<double>(channels)));
    }
    return result;
}

motion::Importance importance_of(const Animation& animation, motion::Engine& engine,
                                 std::span<const std::uint32_t> frames) {
    constexpr double coarse = 1e-2;
    const Light light = light_of(animation);
    const auto& layout = animation.coefficients.layout;
    motion::Importance result;
    double reflected = 0.0, area = 0.0;
    for (std::size_t e = 0; e < layout.elements(); ++e) {
        const auto rho = std::span(light.reflectance).subspan(e * light.channels, light.channels);
        result.reflectance.push_back(*std::max_element(rho.begin(), rho.end()));
        reflected += result.reflectance.back() * animation.areas[e];
        area += animation.areas[e];
    }
    result.bounces = 1.0 / (1.0 - reflected / area);
    result.radiosity.assign(layout.elements(), 0.0);
    BlockOperator blocks(layout, animation.coefficients.static_blocks);
    const LinkedOperator linked(blocks, animation.coefficients.hierarchy);
    const TransportOperator& transport =
        animation.coefficients.hierarchy.empty() ? static_cast<const TransportOperator&>(blocks) : linked;
    for (const std::uint32_t number : frames) {
        const double time_s = animation.scene.time.time_of_frame(number);
        const auto changed = engine.advance(time_s, geometry::object_poses(animation.scene, time_s));
        blocks.replace(changed.pairs, changed.blocks);
        const SystemSolution solved =
            solve_system({transport, light.channels, light.exitance, light.reflectance, animation.areas},
                         {.tolerance = coarse}, {});
        double size = 0.0;
        for (std::size_t e = 0; e < layout.elements(); ++e) {
            const double own = square_sum(
                std::span(solved.radiosity)
                    .subspan(layout.offsets[e] * light.channels, layout.count(e) * light.channels));
            result.radiosity[e] = std::max(result.radiosity[e], std::sqrt(own));
            size += light.emits[e] ? 0.0 : own;
        }
        result.size = number == frames.front() ? std::sqrt(size) : std::min(result.size, std::sqrt(size));
    }
    return result;
}

model::Solution solve_animation(const Animation& animation, motion::Engine& engine,
                                std::span<const std::uint32_t> frames, const SolveOptions& options,
                                const std::function<void(const FrameSolution&)>& progress) {
    const model::Coefficients& coefficients = animation.coefficients;
    const Light light = light_of(animation);
    TemporalSolver solver(light.channels, light.exitance, light.reflectance,
                          {animation.areas.begin(), animation.areas.end()}, options);
    BlockOperator blocks(coefficients.layout, coefficients.static_blocks);
    const LinkedOperator linked(blocks, coefficients.hierarchy);
    const TransportOperator& transport =
        coefficients.hierarchy.empty() ? static_cast<const TransportOperator&>(blocks) : linked;
    model::Solution solution{.layout = coefficients.layout,
                             .channels = static_cast<std::uint32_t>(animation.scene.channels.size()),
                             .frames = {}};
    for (const std::uint32_t number : frames) {
        const auto started = std::chrono::steady_clock::now();
        const double time_s = animation.scene.time.time_of_frame(number);
        if (animation.plan.moving_objects.empty() && !solution.frames.empty()) {
            // Nothing moves: the first frame is every frame.
            FrameSolution same = solution.frames.front();
            same.frame = number;
            same.time_s = time_s;
            same.sweeps = 0;
            same.seconds = 0.0;
            progress(same);
            solution.frames.push_back(std::move(same));
            continue;
        }
        const motion::FrameBlocks changed =
            engine.advance(time_s, geometry::object_poses(animation.scene, time_s));
        blocks.replace(changed.pairs, changed.blocks);

        FrameSolution frame =
            animation.plan.bounces == 0 ? direct_only(transport, light) : solver.solve_frame(transport);
        frame.frame = number;
        frame.time_s = time_s;
        frame.blocks_recomputed = static_cast<std::uint32_t>(changed.computed);
        frame.blocks_changing = static_cast<std::uint32_t>(changed.pairs.size());
        frame.element_error =
            irradiance_errors(coefficients.layout, entries_at(coefficients.static_blocks, changed),
                              animation.areas, light.exitance, frame, light.channels, coefficients.hierarchy);
        frame.error_estimate = radiosity_error(coefficients.layout, light, animation.areas, frame);
        spread_channels(light, frame);
        frame.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
        progress(frame);
        solution.frames.push_back(std::move(frame));
    }
    return solution;
}

} // namespace kinelux::solve
