// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/coefficients.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "coefficients/element_tree.h"
#include "coefficients/links.h"
#include "coefficients/obstacles.h"
#include "coefficients/pair_screen.h"
#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "kernel/clear_pair.h"
#include "visibility/pair_blockers.h"
#include "visibility/polygon_blockers.h"

namespace kinelux::coefficients {

namespace {

using geometry::ElementShape;
using model::ElementPair;

// The motion that carries each object, or nothing for bodies at rest. Bodies on one motion keep their distance.
std::vector<std::optional<MotionId>> carriers(const model::Scene& scene, const model::Plan& plan) {
    std::vector<std::optional<MotionId>> result(scene.objects.size());
    for (const ObjectId object : plan.moving_objects)
        result[object.value] = scene.objects[object.value].motion;
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
        : elements_(elements),
          occluders_(occluders),
          options_(options),
          screen_(elements, options.occlusion && !occluders.empty() ? &occluders.polygons() : nullptr) {
        const auto carrier_of_object = carriers(scene, plan);
        for (const ElementShape& element : elements) {
            const std::optional<MotionId>& carrier = carrier_of_object[element.object.value];
            carrier_of_.push_back(carrier ? carrier->value : resting);
            ends_.emplace_back(element);
        }
        if (plan.moving_occlusion) movers_ = swept_balls(elements, scene, plan);
        if (!options.occlusion || plan.moving_objects.empty()) return;
        met_ = met_motions(elements, scene);
        for (std::uint32_t motion = 0; motion < scene.motions.size(); ++motion) {
            auto& others = strangers_.emplace_back();
            for (const auto& carrier : carrier_of_object)
                others.push_back(carrier && carrier->value != motion ? 1 : 0);
        }
    }

    bool at_rest(std::size_t i, std::size_t j) const { return carrier_of_[i] == carrier_of_[j]; }

    bool may_exchange(std::size_t i, std::size_t j) const { return screen_.may_exchange(i, j); }
    bool rides(std::size_t i) const { return carrier_of_[i] != resting; }
    std::span<const Ball> movers() const { return movers_; }
    std::span<const ElementPair> near() const { return near_; }

    /// From now on only these pairs of elements that rest have blocks; links hold the others. @param near  sorted
    void restrict_to(std::vector<ElementPair> near) {
        near_ = std::move(near);
        grouped_ = true;
        for (std::size_t i = 0; i < elements_.size(); ++i)
            if (rides(i)) riding_.push_back(static_cast<std::uint32_t>(i));
    }

    Row build(std::size_t i) const {
        Row row;
        for (const std::uint32_t j : partners(i)) {
            const ElementPair pair{static_cast<std::uint32_t>(i), j};
            if (!at_rest(i, j)) {
                row.moving.push_back(pair);
                continue;
            }
            ++row.examined;
            if (rides(i) && strangers_between(pair))
                row.moving.push_back(pair); // nothing that would stand is known of it
            else
                add_static_block(pair, row);
        }
        return row;
    }

private:
    // The elements j >= i whose pair with i is no link's, in order.
    std::vector<std::uint32_t> partners(std::size_t i) const {
        const auto number = static_cast<std::uint32_t>(i);
        std::vector<std::uint32_t> result;
        if (!grouped_ || rides(i)) {
            result.resize(elements_.size() - i);
            std::iota(result.begin(), result.end(), number);
            return result;
        }
        const auto first = std::lower_bound(near_.begin(), near_.end(), ElementPair{number, 0});
        for (auto pair = first; pair != near_.end() && pair->i == number; ++pair) result.push_back(pair->j);
        const auto middle = static_cast<std::ptrdiff_t>(result.size());
        result.insert(result.end(), std::lower_bound(riding_.begin(), riding_.end(), number), riding_.end());
        std::inplace_merge(result.begin(), result.begin() + middle, result.end());
        return result;
    }

    static void add(const ElementPair& pair, std::span<const double> values, double error, Row& row) {
        row.entries.push_back({pair.i, pair.j, row.values.size(), static_cast<float>(error)});
        for (const double value : values) row.values.push_back(static_cast<float>(value));
    }

    // The short way for most pairs of a scene. @return  false: it does not lead there
    bool add_clear_block(const ElementPair& pair, Row& row) const {
        constexpr std::size_t most = geometry::basis_size(geometry::max_degree);
        std::array<double, most * most> memory;
        const ElementShape &a = elements_[pair.i], &b = elements_[pair.j];
        const std::span values(memory.data(), a.basis.size() * b.basis.size());
        auto error = kernel::clear_far_block(ends_[pair.i], ends_[pair.j], options_.tolerance, values);
        if (!error && values.size() == 1)
            error = kernel::clear_near_block(a, b, options_.tolerance, values[0]);
        if (error && (values.size() > 1 || values[0] > 0.0)) add(pair, values, *error, row);
        return error.has_value();
    }

    // Whether at rest a body of another motion stands between two that ride: their blocks see all that moves.
    bool strangers_between(const ElementPair& pair) const {
        if (!options_.occlusion || strangers_.empty() || !may_exchange(pair.i, pair.j)) return false;
        thread_local visibility::PairBlockers blockers;
        return blockers.any_between(visibility::shaft_end(elements_[pair.i]),
                                    visibility::shaft_end(elements_[pair.j]), occluders_.polygons(),
                                    visibility::Among::Moving, strangers_[carrier_of_[pair.i]]);
    }

    void add_static_block(const ElementPair& pair, Row& row) const {
        const ElementShape& a = elements_[pair.i];
        const ElementShape& b = elements_[pair.j];
        const bool rides = this->rides(pair.i);
        const Screened screened = screen_.look(pair.i, pair.j);
        if (screened == Screened::Apart || (screened == Screened::Hidden && !rides)) return;
        const bool short_way =
            screened == Screened::Clear && !rides && options_.integration == kernel::Integration::Automatic;
        if (!short_way || !add_clear_block(pair, row)) {
            kernel::TransportOptions options = options_;
            options.occluders = rides ? visibility::Among::Moving : visibility::Among::Resting;
            options.occlusion = options_.occlusion && (rides || screened != Screened::Clear);
            const kernel::TransportBlock block = kernel::transport(a, b, occluders_, options);
            row.rays += block.rays;
            if (block.values.empty()) return;
            add(pair, block.values, block.error, row);
        }
        if (rides) {
            if (!met_.empty() && met_[carrier_of_[pair.i]] != 0) row.crossed.push_back(pair);
            return;
        }
        if (std::any_of(movers_.begin(), movers_.end(), [&](const Ball& mover) {
                return geometry::may_pass_between(a, b, mover.centre, mover.radius);
            }))
            row.crossed.push_back(pair);
    }

    std::span<const ElementShape> elements_;
    const visibility::Occluders& occluders_;
    kernel::TransportOptions options_;
    static constexpr std::uint32_t resting = ~std::uint32_t{0};
    std::vector<std::uint32_t> carrier_of_; ///< of each element: its motion's number, or resting
    PairScreen screen_;
    std::vector<kernel::FlatEnd> ends_;
    std::vector<Ball> movers_;
    std::vector<std::uint8_t> met_; ///< per motion: whether others come near what it carries
    std::vector<std::vector<std::uint8_t>>
        strangers_; ///< per motion, per object: 1 = moves, by another motion
    bool grouped_ = false;
    std::vector<ElementPair> near_;
    std::vector<std::uint32_t> riding_;
};

// Puts all pairs of elements at rest that may share a link into links; the builder keeps the others.
void group_distant_pairs(std::span<const ElementShape> elements, const model::Scene& scene,
                         const visibility::Occluders& occluders, const kernel::TransportOptions& options,
                         double tolerance, RowBuilder& builder, model::Coefficients& result) {
    std::vector<std::uint32_t> members;
    for (std::size_t i = 0; i < elements.size(); ++i)
        if (!builder.rides(i)) members.push_back(static_cast<std::uint32_t>(i));
    if (members.size() < 2) return;
    bool moving_light = false;
    for (std::size_t i = 0; i < elements.size(); ++i)
        moving_light =
            moving_light || (builder.rides(i) && scene.materials[elements[i].material.value].emits());
    ElementTree tree = build_element_tree(elements, members, occluders);
    LinkedPairs pairs =
        link_groups(tree, elements, even_light(elements, scene), occluders, options,
                    {.tolerance = tolerance, .movers = builder.movers(), .refine_light = !moving_light});
    result.hierarchy = std::move(tree.hierarchy);
    result.hierarchy.links = std::move(pairs.links);
    result.hierarchy.error_estimate = pairs.error_estimate;
    result.rays_cast = pairs.rays;
    builder.restrict_to(std::move(pairs.near));
}

void append(const Row& row, model::Coefficients& result) {
    model::BlockSet& blocks = result.static_blocks;
    const std::uint64_t base = blocks.values.size();
    for (model::BlockEntry entry : row.entries) {
        entry.offset += base;
        blocks.entries.push_back(entry);
    }
    blocks.values.insert(blocks.values.end(), row.values.begin(), row.values.end());
    result.moving_pairs.insert(result.moving_pairs.end(), row.moving.begin(), row.moving.end());
    result.crossed_pairs.insert(result.crossed_pairs.end(), row.crossed.begin(), row.crossed.end());
    result.pairs_examined += static_cast<double>(row.examined);
    result.rays_cast += static_cast<double>(row.rays);
}

// Computes all rows that are not there yet, a batch at a time, and hands what is done to the checkpoint after each.
void add_rows(const RowBuilder& builder, std::size_t count, Checkpoint checkpoint,
              model::Coefficients& result) {
    constexpr std::size_t batches = 50, least_rows = 16; // threads wait for each other at the end of a batch
    model::CoefficientsSoFar so_far = std::move(checkpoint.from);
    if (so_far.rows > 0)
        so_far.coefficients.hierarchy = std::move(result.hierarchy);
    else
        so_far.coefficients = std::move(result);
    core::Progress progress("coefficients", count);
    progress.advance(so_far.rows);
    std::vector<Row> rows;
    while (so_far.rows < count) {
        rows.assign(std::min(std::max(count / batches, least_rows), count - so_far.rows), {});
        core::parallel_for(rows.size(), [&](std::size_t k) {
            rows[k] = builder.build(so_far.rows + k);
            progress.advance();
        });
        for (const Row& row : rows) append(row, so_far.coefficients);
        so_far.rows += rows.size();
        if (checkpoint.save && so_far.rows < count) checkpoint.save(so_far);
    }
    result = std::move(so_far.coefficients);
}

// An upper bound: of all pairs while these fit the limit, else of those that may exchange light.
double memory_bound_mib(std::span<const ElementShape> elements, const RowBuilder& builder, double limit_mib) {
    constexpr double mib = 1024.0 * 1024.0;
    double unknowns = 0.0;
    for (const ElementShape& element : elements) unknowns += static_cast<double>(element.basis.size());
    const auto count = static_cast<double>(elements.size());
    const double all =
        (unknowns * unknowns * sizeof(float) + count * count * sizeof(model::BlockEntry)) / mib;
    if (all <= limit_mib) return all;
    std::vector<double> bytes(elements.size());
    core::parallel_for(elements.size(), [&](std::size_t i) {
        for (std::size_t j = i; j < elements.size(); ++j)
            if (builder.at_rest(i, j) && builder.may_exchange(i, j))
                bytes[i] +=
                    static_cast<double>(elements[i].basis.size() * elements[j].basis.size() * sizeof(float) +
                                        sizeof(model::BlockEntry));
    });
    double sum = 0.0;
    for (const double row : bytes) sum += row;
    return sum / mib;
}

// Memory of links and of the blocks that remain for near pairs at rest.
double linked_memory_mib(std::span<const ElementShape> elements, const model::Hierarchy& hierarchy,
                         std::span<const ElementPair> near) {
    double bytes = static_cast<double>(hierarchy.links.entries.size() * sizeof(model::BlockEntry) +
                                       hierarchy.links.values.size() * sizeof(float));
    for (const ElementPair& pair : near)
        bytes += static_cast<double>(elements[pair.i].basis.size() * elements[pair.j].basis.size() *
                                         sizeof(float) +
                                     sizeof(model::BlockEntry));
    return bytes / (1024.0 * 1024.0);
}

// The reflectance by which light fades from bounce to bounce where it lives longest: of a scene as a whole, or among its
// brightest surfaces alone, for these may be a white cavity in a dark hall.
double bouncing_reflectance(const model::Scene& scene, std::span<const ElementShape> elements) {
    constexpr double least_area = 0.01, brightest = 0.999; // less area cannot keep light to itself
    std::vector<double> areas(scene.materials.size(), 0.0);
    double total = 0.0;
    for (const ElementShape& element : elements) {
        areas[element.material.value] += element.area;
        total += element.area;
    }
    double result = 0.0;
    for (std::size_t m = 0; m < areas.size(); ++m) {
        const auto& rho = scene.materials[m].reflectance;
        if (areas[m] > least_area * total)
            result = std::max(result, *std::max_element(rho.begin(), rho.end()));
    }
    return std::min(result, brightest);
}

} // namespace

kernel::TransportOptions transport_options_for(const model::Scene& scene, const model::Plan& plan,
                                               std::span<const ElementShape> elements) {
    // The blocks' share of the error budget, and what bounces leave of it.
    constexpr double share = 0.2;
    const double bounces = 1.0 / (1.0 - bouncing_reflectance(scene, elements));
    kernel::TransportOptions options;
    options.tolerance = std::clamp(share * scene.accuracy.target / bounces, 1e-9, 0.1);
    // Errors of what stands between have random signs: of n blocks of one size they add up to 1 / sqrt(n) of the row.
    constexpr double most_scattered = 40.0; // a row that matters may go to a few elements only
    const double scattered = std::min(std::sqrt(static_cast<double>(elements.size())), most_scattered);
    options.sight_tolerance = std::min(scattered * options.tolerance, 0.1);
    // Blocks of curved elements cost a hundred times as much as others, and what they may be off adds up like that as well.
    // A row has only one of an element with itself.
    options.curved_floor = 1.0 / scattered;
    options.own_floor = 1.0;
    // One that is smaller than the mean of a row may be off by as much as the mean.
    options.sight_floor =
        std::clamp(1.0 / static_cast<double>(std::max<std::size_t>(elements.size(), 1)), 1e-5, 0.1);
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

RowSample sample_rows(std::span<const ElementShape> rest_elements, const model::Scene& scene,
                      const model::Plan& plan, const visibility::Occluders& occluders,
                      const kernel::TransportOptions& options, std::size_t count) {
    const RowBuilder builder(rest_elements, scene, plan, occluders, options);
    RowSample sample;
    count = std::min(count, rest_elements.size());
    // Rows hold the pairs j >= i, so they grow shorter: the middle of each of `count` equal parts.
    for (std::size_t k = 0; k < count; ++k)
        sample.rows.push_back((2 * k + 1) * rest_elements.size() / (2 * count));
    sample.seconds.resize(count);
    std::vector<Row> rows(count);
    core::parallel_for(count, [&](std::size_t k) {
        const auto began = std::chrono::steady_clock::now();
        rows[k] = builder.build(sample.rows[k]);
        sample.seconds[k] = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    });
    sample.coefficients.layout = unknown_layout(rest_elements);
    sample.coefficients.degree = plan.degree;
    for (const Row& row : rows) append(row, sample.coefficients);
    return sample;
}

model::Coefficients compute_coefficients(std::span<const ElementShape> rest_elements,
                                         const model::Scene& scene, const model::Plan& plan,
                                         const visibility::Occluders& occluders,
                                         const kernel::TransportOptions& options, double memory_limit_mib,
                                         const GroupingOptions& grouping, Checkpoint checkpoint) {
    RowBuilder builder(rest_elements, scene, plan, occluders, options);
    double needed_mib = memory_bound_mib(rest_elements, builder, memory_limit_mib);
    const bool large = rest_elements.size() > grouping.most_elements || needed_mib > memory_limit_mib;
    model::Coefficients result;
    if (grouping.use == Grouping::Always || (grouping.use == Grouping::Auto && large))
        group_distant_pairs(rest_elements, scene, occluders, options, grouping.share * scene.accuracy.target,
                            builder, result);
    if (!result.hierarchy.empty())
        needed_mib = linked_memory_mib(rest_elements, result.hierarchy, builder.near());
    if (needed_mib > memory_limit_mib)
        throw core::ResourceError(fmt::format("the transport blocks of {} elements may take {:.0f} MiB, "
                                              "{:.0f} MiB are allowed; ask for a lower "
                                              "accuracy, a larger element size, or raise --memory-limit",
                                              rest_elements.size(), needed_mib, memory_limit_mib));

    result.layout = unknown_layout(rest_elements);
    result.degree = plan.degree;
    add_rows(builder, rest_elements.size(), std::move(checkpoint), result);
    return result;
}

} // namespace kinelux::coefficients
