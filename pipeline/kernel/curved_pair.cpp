// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/curved_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "kernel/facet_sum.h"
#include "kernel/far_pair.h"
#include "kernel/near_pair.h"
#include "kernel/outer_pieces.h"
#include "kernel/polygon_moments.h"
#include "kernel/surface_cells.h"

namespace kinelux::kernel {

namespace {

using geometry::ElementShape;
using geometry::Facet;
using geometry::NodeSet;
using geometry::SurfaceNode;
using visibility::Loops2;
using visibility::Loops3;

constexpr double inner_share = 0.2; ///< of the tolerance for the inner integrals

bool is_cluster(const ElementShape& element) { return !element.planar && !element.surface; }

double norm(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

// A flat element, of which each point sees what lies above its own horizon.
class HorizonPolygon : public PointGather {
public:
    HorizonPolygon(const ElementShape& b, double tolerance)
        : b_(b), moments_(b.facets.front(), b.basis), tolerance_(tolerance) {
        for (const auto& loop : b.outline) whole_.add(loop);
        moments_.to_plane(whole_, flat_whole_);
    }
    void gather(const SurfaceNode& x, std::span<double> values) override {
        const double height = glm::dot(x.normal, b_.centre - x.position);
        if (height >= b_.radius) {
            moments_.gather(x.position, x.normal, flat_whole_, tolerance_, values);
            return;
        }
        std::fill(values.begin(), values.end(), 0.0);
        if (height <= -b_.radius) return;
        above_.clear();
        for (std::size_t l = 0; l < whole_.size(); ++l) {
            cutter_.begin(whole_[l]);
            cutter_.keep([&](const Vec3& point) { return glm::dot(x.normal, point - x.position); });
            if (cutter_.loop().size() >= 3) above_.add(cutter_.loop());
        }
        if (above_.empty()) return;
        moments_.to_plane(above_, flat_);
        moments_.gather(x.position, x.normal, flat_, tolerance_, values);
    }

private:
    const ElementShape& b_;
    PolygonMoments moments_;
    double tolerance_;
    Loops3 whole_, above_;
    Loops2 flat_whole_, flat_;
    visibility::LoopCutter<Vec3> cutter_;
};

// Both on the same side of one sphere.
bool share_a_sphere(const ElementShape& a, const ElementShape& b) {
    constexpr double rounding = 1e-12; // of the radius
    if (!a.surface || !b.surface) return false;
    const model::Surface &s = *a.surface, &t = *b.surface;
    return s.type == model::SurfaceType::Sphere && t.type == model::SurfaceType::Sphere &&
           s.orientation * t.orientation > 0.0 && std::abs(s.radius - t.radius) <= rounding * s.radius &&
           glm::distance(s.origin, t.origin) <= rounding * (s.radius + glm::length(s.origin));
}

// On the inside only the constants have an integral other than 0; no point of the outside sees another one.
PairIntegral on_a_sphere(const ElementShape& a, const ElementShape& b) {
    PairIntegral result{std::vector<double>(a.basis.size() * b.basis.size(), 0.0)};
    const double radius = a.surface->radius;
    if (a.surface->orientation < 0.0)
        result.values[0] = std::sqrt(a.area * b.area) / (4.0 * std::numbers::pi * radius * radius);
    return result;
}

std::vector<double> node_product(const ElementShape& a, std::size_t level_a, const ElementShape& b,
                                 std::size_t level_b) {
    const NodeSet &xs = a.rules[level_a], &ys = b.rules[level_b];
    std::vector<double> kernel(xs.nodes.size() * ys.nodes.size());
    for (std::size_t i = 0, k = 0; i < xs.nodes.size(); ++i)
        for (const SurfaceNode& y : ys.nodes) kernel[k++] = bounded_kernel(xs.nodes[i], y);
    std::vector<double> values(a.basis.size() * b.basis.size(), 0.0);
    add_node_product(xs, a.basis.size(), ys, b.basis.size(), kernel, values);
    return values;
}

std::vector<double> node_product(const ElementShape& a, const ElementShape& b, std::size_t level) {
    return node_product(a, level, b, level);
}

// Different nodes on both sides, so that none meets itself; the mean of both ways round is symmetric.
std::vector<double> self_product(const ElementShape& a, std::size_t level, std::size_t other_level) {
    std::vector<double> values = node_product(a, level, a, other_level);
    const std::size_t n = a.basis.size();
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t l = 0; l < k; ++l)
            values[k * n + l] = values[l * n + k] = 0.5 * (values[k * n + l] + values[l * n + k]);
    return values;
}

// Both on one smooth surface, along which the kernel stays bounded.
bool share_a_surface(const ElementShape& a, const ElementShape& b) {
    if (!a.surface || !b.surface) return false;
    const model::Surface &s = *a.surface, &t = *b.surface;
    return s.type == t.type && s.type != model::SurfaceType::BSpline &&
           s.type != model::SurfaceType::Bilinear && s.origin == t.origin && s.axis_w == t.axis_w &&
           s.radius == t.radius && s.minor_radius == t.minor_radius && s.half_angle_rad == t.half_angle_rad &&
           s.orientation == t.orientation;
}

double difference(std::span<const double> p, std::span<const double> q) {
    double sum = 0.0;
    for (std::size_t k = 0; k < p.size(); ++k) sum += (p[k] - q[k]) * (p[k] - q[k]);
    return std::sqrt(sum);
}

// Two facets whose domains make a parallelogram, as one piece of the first.
std::optional<OuterPiece> parallelogram(std::span<const Facet> facets) {
    if (facets.size() != 2) return std::nullopt;
    const auto& p = facets[0].parameters;
    const double size = glm::distance(p[0], p[1]) + glm::distance(p[1], p[2]);
    constexpr double rounding = 1e-12;
    for (const Vec2& q : facets[1].parameters)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t next = (c + 1) % 3, last = (c + 2) % 3;
            if (glm::distance(q, p[next] + p[last] - p[c]) > rounding * size) continue;
            constexpr std::array<Vec2, 3> local{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
            return OuterPiece{&facets[0],
                              {local[c], local[next], local[next] + local[last] - local[c], local[last]}};
        }
    return std::nullopt;
}

std::vector<OuterPiece> pieces_of(const ElementShape& outer, const ElementShape& inner) {
    std::vector<OuterPiece> pieces;
    visibility::LoopCutter<Vec3> cutter;
    const auto add = [&](std::span<const Vec3> loop, const Facet& facet) {
        cutter.begin(loop);
        const Facet& plane = inner.facets.front();
        if (inner.planar)
            cutter.keep([&](const Vec3& point) { return glm::dot(plane.normal, point - plane.corners[0]); });
        if (cutter.loop().size() < 3) return;
        pieces.push_back({&facet, {}});
        for (const Vec3& point : cutter.loop()) pieces.back().corners.push_back(barycentric(facet, point));
    };
    if (outer.surface) {
        if (auto whole = parallelogram(outer.facets)) return {*std::move(whole)};
        for (const Facet& facet : outer.facets)
            pieces.push_back({&facet, {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}});
    } else if (outer.planar && outer.outline.size() == 1 &&
               visibility::is_convex(outer.outline.front(), outer.facets.front().normal, 1e-12)) {
        add(outer.outline.front(), outer.facets.front());
    } else {
        for (const Facet& facet : outer.facets) add(facet.corners, facet);
    }
    return pieces;
}

// Each triangle or quadrilateral as four.
std::vector<OuterPiece> quartered(std::span<const OuterPiece> pieces) {
    std::vector<OuterPiece> result;
    for (const auto& [facet, c] : pieces) {
        const std::size_t n = c.size();
        if (n > 4) {
            result.push_back({facet, c});
            continue;
        }
        Vec2 centre(0.0);
        for (const Vec2& corner : c) centre += corner / static_cast<double>(n);
        std::vector<Vec2> middles;
        for (std::size_t i = 0; i < n; ++i) middles.push_back(0.5 * (c[i] + c[(i + 1) % n]));
        for (std::size_t i = 0; i < n; ++i) {
            const Vec2 &after = middles[i], &before = middles[(i + n - 1) % n];
            result.push_back({facet, n == 4 ? std::vector<Vec2>{c[i], after, centre, before}
                                            : std::vector<Vec2>{c[i], after, before}});
        }
        if (n == 3) result.push_back({facet, middles});
    }
    return result;
}

// Whether a node of the other element lies behind a flat one's plane.
bool cut_by_plane(const ElementShape& flat, const ElementShape& other) {
    const Facet& facet = flat.facets.front();
    const auto& nodes = other.rules.back().nodes;
    return std::any_of(nodes.begin(), nodes.end(), [&](const SurfaceNode& node) {
        return glm::dot(facet.normal, node.position - facet.corners[0]) < 0.0;
    });
}

// Over clusters facet by facet. A flat element's horizon cuts a curved one in a line along which the integral over the
// flat one would bend, as it does along a large curved one's own horizon; the integral over the curved one is smooth
// along the flat one instead. Else the flat one has the cheaper integral, and the smaller one the fewer points.
bool second_is_outer(const ElementShape& a, const ElementShape& b) {
    constexpr double small = 0.5; // of the curved one's radius
    const auto flat_is_outer = [](const ElementShape& flat, const ElementShape& curved) {
        return flat.radius < small * curved.radius || cut_by_plane(flat, curved);
    };
    if (is_cluster(a) != is_cluster(b)) return is_cluster(b);
    if (a.planar) return !flat_is_outer(a, b);
    if (b.planar) return flat_is_outer(b, a);
    return a.radius > b.radius;
}

class CurvedPair {
public:
    CurvedPair(const ElementShape& outer, const ElementShape& inner, double tolerance, double floor)
        : outer_(outer), inner_(inner), tolerance_(tolerance), floor_(floor) {}

