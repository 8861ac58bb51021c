// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/coefficients.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "coefficients/element_tree.h"
#include "coefficients/links.h"
#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "geometry/pose.h"
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

Ball bounding_ball(std::span<const ElementShape> elements, ObjectId object) {
    Vec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const ElementShape& element : elements)
        if (element.object == object) {
            low = glm::min(low, element.box_low);
            high = glm::max(high, element.box_high);
        }
    return {0.5 * (low + high), 0.5 * glm::length(high - low)};
}

// Balls that cover each moving body at all frames; neighbouring positions share one.
std::vector<Ball> swept_balls(std::span<const ElementShape> elements, const model::Scene& scene,
                              const model::Plan& plan) {
    std::vector<Ball> result;
    for (const ObjectId object : plan.moving_objects) {
        const Ball rest = bounding_ball(elements, object);
        if (!std::isfinite(rest.radius)) continue;
        const model::Motion& motion = scene.motions[scene.objects[object.value].motion->value];
        std::optional<Ball> current;
        for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame) {
            const Vec3 centre = geometry::pose_at(motion, scene.time.time_of_frame(frame)).point(rest.centre);
            if (current && glm::distance(current->centre, centre) < 0.5 * rest.radius) {
                current->radius =
                    std::max(current->radius, glm::distance(current->centre, centre) + rest.radius);
                continue;
            }
            if (current) result.push_back(*current);
            current = Ball{centre, rest.radius};
        }
        result.push_back(*current);
    }
    return result;
}

struct Box {
    Vec3 low{std::numeric_limits<double>::infinity()};
    Vec3 high{-std::numeric_limits<double>::infinity()};

    void add(const Vec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    // Whether more than the surfaces meet.
    bool meets(const Vec3& other_low, const Vec3& other_high) const {
        constexpr double touch = 1e-9; // of the size
        const double slack = touch * glm::length(high - low);
        return glm::all(glm::lessThan(low + slack, other_high)) &&
               glm::all(glm::lessThan(other_low, high - slack));
    }
};

Box posed_box(const ElementShape& element, const geometry::Pose& pose) {
    Box box;
    for (int corner = 0; corner < 8; ++corner)
        box.add(pose.point({(corner & 1) != 0 ? element.box_high.x : element.box_low.x,
                            (corner & 2) != 0 ? element.box_high.y : element.box_low.y,
                            (corner & 4) != 0 ? element.box_high.z : element.box_low.z}));
    return box;
}

// Per motion whether in some frame anything that it does not carry reaches into the box of all that it does.
std::vector<std::uint8_t> meetings(std::span<const ElementShape> elements, const model::Scene& scene,
                                   const model::Plan& plan,
                                   const std::vector<std::optional<MotionId>>& carriers) {
    std::vector<std::uint8_t> result(scene.motions.size(), 0);
    if (plan.moving_objects.empty()) return result;
    for (std::uint32_t frame = 0; frame < scene.time.frames; ++frame) {
        const auto poses = geometry::object_poses(scene, scene.time.time_of_frame(frame));
        std::vector<Box> carried(scene.motions.size());
        for (const ElementShape& element : elements)
            if (const auto& carrier = carriers[element.object.value]) {
                const Box box = posed_box(element, poses[element.object.value]);
                carried[carrier->value].add(box.low);
                carried[carrier->value].add(box.high);
            }
        for (const ElementShape& element : elements) {
            const auto& own = carriers[element.object.value];
            const Box box = own ? posed_box(element, poses[element.object.value])
                                : Box{element.box_low, element.box_high};
            for (std::size_t m = 0; m < carried.size(); ++m)
                if (!(own && own->value == m) && carried[m].meets(box.low, box.high)) result[m] = 1;
        }
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
        if (plan.moving_occlusion) movers_ = swept_balls(elements, scene, plan);
        if (options.occlusion) meetings_ = meetings(elements, scene, plan, carriers_);
        for (const ElementShape& element : elements) ends_.push_back(visibility::shaft_end(element));
    }

    bool at_rest(std::size_t i, std::size_t j) const {
        return carriers_[elements_[i].object.value] == carriers_[elements_[j].object.value];
    }

    bool rides(std::size_t i) const { return carriers_[elements_[i].object.value].has_value(); }
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

    // Whether at rest a moving body stands in a pair of another carrier: blocks of riding pairs see all that move.
    bool strangers_between(const ElementPair& pair) const {
        if (!options_.occlusion || !kernel::may_exchange(elements_[pair.i], elements_[pair.j])) return false;
        const auto& own = carriers_[elements_[pair.i].object.value];
        std::vector<std::uint8_t> counts;
        counts.reserve(carriers_.size());
        for (const auto& carrier : carriers_) counts.push_back(carrier && carrier != own ? 1 : 0);
        if (std::find(counts.begin(), counts.end(), 1) == counts.end()) return false;
        thread_local visibility::PairBlockers blockers;
        return blockers.any_between(ends_[pair.i], ends_[pair.j], occluders_.polygons(),
                                    visibility::Among::Moving, counts);
    }

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
        if (rides) {
            if (!meetings_.empty() && meetings_[carriers_[a.object.value]->value] != 0)
                row.crossed.push_back(pair);
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
    std::vector<std::optional<MotionId>> carriers_;
    std::vector<Ball> movers_;
    std::vector<std::uint8_t> meetings_;     ///< per motion: whether others come near what it carries
    std::vector<visibility::ShaftEnd> ends_; ///< per element
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
                                         const kernel::TransportOptions& options, double memory_limit_mib,
                                         const GroupingOptions& grouping) {
    RowBuilder builder(rest_elements, scene, plan, occluders, options);
    double needed_mib = memory_bound_mib(rest_elements, builder);
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

    std::vector<Row> rows(rest_elements.size());
    core::Progress progress("coefficients", rows.size());
    core::parallel_for(rows.size(), [&](std::size_t i) {
        rows[i] = builder.build(i);
        progress.advance();
    });

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
