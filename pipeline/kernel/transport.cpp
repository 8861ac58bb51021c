// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/transport.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/sequence.h"
#include "geometry/quadrature.h"
#include "kernel/polygon_irradiance.h"

namespace kinelux::kernel {

namespace {

using geometry::ElementShape;
using geometry::Facet;
using geometry::NodeSet;
using geometry::SurfaceNode;

// eta = distance / size of the larger element. A pair is far from `far_eta` on for the coarse nodes, from `near_eta` on
// for the fine nodes; below it is integrated adaptively. The errors are those of blocks relative to their size, the
// a-priori part of TransportBlock::error: for tolerances from 1e-3 on the worst, rounded up, of 770 random pairs of
// squares at degree 2 against the finest rule here; those of the finest rule itself are guesses, a tenth of the next.
struct RuleLimits {
    double far_eta, near_eta;
    double node_error, near_error;
};

RuleLimits limits_for(double tolerance) {
    if (tolerance >= 1e-2) return {1.0, 0.3, 1.6e-2, 7.5e-2};
    if (tolerance >= 1e-3) return {2.0, 0.5, 1e-3, 1.3e-2};
    return {4.0, 1.0, 1e-4, 1.3e-3};
}

// A pair that crosses the horizon of one of its elements has a kink in its integrand that no rule here follows. At a
// tolerance of 1e-3 nine of ten of 825 such random pairs were off by less than this; a few small blocks by far more.
constexpr double horizon_error = 0.2;

double kernel_value(const SurfaceNode& x, const SurfaceNode& y) {
    const Vec3 r = y.position - x.position;
    const double cos_x = glm::dot(x.normal, r), cos_y = -glm::dot(y.normal, r);
    if (!(cos_x > 0.0) || !(cos_y > 0.0)) return 0.0;
    const double r2 = glm::dot(r, r);
    return cos_x * cos_y / (std::numbers::pi * r2 * r2);
}

double box_distance(const ElementShape& a, const ElementShape& b) {
    const Vec3 gap = glm::max(Vec3(0.0), glm::max(a.box_low - b.box_high, b.box_low - a.box_high));
    const double spheres = glm::distance(a.centre, b.centre) - a.radius - b.radius;
    return std::max(glm::length(gap), spheres);
}

// Which share of a pair sees each other.
enum class Sight : std::uint8_t { Clear, Partial, Hidden };

class PairSight {
public:
    PairSight(const ElementShape& a, const ElementShape& b, const visibility::Occluders& occluders,
              const TransportOptions& options)
        : occluders_(occluders), among_(options.occluders) {
        if (options.occlusion && !occluders.empty()) probe(a, b, options);
    }

    Sight sight() const { return sight_; }
    std::uint32_t rays() const { return rays_; }
    double visible_share() const { return visible_share_; }

    /// 1 or 0 where the pair is partly hidden, always 1 where it is clear.
    bool visible(const Vec3& x, const Vec3& y) {
        if (sight_ == Sight::Clear) return true;
        ++rays_;
        return !occluders_.occluded(x, y, among_);
    }