    OuterResult integrate() const {
        const std::vector<double> guess = node_product(outer_, inner_, 1);
        double scale = std::max(norm(guess), floor_);
        if (is_cluster(outer_) && !worth_every_facet()) return by_nodes(guess);
        if (auto settled = settled_nodes(guess)) return *std::move(settled);
        // Nodes may say too much of pairs that touch: the inner integrals are to be as exact as the block needs.
        constexpr int most_runs = 3;
        for (int run = 1;; ++run) {
            OuterResult result = integrate(scale);
            result.error = std::hypot(result.error, inner_share * tolerance_ * scale);
            const double size = std::max(norm(result.values), floor_);
            if (run == most_runs || 3.0 * size > scale) return result;
            scale = size;
        }
    }

private:
    // Where an element rises over a horizon the integrand bends, which estimates within cells may miss: fine results are
    // those that hold when the pieces are divided and the tolerance is tightened.
    OuterResult outer_integral(std::vector<OuterPiece> pieces, PointGather& gather,
                               OuterOptions options) const {
        const std::size_t columns = inner_.basis.size();
        OuterResult result = integrate_outer(outer_, pieces, columns, gather, options);
        if (tolerance_ >= believed) return result;
        constexpr int most_rounds = 4;
        for (int round = 0; round < most_rounds; ++round) {
            pieces = quartered(pieces);
            options.tolerance *= 0.1;
            OuterResult finer = integrate_outer(outer_, pieces, columns, gather, options);
            const double change = difference(finer.values, result.values);
            const bool settled = change <= 0.5 * tolerance_ * std::max(norm(finer.values), floor_);
            result = std::move(finer);
            result.error = std::max(result.error, change);
            if (settled) break;
        }
        return result;
    }

