// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/animation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "geometry/pose.h"
#include "model/hierarchy.h"
#include "solve/vectors.h"

namespace kinelux::solve {

namespace {

using model::FrameSolution;

/// How the elements reflect. Where all channels are proportional only the first is solved, and `scale` leads back to the
/// others.
struct Surfaces {
    std::size_t channels = 0;        ///< solved
    std::vector<double> reflectance; ///< elements x channels [1]
    std::vector<double> scale;       ///< per channel of the scene; empty: all are solved [1]
    std::vector<bool> emits;         ///< per element
};

Surfaces surfaces_of(const Animation& animation) {
    const auto& materials = animation.scene.materials;
    Surfaces surfaces;
    surfaces.channels = animation.plan.single_channel ? 1 : animation.scene.channels.size();
    for (const model::Element& element : animation.elements) {
        const model::Material& material = materials[element.material.value];
        surfaces.reflectance.insert(surfaces.reflectance.end(), material.reflectance.begin(),
                                    material.reflectance.begin() +
                                        static_cast<std::ptrdiff_t>(surfaces.channels));
        surfaces.emits.push_back(material.emits());
        if (animation.plan.single_channel && surfaces.scale.empty() && material.exitance.front() > 0.0)
            for (const double value : material.exitance)
                surfaces.scale.push_back(value / material.exitance.front());
    }
    if (animation.plan.single_channel) surfaces.scale.resize(animation.scene.channels.size(), 0.0);
    return surfaces;
}

/// M at a time as coefficients, unknowns x channels [W/m2 or lm/m2].
std::vector<double> exitance_at(const Animation& animation, std::size_t channels, double time_s) {
    const auto exitances = model::exitances_at(animation.scene, time_s);
    std::vector<double> exitance;
    for (const model::Element& element : animation.elements) {
        const std::vector<double>& values = exitances[element.material.value];
        exitance.insert(exitance.end(), values.begin(),
                        values.begin() + static_cast<std::ptrdiff_t>(channels));
    }
    return constant_coefficients(animation.coefficients.layout, channels, animation.areas, exitance);
}

/// One bounce is left out, so is all that follows it: B = M + rho G M.
FrameSolution direct_only(const TransportOperator& transport, const Surfaces& surfaces,
                          std::span<const double> exitance) {
    const auto& layout = transport.layout();
    FrameSolution frame;
    frame.irradiance_direct.resize(exitance.size());
    apply(transport, surfaces.channels, exitance, frame.irradiance_direct);
    frame.irradiance_indirect.assign(exitance.size(), 0.0);
    frame.radiosity.assign(exitance.begin(), exitance.end());
    for (std::size_t e = 0; e < layout.elements(); ++e)
        for (std::size_t u = layout.offsets[e]; u < layout.offsets[e + 1]; ++u)
            for (std::size_t c = 0; c < surfaces.channels; ++c)
                frame.radiosity[u * surfaces.channels + c] +=
                    surfaces.reflectance[e * surfaces.channels + c] *
                    frame.irradiance_direct[u * surfaces.channels + c];
    frame.sweeps = 1;
    return frame;
}

/// Relative L2 error of radiosity over the elements that do not emit. An error of irradiance is reflected again and
/// again: at most 1 / (1 - rho) times as much arrives in the end, rho being the mean reflectance.
double radiosity_error(const model::UnknownLayout& layout, const Surfaces& surfaces,
                       std::span<const double> areas, const FrameSolution& frame) {
    double error = 0.0, size = 0.0, reflected = 0.0, area = 0.0;
    for (std::size_t e = 0; e < layout.elements(); ++e) {
        const auto rho = std::span(surfaces.reflectance).subspan(e * surfaces.channels, surfaces.channels);
        const double rho_square = square_sum(rho) / static_cast<double>(surfaces.channels);
        reflected += std::sqrt(rho_square) * areas[e];
        area += areas[e];
        if (surfaces.emits[e]) continue;
        const double irradiance_error = static_cast<double>(frame.element_error[e]);
        error += rho_square * irradiance_error * irradiance_error * areas[e];
        size += square_sum(std::span(frame.radiosity)
                               .subspan(layout.offsets[e] * surfaces.channels,
                                        layout.count(e) * surfaces.channels)) /
                static_cast<double>(surfaces.channels);
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
void spread_channels(const Surfaces& surfaces, FrameSolution& frame) {
    if (surfaces.scale.empty()) return;
    for (auto* values : {&frame.radiosity, &frame.irradiance_direct, &frame.irradiance_indirect})
        *values = spread(*values, surfaces.scale);
    const double rms = std::sqrt(square_sum(surfaces.scale) / static_cast<double>(surfaces.scale.size()));
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

/// What the basis of an element cannot hold of the indirect irradiance: degrees fall on as they fell from the last but one
/// to the highest, but no faster than by `fastest_fall`, which measured errors ask for (docs/accuracy-and-cost.md). A constant says
/// nothing of its own error; a tenth of it is assumed. @return  integral over the element of the squared error, all channels
double discretisation_error(std::span<const double> irradiance, std::size_t functions, std::size_t channels) {
    constexpr double assumed_for_constants = 0.1;
    if (functions == 1) return assumed_for_constants * assumed_for_constants * square_sum(irradiance);
    constexpr double fastest_fall = 0.3;
    std::size_t lower = 0, highest = 0; // functions below the highest degree, and of it
    for (std::size_t degree = 1; lower + degree < functions; ++degree) {
        highest = degree;
        lower += degree;
    }
    const double last = square_sum(irradiance.subspan(lower * channels));
    const double before = square_sum(irradiance.subspan((lower - highest) * channels, highest * channels));
    const double fall = before > 0.0 ? last / before : 1.0;
    return last * std::clamp(fall, fastest_fall * fastest_fall, 1.0);
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
    const Surfaces surfaces = surfaces_of(animation);
    const auto& layout = animation.coefficients.layout;
    motion::Importance result;
    double reflected = 0.0, area = 0.0;
    for (std::size_t e = 0; e < layout.elements(); ++e) {
        const auto rho = std::span(surfaces.reflectance).subspan(e * surfaces.channels, surfaces.channels);
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
        auto changed = engine.advance(time_s, geometry::object_poses(animation.scene, time_s));
        blocks.replace(changed.pairs, std::move(changed.blocks));
        const std::vector<double> exitance = exitance_at(animation, surfaces.channels, time_s);
        const SystemSolution solved =
            solve_system({transport, surfaces.channels, exitance, surfaces.reflectance, animation.areas},
                         {.tolerance = coarse}, {});
        double size = 0.0;
        for (std::size_t e = 0; e < layout.elements(); ++e) {
            const double own = square_sum(
                std::span(solved.radiosity)
                    .subspan(layout.offsets[e] * surfaces.channels, layout.count(e) * surfaces.channels));
            result.radiosity[e] = std::max(result.radiosity[e], std::sqrt(own));
            size += surfaces.emits[e] ? 0.0 : own;
        }
        result.size = number == frames.front() ? std::sqrt(size) : std::min(result.size, std::sqrt(size));
    }
    return result;
}

namespace {

/// The frames of one animation: what they have in common, and what changes from one to the next.
class Frames {
public:
    Frames(const Animation& animation, motion::Engine& engine, const SolveOptions& options)
        : animation_(animation),
          engine_(engine),
          surfaces_(surfaces_of(animation)),
          solver_(surfaces_.channels, surfaces_.reflectance, {animation.areas.begin(), animation.areas.end()},
                  options),
          blocks_(animation.coefficients.layout, animation.coefficients.static_blocks),
          linked_(blocks_, animation.coefficients.hierarchy) {}

    /// Brings engine and solver to where they were after the frames that are done.
    void take_up(std::span<const FrameSolution> done, model::SolverState state) {
        const std::size_t first = engine_.remembers() && moves() ? 0 : done.size() - 1;
        for (std::size_t f = first; f < done.size(); ++f) advance(done[f].time_s);
        exitance_ = exitance_at(animation_, surfaces_.channels, done.back().time_s);
        if (!state.empty()) solver_.restore(std::move(state), transport());
    }

    /// @param before  the frame before, null for the first
    FrameSolution next(const FrameSolution* before, std::uint32_t number, double time_s) {
        const bool same_blocks = before != nullptr && !moves();
        std::vector<double> exitance = exitance_at(animation_, surfaces_.channels, time_s);
        const bool same_lamps = exitance == exitance_;
        exitance_ = std::move(exitance);
        FrameSolution frame;
        if (same_blocks && same_lamps) {
            frame = *before;
            frame.sweeps = 0.0;
        } else {
            if (same_blocks)
                recomputed_ = changing_ = 0;
            else
                advance(time_s);
            frame = solved();
        }
        frame.frame = number;
        frame.time_s = time_s;
        return frame;
    }

    const model::SolverState& state() const { return solver_.state(); }

private:
    const TransportOperator& transport() const {
        if (animation_.coefficients.hierarchy.empty()) return blocks_;
        return linked_;
    }

    bool moves() const { return !animation_.plan.moving_objects.empty(); }

    /// To the blocks of a time.
    void advance(double time_s) {
        motion::FrameBlocks changed =
            engine_.advance(time_s, geometry::object_poses(animation_.scene, time_s));
        recomputed_ = static_cast<std::uint32_t>(changed.computed);
        changing_ = static_cast<std::uint32_t>(changed.pairs.size());
        entries_ = entries_at(animation_.coefficients.static_blocks, changed);
        blocks_.replace(changed.pairs, std::move(changed.blocks));
    }

    FrameSolution solved() {
        FrameSolution frame = animation_.plan.bounces == 0 ? direct_only(transport(), surfaces_, exitance_)
                                                           : solver_.solve_frame(transport(), exitance_);
        const model::Coefficients& coefficients = animation_.coefficients;
        frame.blocks_recomputed = recomputed_;
        frame.blocks_changing = changing_;
        frame.element_error = irradiance_errors(coefficients.layout, entries_, animation_.areas, exitance_,
                                                frame, surfaces_.channels, coefficients.hierarchy);
        frame.error_estimate = radiosity_error(coefficients.layout, surfaces_, animation_.areas, frame);
        spread_channels(surfaces_, frame);
        return frame;
    }

    const Animation& animation_;
    motion::Engine& engine_;
    const Surfaces surfaces_;
    TemporalSolver solver_;
    BlockOperator blocks_;
    const LinkedOperator linked_;
    std::vector<model::BlockEntry> entries_;      ///< of all blocks as they are
    std::vector<double> exitance_;                ///< of the last frame
    std::uint32_t recomputed_ = 0, changing_ = 0; ///< blocks of the last frame
};

} // namespace

model::Solution solve_animation(const Animation& animation, motion::Engine& engine,
                                std::span<const std::uint32_t> frames, const SolveOptions& options,
                                const std::function<void(const FrameSolution&)>& progress,
                                Checkpoint checkpoint) {
    model::Solution solution{.layout = animation.coefficients.layout,
                             .channels = static_cast<std::uint32_t>(animation.scene.channels.size()),
                             .frames = std::move(checkpoint.from.solution.frames)};
    Frames all(animation, engine, options);
    if (!solution.frames.empty()) all.take_up(solution.frames, std::move(checkpoint.from.state));
    for (const std::uint32_t number : frames.subspan(solution.frames.size())) {
        const auto started = std::chrono::steady_clock::now();
        const FrameSolution* before = solution.frames.empty() ? nullptr : &solution.frames.back();
        FrameSolution frame = all.next(before, number, animation.scene.time.time_of_frame(number));
        frame.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
        solution.frames.push_back(std::move(frame));
        if (checkpoint.save) checkpoint.save(solution, all.state());
        progress(solution.frames.back());
    }
    return solution;
}

} // namespace kinelux::solve