    /// Rays to all pairs of facing nodes at once. @param kernel  a.size x b.size; set to 0 where hidden
    void mask(std::span<const SurfaceNode> a, std::span<const SurfaceNode> b, std::span<double> kernel) {
        if (sight_ == Sight::Clear) return;
        thread_local std::vector<visibility::Segment> segments;
        thread_local std::vector<std::size_t> indices;
        thread_local std::vector<std::uint8_t> blocked;
        segments.clear();
        indices.clear();
        for (std::size_t k = 0; k < kernel.size(); ++k)
            if (kernel[k] > 0.0) {
                segments.push_back({a[k / b.size()].position, b[k % b.size()].position});
                indices.push_back(k);
            }
        blocked.assign(segments.size(), 0);
        occluders_.occluded(segments, blocked, among_);
        rays_ += static_cast<std::uint32_t>(segments.size());
        for (std::size_t s = 0; s < segments.size(); ++s)
            if (blocked[s] != 0) kernel[indices[s]] = 0.0;
    }

private:
    // Probes run between nodes of the two elements that face each other, paired by a scrambled sequence so that both
    // elements are covered evenly. Only where they disagree are visibility rays spent at every node pair.
    void probe(const ElementShape& a, const ElementShape& b, const TransportOptions& options) {
        const auto& xs = a.rules[1].nodes;
        const auto& ys = b.rules[1].nodes;
        const std::uint64_t seed = core::mix(options.seed, core::mix(a.id.value, b.id.value));
        std::vector<visibility::Segment> segments;
        const int attempts = 2 * options.probe_rays;
        for (int k = 0; k < attempts && static_cast<int>(segments.size()) < options.probe_rays; ++k) {
            const Vec2 s = core::sobol_2d(static_cast<std::uint32_t>(k), seed);
            const SurfaceNode& x = xs[static_cast<std::size_t>(s.x * static_cast<double>(xs.size()))];
            const SurfaceNode& y = ys[static_cast<std::size_t>(s.y * static_cast<double>(ys.size()))];
            if (kernel_value(x, y) > 0.0) segments.push_back({x.position, y.position});
        }
        std::vector<std::uint8_t> blocked(segments.size());
        occluders_.occluded(segments, blocked, among_);
        rays_ += static_cast<std::uint32_t>(segments.size());
        const auto hidden =
            static_cast<std::size_t>(std::count(blocked.begin(), blocked.end(), std::uint8_t{1}));
        if (segments.empty() || (hidden > 0 && hidden < segments.size()))
            sight_ = Sight::Partial;
        else
            sight_ = hidden == 0 ? Sight::Clear : Sight::Hidden;
        if (!segments.empty())
            visible_share_ = 1.0 - static_cast<double>(hidden) / static_cast<double>(segments.size());
    }

    const visibility::Occluders& occluders_;
    visibility::Among among_;
    Sight sight_ = Sight::Clear;
    double visible_share_ = 1.0;
    std::uint32_t rays_ = 0;
};

// values(k,l) = sum over node pairs of w_x phi_k(x) K(x,y) w_y phi_l(y).
void add_node_product(const ElementShape& a, const NodeSet& xs, const ElementShape& b, const NodeSet& ys,
                      PairSight& sight, std::vector<double>& values) {
    const std::size_t na = a.basis.size(), nb = b.basis.size();
    const std::size_t rows = xs.nodes.size(), columns = ys.nodes.size();
    thread_local std::vector<double> kernel;
    kernel.resize(rows * columns);
    for (std::size_t i = 0; i < rows; ++i)
        for (std::size_t j = 0; j < columns; ++j)
            kernel[i * columns + j] = kernel_value(xs.nodes[i], ys.nodes[j]);
    sight.mask(xs.nodes, ys.nodes, kernel);

    std::array<double, geometry::basis_size(geometry::max_degree)> gathered;
    for (std::size_t i = 0; i < rows; ++i) {
        std::fill_n(gathered.begin(), nb, 0.0);
        for (std::size_t j = 0; j < columns; ++j) {
            const double weight = kernel[i * columns + j] * ys.nodes[j].weight;
            if (weight > 0.0)
                for (std::size_t l = 0; l < nb; ++l) gathered[l] += weight * ys.basis[j * nb + l];
        }
        for (std::size_t k = 0; k < na; ++k)
            for (std::size_t l = 0; l < nb; ++l)
                values[k * nb + l] += xs.nodes[i].weight * xs.basis[i * na + k] * gathered[l];
    }
}

double longest_edge(const Facet& facet) {
    return std::max({glm::distance(facet.corners[0], facet.corners[1]),
                     glm::distance(facet.corners[1], facet.corners[2]),
                     glm::distance(facet.corners[2], facet.corners[0])});
}

std::array<Facet, 4> split(const Facet& facet) {
    const auto& p = facet.corners;
    const auto& q = facet.parameters;
    const std::array<Vec3, 3> mp{0.5 * (p[0] + p[1]), 0.5 * (p[1] + p[2]), 0.5 * (p[2] + p[0])};
    const std::array<Vec2, 3> mq{0.5 * (q[0] + q[1]), 0.5 * (q[1] + q[2]), 0.5 * (q[2] + q[0])};
    const double quarter = 0.25 * facet.area;
    return {Facet{{p[0], mp[0], mp[2]}, {q[0], mq[0], mq[2]}, facet.normal, quarter},
            Facet{{mp[0], p[1], mp[1]}, {mq[0], q[1], mq[1]}, facet.normal, quarter},
            Facet{{mp[2], mp[1], p[2]}, {mq[2], mq[1], q[2]}, facet.normal, quarter},
            Facet{{mp[0], mp[1], mp[2]}, {mq[0], mq[1], mq[2]}, facet.normal, quarter}};
}

// A facet as part of the tree by which the inner integral refines: halves of halves, made when first visited, with the
// nodes and basis values that every outer point uses again.
struct Part {
    Facet facet;
    Vec3 centroid;
    double edge;
    std::size_t first_child = 0; ///< 0: not split yet
    NodeSet nodes;               ///< empty: not visited yet
};

// How far refinement goes for a tolerance: parts of an element's diameter, and degrees of the rules.
struct NearLimits {
    double outer_parts, inner_parts;
    int outer_degree, inner_degree;
};

NearLimits near_limits_for(double tolerance) {
    if (tolerance >= 1e-2) return {2.0, 4.0, 4, 2};
    if (tolerance >= 1e-3) return {4.0, 8.0, 4, 4};
    return {8.0, 16.0, 8, 5};
}

// Transport between elements that are close to each other or touch: the outer integral over facets of a, refined
// towards b; the inner one over facets of b, refined towards the outer point, with the exact configuration factor where
// refinement stops. So the constant term is exact in the inner integral, and no singular integrand is ever sampled.
class NearPair {
public:
    NearPair(const ElementShape& a, const ElementShape& b, const TransportOptions& options, PairSight& sight)
        : a_(a),
          b_(b),
          sight_(sight),
          limits_(near_limits_for(tolerance_for(options, sight))),
          gathered_(b.basis.size()),
          outer_phi_(a.basis.size()) {
        for (const Facet& facet : b.facets) parts_.push_back(make_part(facet));
    }