    static constexpr double believed = 1e-3; ///< tolerance from which on one outer integral is believed
    static constexpr double coarse = 1e-2;   ///< tolerance from which on blocks should be cheap

    // Limits of a few milliseconds, and of a tenth of that.
    bool worth_every_facet() const {
        constexpr std::size_t coarse_facets = 1u << 14u, fine_facets = 1u << 16u;
        const std::size_t per_point = is_cluster(inner_) ? inner_.facets.size() : inner_.surface ? 128 : 64;
        return outer_.facets.size() * per_point <= (tolerance_ >= coarse ? coarse_facets : fine_facets);
    }

    // Where elements lie well apart, or on one smooth surface, and more nodes change little, they do.
    std::optional<OuterResult> settled_nodes(const std::vector<double>& guess) const {
        constexpr double safety = 2.0;
        const bool apart = glm::distance(outer_.centre, inner_.centre) > outer_.radius + inner_.radius;
        if (is_cluster(outer_) || is_cluster(inner_) || tolerance_ < believed ||
            !(apart || share_a_surface(outer_, inner_)))
            return std::nullopt;
        const bool itself = outer_.id == inner_.id;
        std::vector<double> values = itself ? self_product(outer_, 2, 1) : node_product(outer_, inner_, 2);
        const double change = difference(values, itself ? self_product(outer_, 1, 0) : guess);
        if (safety * change > tolerance_ * std::max(norm(values), floor_)) return std::nullopt;
        return OuterResult{std::move(values), change};
    }

