// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/transport.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernel/curved_pair.h"
#include "kernel/far_pair.h"
#include "kernel/near_pair.h"
#include "kernel/outer_pieces.h"
#include "kernel/polygon_moments.h"
#include "kernel/quasi_monte_carlo.h"
#include "visibility/pair_blockers.h"

namespace kinelux::kernel {

namespace {

using geometry::ElementShape;
using geometry::Facet;
using geometry::NodeSet;
using geometry::SurfaceNode;
using visibility::HalfSpace;
using visibility::Loops2;
using visibility::Loops3;
using visibility::Sight;

// What keeps its memory from pair to pair; one per thread, as no pair is computed within another.
template <class Workspace>
Workspace& kept() {
    thread_local Workspace workspace;
    return workspace;
}

double frobenius_norm(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

HalfSpace front_of(const ElementShape& planar) {
    const Facet& facet = planar.facets.front();
    return {facet.normal, glm::dot(facet.normal, facet.corners[0])};
}

// What reaches less far than this over a horizon counts as below it: planes of one wall are equal but for rounding.
double horizon_slack(const ElementShape& a, const ElementShape& b) {
    constexpr double share = 1e-10; // of the smaller element: gaps of 1e-9 still count
    constexpr double roundings = 8.0 * std::numeric_limits<double>::epsilon();
    const Vec3 reach = glm::max(glm::max(glm::abs(a.box_low), glm::abs(a.box_high)),
                                glm::max(glm::abs(b.box_low), glm::abs(b.box_high)));
    return share * std::min(a.radius, b.radius) + roundings * std::max({reach.x, reach.y, reach.z});
}

Loops3 cut_to_front(const std::vector<std::vector<Vec3>>& loops, const HalfSpace& front, double slack) {
    Loops3 result;
    visibility::LoopCutter<Vec3> cutter;
    for (const auto& loop : loops) {
        cutter.begin(loop);
        cutter.keep([&](const Vec3& point) { return front.distance(point) - slack; });
        if (cutter.loop().size() >= 3) result.add(cutter.loop());
    }
    return result;
}

// Whether the plane of a planar element cuts the other one.
bool crosses_horizon(const ElementShape& planar, const ElementShape& other) {
    const HalfSpace front = front_of(planar);
    const double slack = horizon_slack(planar, other);
    if (front.distance(other.centre) >= other.radius) return false;
    for (const Facet& facet : other.facets)
        for (const Vec3& corner : facet.corners)
            if (front.distance(corner) < -slack) return true;
    return false;
}

// Whether some part of a curved element may lie behind its own horizon as seen from the other one, or the other behind
// some part's horizon.
bool turns_away(const ElementShape& curved, const ElementShape& other) {
    if (!curved.surface) return false;
    const Vec3 axis = other.centre - curved.centre;
    const double distance = glm::length(axis), radii = curved.radius + other.radius;
    if (distance <= radii) return true;
    const double angle = std::acos(std::clamp(glm::dot(curved.mean_normal, axis) / distance, -1.0, 1.0));
    return angle + std::acos(std::clamp(curved.cone_cosine, -1.0, 1.0)) + std::asin(radii / distance) >
           0.5 * std::numbers::pi;
}

// All of a polygon is visible.
class WholePolygon : public PointGather {
public:
    WholePolygon(const ElementShape& b, const Loops3& loops, double tolerance)
        : moments_(b.facets.front(), b.basis), tolerance_(tolerance) {
        moments_.to_plane(loops, flat_);
    }
    void gather(const SurfaceNode& x, std::span<double> values) override {
        const double uncertainty = moments_.gather(x.position, x.normal, flat_, tolerance_, values);
        uncertainty2_ += uncertainty * uncertainty;
        ++gathered_;
    }

    /// Frobenius norm of what the inner integrals may be off in a block over the outer element [1].
    double error(const ElementShape& outer, const ElementShape& inner) const {
        if (gathered_ == 0) return 0.0;
        const double functions = static_cast<double>(inner.basis.size());
        return std::hypot(std::sqrt(uncertainty2_ / gathered_ * functions * outer.area / inner.area),
                          measured_);
    }

    /// Gathers at a few points of the outer pieces, twice, and asks for more of the edges where they cancel or differ.
    /// @param allowed  error of a block, relative to its norm or `floor`
    void tighten(const ElementShape& outer, const ElementShape& inner, std::span<const OuterPiece> pieces,
                 double allowed, double floor) {
        constexpr std::size_t probes = 4;
        constexpr double finer = 1e-3, finest = 1e-14, safety = 3.0;
        const std::size_t size = inner.basis.size();
        std::vector<double> values(size), better(size);
        double sum2 = 0.0, difference2 = 0.0;
        for (std::size_t k = 0; k < probes; ++k) {
            const SurfaceNode x = probe(outer, pieces[k * pieces.size() / probes], k);
            gather(x, values);
            moments_.gather(x.position, x.normal, flat_, std::max(finer * tolerance_, finest), better);
            for (std::size_t l = 0; l < size; ++l) {
                sum2 += better[l] * better[l];
                difference2 += (values[l] - better[l]) * (values[l] - better[l]);
            }
        }
        double area = 0.0;
        for (const OuterPiece& piece : pieces) area += area_of(piece);
        const double per_probe = area / static_cast<double>(probes);
        const double wanted = allowed * std::max(std::sqrt(per_probe * sum2), floor);
        const double differing = safety * std::sqrt(per_probe * difference2);
        const double excess = std::max(error(outer, inner), differing) / wanted;
        if (excess > 1.0) tolerance_ = std::max(tolerance_ / excess, finest);
        measured_ = differing / std::max(excess, 1.0);
        uncertainty2_ = gathered_ = 0.0;
    }

private:
    PolygonMoments moments_;
    Loops2 flat_;
    double tolerance_;
    double uncertainty2_ = 0.0, gathered_ = 0.0; ///< sums over points
    double measured_ = 0.0;                      ///< error of a block, from the points of tighten
};

// A few polygons stand before it.
class PartlyHiddenPolygon : public PointGather {
public:
    PartlyHiddenPolygon(const ElementShape& b, const Loops3& loops,
                        std::span<const visibility::PlanarBlocker> blockers, double tolerance)
        : moments_(b.facets.front(), b.basis),
          loops_(loops),
          normal_(b.facets.front().normal),
          blockers_(blockers),
          tolerance_(tolerance) {}
    void gather(const SurfaceNode& x, std::span<double> values) override {
        moments_.to_plane(visible_.from(x.position, loops_, normal_, blockers_), flat_);
        moments_.gather(x.position, x.normal, flat_, tolerance_, values);
    }

private:
    PolygonMoments moments_;
    const Loops3& loops_;
    Vec3 normal_;
    std::span<const visibility::PlanarBlocker> blockers_;
    double tolerance_;
    visibility::VisiblePolygon& visible_ = kept<visibility::VisiblePolygon>();
    Loops2 flat_;
};

// Rays from a point to the nodes of an element.
class Rays {
public:
    Rays(const visibility::Occluders& occluders, const TransportOptions& options, bool needed)
        : occluders_(occluders), among_(options.occluders), needed_(needed) {}

    /// Sets the kernel to 0 where something stands between. @param kernel  one per node
    void mask(const SurfaceNode& x, const NodeSet& ys, std::span<double> kernel) {
        if (!needed_) return;
        for (std::size_t j = 0; j < kernel.size(); ++j) {
            if (!(kernel[j] > 0.0)) continue;
            ++cast_;
            if (!occluders_.occluded(x.sight_point(), ys.nodes[j].sight_point(), among_)) continue;
            kernel[j] = 0.0;
            ++blocked_;
        }
    }
    std::uint32_t cast() const { return cast_; }

    /// Standard deviation of the visible share as sampled [1].
    double share_error() const {
        if (cast_ == 0) return 0.0;
        const double n = cast_, blocked = blocked_ / n;
        return std::sqrt(std::max(blocked * (1.0 - blocked), 1.0 / (n + 1.0)) / n);
    }

private:
    const visibility::Occluders& occluders_;
    visibility::Among among_;
    bool needed_;
    std::uint32_t cast_ = 0, blocked_ = 0;
};

// Rays to nodes of a polygon say which share of it each outer point sees, the moments of all of it are exact: what it
// receives is right wherever the polygon is wholly visible or wholly hidden.
class SampledPolygon : public PointGather {
public:
    SampledPolygon(const ElementShape& b, const Loops3& loops, Rays& rays, double tolerance)
        : whole_(b, loops, tolerance), b_(b), rays_(rays), exact_(b.basis.size()) {}
    void gather(const SurfaceNode& x, std::span<double> values) override {
        const NodeSet& ys = b_.rules[1];
        whole_.gather(x, values);
        std::copy(values.begin(), values.end(), exact_.begin());
        kernel_.resize(ys.nodes.size());
        for (std::size_t j = 0; j < kernel_.size(); ++j) kernel_[j] = kernel_value(x, ys.nodes[j]);
        seen_ = kernel_;
        rays_.mask(x, ys, seen_);
        double all = 0.0, visible = 0.0;
        for (std::size_t j = 0; j < kernel_.size(); ++j) {
            all += kernel_[j] * ys.nodes[j].weight;
            visible += seen_[j] * ys.nodes[j].weight;
        }
        if (!(all > 0.0)) return;
        // exact * share, plus what the nodes say beyond that, scaled to the exact constant.
        const double share = visible / all;
        const double scale = values[0] / (all * ys.basis[0]);
        for (std::size_t l = 0; l < values.size(); ++l) values[l] = share * exact_[l];
        for (std::size_t j = 0; j < kernel_.size(); ++j) {
            const double weight = scale * ys.nodes[j].weight * (seen_[j] - share * kernel_[j]);
            for (std::size_t l = 0; l < values.size(); ++l)
                values[l] += weight * ys.basis[j * values.size() + l];
        }
    }

private:
    WholePolygon whole_;
    const ElementShape& b_;
    Rays& rays_;
    std::vector<double> exact_, kernel_, seen_;
};

// One pair on its way through the rules.
class PairTransport {
public:
    PairTransport(const ElementShape& a, const ElementShape& b, const visibility::Occluders& occluders,
                  const TransportOptions& options)
        : a_(a), b_(b), occluders_(occluders), options_(options) {}

    TransportBlock block() {
        block_.values.assign(a_.basis.size() * b_.basis.size(), 0.0);
        const Sight sight = look();
        if (sight == Sight::Hidden) return {};
        const bool flat = a_.planar && b_.planar;
        const auto rule = cut_by_horizon(a_, b_) ? std::nullopt : far_rule(a_, b_, options_.tolerance);
        if (!flat && !rule)
            curved(sight);
        else if (!rule || (flat && sight == Sight::Few && clipping_is_cheaper()))
            near(sight);
        else
            far(*rule, sight);
        return finished();
    }

private:
    Sight look() {
        if (!options_.occlusion || occluders_.empty()) return Sight::Clear;
        const Sight sight =
            blockers_.between(visibility::shaft_end(a_), visibility::shaft_end(b_), occluders_.polygons(),
                              options_.occluders, options_.most_blockers);
        return sight == Sight::Many ? probed() : sight;
    }

    // Behind many polygons most pairs are wholly hidden or wholly clear: a few rays that agree are believed.
    Sight probed() {
        constexpr std::size_t probes = 16, most_tries = 256; // of curved pairs few nodes may face each other
        const auto& xs = a_.rules[1].nodes;
        const auto& ys = b_.rules[1].nodes;
        const double all = static_cast<double>(xs.size() * ys.size());
        std::size_t cast = 0, hidden = 0;
        for (std::size_t k = 0; k < most_tries && cast < probes; ++k) {
            // Multiples of the golden section spread over all pairs of nodes.
            const double turns = static_cast<double>(k + 1) * (std::numbers::phi - 1.0);
            const auto pair = static_cast<std::size_t>((turns - std::floor(turns)) * all);
            const SurfaceNode& x = xs[pair / ys.size()];
            const SurfaceNode& y = ys[pair % ys.size()];
            if (!(kernel_value(x, y) > 0.0)) continue;
            ++cast;
            hidden += occluders_.occluded(x.sight_point(), y.sight_point(), options_.occluders) ? 1u : 0u;
        }
        block_.rays += static_cast<std::uint32_t>(cast);
        if (cast < probes || (hidden > 0 && hidden < cast)) return Sight::Many;
        return hidden == 0 ? Sight::Clear : Sight::Hidden;
    }

    // Sampled visibility is off by half the root of the number of rays; clipping by less than its outer rule's tolerance.
    double rays_for_sight() const { return 0.25 / (options_.sight_tolerance * options_.sight_tolerance); }

    double rays_between(std::size_t level_a, std::size_t level_b) const {
        return static_cast<double>(a_.rules[level_a].nodes.size() * b_.rules[level_b].nodes.size());
    }

    // Predicted times [us], as measured by kernel_bench.
    bool clipping_is_cheaper() const {
        if (!options_.exact_sight) return false;
        constexpr double per_ray = 0.15, per_point = 1.5, per_blocker = 0.7, points = 20.0;
        const auto blockers = static_cast<double>(blockers_.blockers().size());
        return points * (per_point + per_blocker * blockers) < per_ray * rays_for_sight();
    }

    void far(const FarRule& rule, Sight sight) {
        std::size_t level_a = rule.level_a, level_b = rule.level_b;
        while (sight != Sight::Clear && rays_between(level_a, level_b) < rays_for_sight()) {
            const bool a_next = level_a <= level_b;
            if ((a_next ? level_a : level_b) + 1 == geometry::rule_levels) break;
            ++(a_next ? level_a : level_b);
        }
        node_product(a_.rules[level_a], b_.rules[level_b], sight);
        block_.error = std::hypot(block_.error, rule.error);
    }

    // Curved elements and clusters: all of the block to the tolerance, and of it what rays between nodes find visible.
    void curved(Sight sight) {
        const double share = a_.id == b_.id ? options_.own_floor : options_.curved_floor;
        const double floor = share * std::sqrt(std::min(a_.area, b_.area) / std::max(a_.area, b_.area));
        if (sight == Sight::Clear) {
            PairIntegral whole = curved_pair(a_, b_, options_.tolerance, floor);
            block_.values = std::move(whole.values);
            block_.error = whole.error;
            return;
        }
        std::size_t level = 0;
        while (level + 1 < geometry::rule_levels && rays_between(level, level) < rays_for_sight()) ++level;
        node_product(a_.rules[level], b_.rules[level], sight);
        if (!(frobenius_norm(block_.values) > 0.0)) return;
        const double sampling = block_.error;
        std::vector<double> seen = std::move(block_.values);
        block_.values.assign(seen.size(), 0.0);
        node_product(a_.rules[level], b_.rules[level], Sight::Clear);
        constexpr double heard = 0.3; // of an error beside that of the sampled share
        weigh(curved_pair(a_, b_, std::max(options_.tolerance, heard * options_.sight_tolerance), floor),
              seen, sampling);
    }

    // The whole times the visible share of its constant, plus what nodes say beyond that, scaled to the whole. On entry
    // block_.values is what the nodes say of the whole.
    void weigh(const PairIntegral& whole, std::span<const double> seen, double sampling) {
        const double share = seen[0] / block_.values[0], scale = whole.values[0] / block_.values[0];
        for (std::size_t k = 0; k < seen.size(); ++k)
            block_.values[k] = share * whole.values[k] + scale * (seen[k] - share * block_.values[k]);
        // Nodes that weigh parts of the whole wrongly weigh what is visible of them wrongly.
        const double mixed = share * (1.0 - share) * std::abs(scale - 1.0) * frobenius_norm(whole.values);
        block_.error = std::hypot(share * whole.error, scale * sampling, mixed);
    }

    void node_product(const NodeSet& xs, const NodeSet& ys, Sight sight) {
        Rays rays(occluders_, options_, sight != Sight::Clear);
        thread_local std::vector<double> kernel;
        const std::size_t columns = ys.nodes.size();
        kernel.resize(xs.nodes.size() * columns);
        for (std::size_t i = 0; i < xs.nodes.size(); ++i) {
            const std::span<double> row(&kernel[i * columns], columns);
            for (std::size_t j = 0; j < columns; ++j) row[j] = bounded_kernel(xs.nodes[i], ys.nodes[j]);
            rays.mask(xs.nodes[i], ys, row);
        }
        add_node_product(xs, a_.basis.size(), ys, b_.basis.size(), kernel, block_.values);
        block_.rays += rays.cast();
        block_.error = rays.share_error() * frobenius_norm(block_.values);
    }

    // The inner integral is exact, the outer one samples. It runs over the smaller polygon; where something stands between,
    // over the one on which its shadow is softer: a shadow that all but touches may fall between all samples.
    bool outer_is_b(Sight sight) const {
        constexpr double equal = 1.0 + 1e-9; // rounding does not choose between elements of one size
        if (sight != Sight::Few || !options_.exact_sight) return a_.area > equal * b_.area;
        const double soft_on_a = nearest_blocker(a_) * b_.area, soft_on_b = nearest_blocker(b_) * a_.area;
        return soft_on_b > equal * soft_on_a || (soft_on_b * equal > soft_on_a && a_.area > equal * b_.area);
    }

    // Mean distance of the nearest blocker's corners from an element's plane [m].
    double nearest_blocker(const ElementShape& element) const {
        const HalfSpace front = front_of(element);
        double nearest = std::numeric_limits<double>::infinity();
        for (const visibility::PlanarBlocker& blocker : blockers_.blockers()) {
            double sum = 0.0;
            for (const Vec3& point : blocker.loops.points) sum += std::abs(front.distance(point));
            nearest = std::min(nearest, sum / static_cast<double>(blocker.loops.points.size()));
        }
        return nearest;
    }

    void near(Sight sight) {
        const bool swapped = outer_is_b(sight);
        const ElementShape& outer = swapped ? b_ : a_;
        const ElementShape& inner = swapped ? a_ : b_;
        const HalfSpace outer_front = front_of(outer), inner_front = front_of(inner);
        const double slack = horizon_slack(a_, b_);
        const Loops3 loops = cut_to_front(inner.outline, outer_front, slack);
        std::vector<OuterPiece> pieces = pieces_in_front(outer, inner_front, slack);
        if (sight == Sight::Clear)
            pieces = cut_below_edges(std::move(pieces), loops, inner_front, 2.0 * outer.radius);
        else if (sight == Sight::Few)
            pieces =
                cut_at_blockers(std::move(pieces), blockers_.blockers(), outer_front, 2.0 * outer.radius);
        if (loops.empty() || pieces.empty()) return;
        const InnerPolygon polygon{loops, inner.facets.front().corners[0], inner_front.normal};
        const double gather_tolerance = gather_share * options_.tolerance;
        OuterOptions outer_options{.tolerance = options_.tolerance,
                                   .floor = negligible * std::sqrt(outer.area / inner.area),
                                   .polygon = &polygon,
                                   .refine = false};
        OuterResult result;
        if (sight == Sight::Clear) {
            WholePolygon gather(inner, loops, gather_tolerance);
            gather.tighten(outer, inner, pieces, gather_tolerance, outer_options.floor);
            result = integrate_outer(outer, pieces, inner.basis.size(), gather, outer_options);
            result.error += gather.error(outer, inner);
        } else if (sight == Sight::Few && options_.exact_sight) {
            outer_options.tolerance = options_.sight_tolerance;
            outer_options.refine = true;
            outer_options.floor = options_.sight_floor * std::sqrt(outer.area / inner.area);
            outer_options.most_points = 60000;
            PartlyHiddenPolygon gather(inner, loops, blockers_.blockers(),
                                       gather_share * options_.sight_tolerance);
            result = integrate_outer(outer, pieces, inner.basis.size(), gather, outer_options);
        } else {
            Rays rays(occluders_, options_, true);
            outer_options.tolerance = std::max(options_.tolerance, sampled_tolerance);
            outer_options.settle = false;
            SampledPolygon gather(inner, loops, rays, gather_tolerance);
            constexpr std::size_t many_pieces = 16;
            result = pieces.size() > many_pieces
                         ? integrate_nodes(outer, inner.basis.size(), gather)
                         : integrate_outer(outer, pieces, inner.basis.size(), gather, outer_options);
            block_.rays += rays.cast();
            result.error = std::hypot(result.error, rays.share_error() * frobenius_norm(result.values));
        }
        store(result, swapped);
    }

    // Over an element of many pieces, where rays decide anyway.
    static OuterResult integrate_nodes(const ElementShape& outer, std::size_t columns, PointGather& inner) {
        const NodeSet& xs = outer.rules[1];
        const std::size_t rows = outer.basis.size();
        OuterResult result{.values = std::vector<double>(rows * columns, 0.0), .points = xs.nodes.size()};
        std::vector<double> gathered(columns);
        for (std::size_t i = 0; i < xs.nodes.size(); ++i) {
            inner.gather(xs.nodes[i], gathered);
            for (std::size_t k = 0; k < rows; ++k)
                for (std::size_t l = 0; l < columns; ++l)
                    result.values[k * columns + l] +=
                        xs.nodes[i].weight * xs.basis[i * rows + k] * gathered[l];
        }
        result.error = nodes_guess * frobenius_norm(result.values);
        return result;
    }

    void store(const OuterResult& result, bool transposed) {
        block_.error = result.error;
        const std::size_t na = a_.basis.size(), nb = b_.basis.size();
        for (std::size_t k = 0; k < na; ++k)
            for (std::size_t l = 0; l < nb; ++l)
                block_.values[k * nb + l] =
                    transposed ? result.values[l * na + k] : result.values[k * nb + l];
    }

    TransportBlock finished() {
        const double norm = frobenius_norm(block_.values);
        if (!(norm > 0.0)) return {.rays = block_.rays};
        // No block is larger than one that sends all light from the smaller element to the other, for each function: no
        // error is larger than that and what was found together.
        const double functions = std::sqrt(static_cast<double>(std::min(a_.basis.size(), b_.basis.size())));
        const double ratio = std::sqrt(std::min(a_.area, b_.area) / std::max(a_.area, b_.area));
        block_.error = std::min(block_.error, norm + (functions > 1.0 ? functions : ratio));
        return std::move(block_);
    }

    static constexpr double gather_share = 0.1;       ///< of the tolerance for the inner integrals
    static constexpr double sampled_tolerance = 1e-2; ///< finer outer quadrature would only cost rays
    static constexpr double nodes_guess = 0.1;
    static constexpr double negligible = 1e-3; ///< of the largest block that elements of such areas can have

    const ElementShape& a_;
    const ElementShape& b_;
    const visibility::Occluders& occluders_;
    const TransportOptions& options_;
    visibility::PairBlockers& blockers_ = kept<visibility::PairBlockers>();
    TransportBlock block_;
};

// Whether b has a point in front of the plane of a planar element.
bool in_front_of(const ElementShape& planar, const ElementShape& other) {
    const HalfSpace front = front_of(planar);
    const double slack = horizon_slack(planar, other);
    const double height = front.distance(other.centre);
    if (height + other.radius <= slack) return false;
    if (height - other.radius > slack) return true;
    for (const Facet& facet : other.facets)
        for (const Vec3& corner : facet.corners)
            if (front.distance(corner) > slack) return true;
    return other.surface.has_value();
}

// Whether some normal in a's cone can make an acute angle with some direction from a to b.
bool cone_reaches(const ElementShape& a, const ElementShape& b) {
    const Vec3 axis = b.centre - a.centre;
    const double distance = glm::length(axis);
    const double radii = a.radius + b.radius;
    if (distance <= radii) return true;
    const double spread = std::asin(radii / distance) + std::acos(std::clamp(a.cone_cosine, -1.0, 1.0));
    return std::acos(std::clamp(glm::dot(a.mean_normal, axis) / distance, -1.0, 1.0)) - spread <
           0.5 * std::numbers::pi;
}

} // namespace

bool may_exchange(const ElementShape& a, const ElementShape& b) {
    if (&a == &b || a.id == b.id) return !a.planar;
    if (a.planar ? !in_front_of(a, b) : !cone_reaches(a, b)) return false;
    return b.planar ? in_front_of(b, a) : cone_reaches(b, a);
}

bool cut_by_horizon(const ElementShape& a, const ElementShape& b) {
    return (a.planar && crosses_horizon(a, b)) || (b.planar && crosses_horizon(b, a)) || turns_away(a, b) ||
           turns_away(b, a);
}

TransportBlock transport(const ElementShape& a, const ElementShape& b, const visibility::Occluders& occluders,
                         const TransportOptions& options) {
    if (!may_exchange(a, b)) return {};
    if (options.integration != Integration::Automatic)
        return quasi_monte_carlo(
            a, b, occluders,
            {.samples = options.samples,
             .points = options.integration == Integration::Sobol ? Points::Sobol : Points::Random,
             .occlusion = options.occlusion,
             .occluders = options.occluders,
             .seed = options.seed});
    return PairTransport(a, b, occluders, options).block();
}

} // namespace kinelux::kernel