    void add_to(std::vector<double>& values) {
        for (const Facet& facet : a_.facets) outer(facet, values);
    }

private:
    // Where rays decide, their sampling error is the larger one: a finer quadrature would only cost rays.
    static double tolerance_for(const TransportOptions& options, const PairSight& sight) {
        return sight.sight() == Sight::Partial ? std::max(options.tolerance, partial_tolerance)
                                               : options.tolerance;
    }

    static constexpr double partial_tolerance = 1e-2;
    static constexpr double outer_ratio = 1.0; ///< largest edge / distance without refinement
    static constexpr double inner_ratio = 0.7;
    static constexpr std::size_t most_nodes = 7; ///< of the inner rules, of degree 5 or less
    static constexpr double point_ratio = 0.1;   ///< below it one node is enough

    static Part make_part(const Facet& facet) {
        return {facet,
                (facet.corners[0] + facet.corners[1] + facet.corners[2]) / 3.0,
                longest_edge(facet),
                0,
                {}};
    }

    void outer(const Facet& facet, std::vector<double>& values) {
        const Vec3 centroid = (facet.corners[0] + facet.corners[1] + facet.corners[2]) / 3.0;
        const double edge = longest_edge(facet);
        const Vec3 gap = glm::max(Vec3(0.0), glm::max(b_.box_low - centroid, centroid - b_.box_high));
        const double distance = std::max(glm::length(gap) - 0.667 * edge, 0.0);
        if (edge > outer_ratio * distance && edge * limits_.outer_parts > 2.0 * a_.radius) {
            for (const Facet& part : split(facet)) outer(part, values);
            return;
        }
        const std::size_t facets = b_.facets.size();
        for (const geometry::TriangleNode& node :
             geometry::triangle_rule(edge < point_ratio * distance ? 1 : limits_.outer_degree)) {
            Vec3 x(0.0);
            Vec2 parameter(0.0);
            for (std::size_t c = 0; c < 3; ++c) {
                x += node.barycentric[c] * facet.corners[c];
                parameter += node.barycentric[c] * facet.parameters[c];
            }
            std::fill(gathered_.begin(), gathered_.end(), 0.0);
            for (std::size_t part = 0; part < facets; ++part) inner({x, facet.normal, 0.0}, part);
            a_.basis.evaluate(parameter, outer_phi_);
            for (std::size_t k = 0; k < outer_phi_.size(); ++k)
                for (std::size_t l = 0; l < gathered_.size(); ++l)
                    values[k * gathered_.size() + l] +=
                        node.weight * facet.area * outer_phi_[k] * gathered_[l];
        }
    }