    // Their error is at most what fewer nodes are off from more.
    OuterResult by_nodes(const std::vector<double>& guess) const {
        if (tolerance_ >= coarse) return {guess, difference(guess, node_product(outer_, inner_, 0))};
        std::vector<double> values = node_product(outer_, inner_, 2);
        const double error = difference(values, guess);
        return {std::move(values), error};
    }

    OuterResult integrate(double scale) const {
        const double accuracy = inner_share * tolerance_ * scale / std::sqrt(outer_.area);
        const std::unique_ptr<PointGather> gather = gather_over(accuracy);
        const auto pieces = pieces_of(outer_, inner_);
        const std::size_t columns = inner_.basis.size();
        if (pieces.empty()) return {std::vector<double>(outer_.basis.size() * columns, 0.0)};
        OuterOptions options{.tolerance = tolerance_, .floor = floor_, .most_points = most_points()};
        if (!is_cluster(outer_)) return outer_integral(pieces, *gather, options);
        options.most_points = 8 * pieces.size() + 400;
        return integrate_facets(outer_, pieces, inner_, *gather, options);
    }

    // Surfaces that cross leave a jump along a line on the outer one: the estimate says what is left of it at the limit.
    std::size_t most_points() const {
        constexpr double points_at_coarse = 1200.0, most = 20000.0;
        return static_cast<std::size_t>(std::min(points_at_coarse * std::sqrt(coarse / tolerance_), most));
    }

    std::unique_ptr<PointGather> gather_over(double accuracy) const {
        if (inner_.planar) return std::make_unique<HorizonPolygon>(inner_, 0.1 * tolerance_);
        if (!inner_.surface) return std::make_unique<FacetSum>(inner_, accuracy);
        const bool itself = &outer_ == &inner_ || outer_.id == inner_.id;
        return std::make_unique<SurfaceCells>(
            inner_, accuracy, itself ? SurfaceCells::Points::OnTheSurface : SurfaceCells::Points::Anywhere);
    }

    const ElementShape& outer_;
    const ElementShape& inner_;
    double tolerance_, floor_;
};

} // namespace

PairIntegral curved_pair(const ElementShape& a, const ElementShape& b, double tolerance, double floor) {
    if (share_a_sphere(a, b)) return on_a_sphere(a, b);
    const bool swapped = second_is_outer(a, b);
    OuterResult found = swapped ? CurvedPair(b, a, tolerance, floor).integrate()
                                : CurvedPair(a, b, tolerance, floor).integrate();
    if (!swapped) return {std::move(found.values), found.error};
    const std::size_t na = a.basis.size(), nb = b.basis.size();
    PairIntegral result{std::vector<double>(na * nb), found.error};
    for (std::size_t k = 0; k < na; ++k)
        for (std::size_t l = 0; l < nb; ++l) result.values[k * nb + l] = found.values[l * na + k];
    return result;
}

} // namespace kinelux::kernel