    // Adds the integral over a part of b of K(x, y) V phi(y) to gathered_.
    void inner(const SurfaceNode& x, std::size_t index) {
        const Facet& facet = parts_[index].facet;
        const double height = glm::dot(facet.normal, x.position - facet.corners[0]);
        if (height <= 0.0) return;
        if (std::all_of(facet.corners.begin(), facet.corners.end(),
                        [&](const Vec3& corner) { return glm::dot(x.normal, corner - x.position) <= 0.0; }))
            return;
        const double edge = parts_[index].edge;
        const double distance =
            std::max(height, glm::distance(x.position, parts_[index].centroid) - 0.667 * edge);
        if (edge < inner_ratio * distance) {
            add_nodes(x, index);
        } else if (edge * limits_.inner_parts <= 2.0 * b_.radius) {
            add_closed_form(x, index);
        } else {
            if (parts_[index].first_child == 0) split_part(index);
            for (std::size_t child = 0; child < 4; ++child) inner(x, parts_[index].first_child + child);
        }
    }

    void split_part(std::size_t index) {
        const std::array<Facet, 4> children = split(parts_[index].facet);
        parts_[index].first_child = parts_.size();
        for (const Facet& child : children) parts_.push_back(make_part(child));
    }

    void add_nodes(const SurfaceNode& x, std::size_t index) {
        NodeSet& set = parts_[index].nodes;
        if (set.nodes.empty()) set = nodes_of(parts_[index].facet);
        const std::size_t n = gathered_.size();
        for (std::size_t i = 0; i < set.nodes.size(); ++i) {
            const double value = kernel_value(x, set.nodes[i]) * set.nodes[i].weight;
            if (value > 0.0 && sight_.visible(x.position, set.nodes[i].position))
                for (std::size_t l = 0; l < n; ++l) gathered_[l] += value * set.basis[i * n + l];
        }
    }

    NodeSet nodes_of(const Facet& facet) const {
        NodeSet set;
        const auto rule =
            geometry::triangle_rule(longest_edge(facet) < point_ratio * b_.radius ? 1 : limits_.inner_degree);
        set.basis.resize(rule.size() * gathered_.size());
        for (std::size_t i = 0; i < rule.size(); ++i) {
            SurfaceNode y{Vec3(0.0), facet.normal, rule[i].weight * facet.area};
            Vec2 parameter(0.0);
            for (std::size_t c = 0; c < 3; ++c) {
                y.position += rule[i].barycentric[c] * facet.corners[c];
                parameter += rule[i].barycentric[c] * facet.parameters[c];
            }
            set.nodes.push_back(y);
            b_.basis.evaluate(parameter,
                              std::span(set.basis).subspan(i * gathered_.size(), gathered_.size()));
        }
        return set;
    }

    // The exact factor of the part, spread over its nodes in proportion to the kernel there: exact for the constant, and
    // for the rest as good as the mean of the basis under the kernel's shape.
    void add_closed_form(const SurfaceNode& x, std::size_t index) {
        Part& part = parts_[index];
        const double factor = point_to_polygon(x.position, x.normal, part.facet.corners);
        if (!(factor > 0.0) || !sight_.visible(x.position, part.centroid)) return;
        if (part.nodes.nodes.empty()) part.nodes = nodes_of(part.facet);
        const NodeSet& set = part.nodes;
        const std::size_t n = gathered_.size();
        std::array<double, most_nodes> shares;
        double sum = 0.0;
        for (std::size_t i = 0; i < set.nodes.size(); ++i)
            sum += shares[i] = kernel_value(x, set.nodes[i]) * set.nodes[i].weight;
        for (std::size_t i = 0; i < set.nodes.size(); ++i) {
            const double share =
                factor * (sum > 0.0 ? shares[i] / sum : set.nodes[i].weight / part.facet.area);
            for (std::size_t l = 0; l < n; ++l) gathered_[l] += share * set.basis[i * n + l];
        }
    }

    const ElementShape& a_;
    const ElementShape& b_;
    PairSight& sight_;
    NearLimits limits_;
    std::vector<Part> parts_;
    std::vector<double> gathered_, outer_phi_;
};

double frobenius_norm(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

// Whether b has a point in front of the plane of a planar element.
bool in_front_of(const ElementShape& planar, const ElementShape& other) {
    const Vec3& origin = planar.facets.front().corners[0];
    const double height = glm::dot(planar.mean_normal, other.centre - origin);
    const double margin = 1e-9 * (planar.radius + other.radius);
    if (height + other.radius <= margin) return false;
    if (height - other.radius > margin) return true;
    for (const Facet& facet : other.facets)
        for (const Vec3& corner : facet.corners)
            if (glm::dot(planar.mean_normal, corner - origin) > margin) return true;
    return false;
}

// Whether the plane of a planar element cuts the other one.
bool crosses_horizon(const ElementShape& planar, const ElementShape& other) {
    if (!planar.planar) return false;
    const Vec3& origin = planar.facets.front().corners[0];
    const double margin = 1e-3 * other.radius; // less than this share beyond the horizon does not count
    if (std::abs(glm::dot(planar.mean_normal, other.centre - origin)) > other.radius + margin) return false;
    bool above = false, below = false;
    for (const Facet& facet : other.facets)
        for (const Vec3& corner : facet.corners) {
            const double height = glm::dot(planar.mean_normal, corner - origin);
            above = above || height > margin;
            below = below || height < -margin;
        }
    return above && below;
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

TransportBlock transport(const ElementShape& a, const ElementShape& b, const visibility::Occluders& occluders,
                         const TransportOptions& options) {
    TransportBlock block;
    if (!may_exchange(a, b)) return block;
    PairSight sight(a, b, occluders, options);
    block.rays = sight.rays();
    if (sight.sight() == Sight::Hidden) return block;

    const RuleLimits limits = limits_for(options.tolerance);
    const double eta = box_distance(a, b) / (2.0 * std::max(a.radius, b.radius));
    const std::size_t na = a.basis.size(), nb = b.basis.size();
    block.values.assign(na * nb, 0.0);
    double rule_error = limits.near_error;
    if (eta >= limits.far_eta) {
        add_node_product(a, a.rules[0], b, b.rules[0], sight, block.values);
        rule_error = limits.node_error;
    } else if (eta >= limits.near_eta) {
        add_node_product(a, a.rules[1], b, b.rules[1], sight, block.values);
        rule_error = limits.node_error;
    } else if (a.radius <= b.radius) {
        NearPair(a, b, options, sight).add_to(block.values);
    } else {
        std::vector<double> transposed(na * nb, 0.0);
        NearPair(b, a, options, sight).add_to(transposed);
        for (std::size_t k = 0; k < na; ++k)
            for (std::size_t l = 0; l < nb; ++l) block.values[k * nb + l] = transposed[l * na + k];
    }
    block.rays = sight.rays();
    if (crosses_horizon(a, b) || crosses_horizon(b, a)) rule_error = horizon_error;

    const double size = frobenius_norm(block.values);
    if (!(size > 0.0)) {
        block.values.clear();
        return block;
    }
    // The share that V cuts off is sampled by the rays between all nodes of the rule used.
    const double samples = static_cast<double>(std::max(1u, sight.rays()));
    const double share = sight.visible_share();
    const double sight_error =
        sight.sight() == Sight::Partial ? std::sqrt(std::max(share * (1.0 - share), 0.05) / samples) : 0.0;
    block.error = size * std::hypot(rule_error, sight_error);
    return block;
}

} // namespace kinelux::kernel
