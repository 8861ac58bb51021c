// SPDX-License-Identifier: GPL-3.0-or-later
// Key: A, B nodes; G = integral integral psi_k K V phi_l the block; u = 1/sqrt(area) the constant function;
// residual = what (K V)(., phi_l) has outside the basis of A, squared and integrated over A.
#include "coefficients/links.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/parallel.h"
#include "model/hierarchy.h"

namespace kinelux::coefficients {

namespace {

using geometry::SurfaceNode;
using model::ElementPair;

// Closer groups, by the distance of their balls over the diameter of the larger one, are always divided: products of
// rules of degree 2 are then off by more than a tenth.
constexpr double least_eta = 0.5;

// Error of a product of two rules of degree 2 relative to the block, at eta = 1; it falls with eta^2.
constexpr double product_error = 0.02;

// Share of the product of norms that two functions outside a group's basis, kernel and radiosity, have as their inner
// product, squared: they are not alike.
constexpr double likeness = 0.25;

// Share of the residuals at a node that have the same sign, whoever sends the light: where an edge of a shadow crosses a
// group, all that arrives there is smeared across it.
constexpr double coherence = 0.3;

// Each round's limit of a single link's squared error, relative to the round before.
constexpr double round_factor = 0.25;

// The first links, from which the light is estimated, may be so much coarser.
constexpr double coarse = 4.0;

// Squared norms of what a constant, and what all linear functions of the other node send outside a node's basis [1].
struct Residuals {
    double of_constant = 0.0, of_others = 0.0;
};

struct Link {
    ElementPair nodes;
    double common = 0.0;            ///< squared error of one number of the block [1]
    Residuals outside_i, outside_j; ///< what the kernel has outside the basis of i, of j
    float block_error = 0.0f;       ///< Frobenius norm
    std::uint32_t rays = 0;
    std::vector<float> values; ///< empty: hidden
};

// The integral over a node of its squared radiosity: of its mean, of its linear part, of the rest.
struct Power {
    double constant = 0.0, linear = 0.0, rest = 0.0;
};

// Squared L2 error of irradiance at one node of a link: noise that differs from link to link, and what is smeared.
struct Brought {
    double noise = 0.0, smeared = 0.0;
};

enum class Outcome : std::uint8_t { Nothing, Linked, Divide, Near };

struct Examined {
    Outcome outcome = Outcome::Nothing;
    Link link;
};

// Kernel and visibility of all pairs of nodes of two rules.
struct Samples {
    std::vector<double> kernel; ///< with visibility [1/m2], rows of A
    double unoccluded = 0.0;    ///< the block's constant part without visibility
    double facing_bound = 0.0;  ///< the same with the cosines' absolute values
    std::uint32_t rays = 0, hidden = 0;
};

// The largest n . (y - x) over normals n of a's cone, x in a, y in b.
double highest_above(const TreeNode& a, const TreeNode& b) {
    double reach = 0.0; // over the boxes, for the cone's axis
    for (int axis = 0; axis < 3; ++axis) {
        const double n = a.mean_normal[axis];
        reach +=
            n > 0.0 ? n * (b.box_high[axis] - a.box_low[axis]) : n * (b.box_low[axis] - a.box_high[axis]);
    }
    const double spread = std::sqrt(std::max(0.0, 2.0 - 2.0 * a.cone_cosine)); // of a normal from the axis
    return reach + spread * (glm::distance(a.centre, b.centre) + a.radius + b.radius);
}

bool faces_away(const TreeNode& a, const TreeNode& b) {
    constexpr double rounding = 1e-9;
    const double size = a.radius + b.radius + glm::distance(a.centre, b.centre);
    return highest_above(a, b) <= rounding * size || highest_above(b, a) <= rounding * size;
}

// Whether a ball can touch a segment between two nodes, by the hull of their balls and their common box.
bool may_enter(const Ball& ball, const TreeNode& a, const TreeNode& b) {
    const Vec3 axis = b.centre - a.centre;
    const double length2 = glm::dot(axis, axis);
    const double t =
        length2 > 0.0 ? std::clamp(glm::dot(ball.centre - a.centre, axis) / length2, 0.0, 1.0) : 0.0;
    if (glm::distance(ball.centre, a.centre + t * axis) > ball.radius + std::max(a.radius, b.radius))
        return false;
    const Vec3 low = glm::min(a.box_low, b.box_low) - ball.radius;
    const Vec3 high = glm::max(a.box_high, b.box_high) + ball.radius;
    return glm::all(glm::lessThanEqual(low, ball.centre)) && glm::all(glm::lessThanEqual(ball.centre, high));
}

double eta_of(const TreeNode& a, const TreeNode& b) {
    const Vec3 gap = glm::max(Vec3(0.0), glm::max(a.box_low - b.box_high, b.box_low - a.box_high));
    const double balls = glm::distance(a.centre, b.centre) - a.radius - b.radius;
    return std::max(glm::length(gap), balls) / (2.0 * std::max(a.radius, b.radius));
}

class Linker {
public:
    Linker(const ElementTree& tree, std::span<const geometry::ElementShape> elements,
           const LightEstimate& light, const visibility::Occluders& occluders,
           const kernel::TransportOptions& options, const LinkOptions& link_options)
        : tree_(tree),
          elements_(elements),
          light_(light),
          occluders_(occluders),
          options_(options),
          link_options_(link_options) {}

    LinkedPairs run();

private:
    void examine_all(std::vector<ElementPair> pairs, double limit);
    Examined examine(ElementPair pair, double limit) const;
    void append_children(ElementPair pair, std::vector<ElementPair>& pairs) const;
    Samples sample(const TreeNode& a, const TreeNode& b) const;
    void cast_rays(const TreeNode& a, const TreeNode& b, Samples& samples) const;
    Link link_of(ElementPair pair) const;
    void weigh_with(const LightEstimate& light);
    std::array<Brought, 2> brought_by(const Link& link) const;
    double error2(const Link& link) const;
    void add_up_smeared();
    double total_error2() const;
    void refine(double tolerance);
    LinkedPairs result() const;

    const ElementTree& tree_;
    std::span<const geometry::ElementShape> elements_;
    const LightEstimate& light_;
    const visibility::Occluders& occluders_;
    const kernel::TransportOptions& options_;
    const LinkOptions& link_options_;
    std::vector<Power> power_;      ///< per node
    std::vector<double> smeared_;   ///< per node, of the links before this round
    double irradiance_power_ = 0.0; ///< integral of the squared irradiance over all elements of the tree
    std::vector<Link> links_;
    std::vector<ElementPair> near_;
    double rays_ = 0.0;
};

// w K |cos| cos at every pair of nodes.
Samples Linker::sample(const TreeNode& a, const TreeNode& b) const {
    Samples samples;
    samples.kernel.reserve(a.rule.nodes.size() * b.rule.nodes.size());
    for (const SurfaceNode& x : a.rule.nodes)
        for (const SurfaceNode& y : b.rule.nodes) {
            const Vec3 r = y.position - x.position;
            const double cos_x = glm::dot(x.normal, r), cos_y = -glm::dot(y.normal, r), r2 = glm::dot(r, r);
            const double value = std::abs(cos_x * cos_y) / (std::numbers::pi * r2 * r2);
            const bool facing = cos_x > 0.0 && cos_y > 0.0;
            samples.kernel.push_back(facing ? value : 0.0);
            samples.facing_bound += x.weight * y.weight * value;
            if (facing) samples.unoccluded += x.weight * y.weight * value;
        }
    const double constants = std::sqrt(a.area * b.area);
    samples.facing_bound /= constants;
    samples.unoccluded /= constants;
    if (options_.occlusion && !occluders_.empty()) cast_rays(a, b, samples);
    return samples;
}

void Linker::cast_rays(const TreeNode& a, const TreeNode& b, Samples& samples) const {
    thread_local std::vector<visibility::Segment> segments;
    thread_local std::vector<std::uint8_t> blocked;
    segments.clear();
    const std::size_t columns = b.rule.nodes.size();
    for (std::size_t k = 0; k < samples.kernel.size(); ++k)
        if (samples.kernel[k] > 0.0)
            segments.push_back(
                {a.rule.nodes[k / columns].sight_point(), b.rule.nodes[k % columns].sight_point()});
    blocked.assign(segments.size(), 0);
    occluders_.occluded(segments, blocked, visibility::Among::Resting);
    samples.rays = static_cast<std::uint32_t>(segments.size());
    std::size_t s = 0;
    for (double& value : samples.kernel)
        if (value > 0.0 && blocked[s++] != 0) {
            value = 0.0;
            ++samples.hidden;
        }
}

// The block of one link and, per function of B, the squared residual outside the basis of A.
struct Projection {
    std::vector<double> block; ///< size(a) x size(b)
    Residuals outside;
};

Projection project(const TreeNode& a, const TreeNode& b, std::span<const double> kernel, std::size_t row_step,
                   std::size_t column_step) {
    const std::size_t na = a.basis_size, nb = b.basis_size;
    Projection result;
    result.block.assign(na * nb, 0.0);
    std::array<double, geometry::basis_size(geometry::max_degree)> sent, norm{};
    for (std::size_t i = 0; i < a.rule.nodes.size(); ++i) {
        std::fill_n(sent.begin(), nb, 0.0);
        for (std::size_t j = 0; j < b.rule.nodes.size(); ++j) {
            const double value = kernel[i * row_step + j * column_step] * b.rule.nodes[j].weight;
            for (std::size_t l = 0; l < nb; ++l) sent[l] += value * b.rule.basis[j * nb + l];
        }
        const double weight = a.rule.nodes[i].weight;
        for (std::size_t l = 0; l < nb; ++l) {
            norm[l] += weight * sent[l] * sent[l];
            for (std::size_t k = 0; k < na; ++k)
                result.block[k * nb + l] += weight * a.rule.basis[i * na + k] * sent[l];
        }
    }
    for (std::size_t l = 0; l < nb; ++l) {
        for (std::size_t k = 0; k < na; ++k) norm[l] -= result.block[k * nb + l] * result.block[k * nb + l];
        (l == 0 ? result.outside.of_constant : result.outside.of_others) += std::max(0.0, norm[l]);
    }
    return result;
}

Link Linker::link_of(ElementPair pair) const {
    const TreeNode &a = tree_.nodes[pair.i], &b = tree_.nodes[pair.j];
    const Samples samples = sample(a, b);
    const std::size_t columns = b.rule.nodes.size();
    const Projection onto_a = project(a, b, samples.kernel, columns, 1);
    const Projection onto_b = project(b, a, samples.kernel, 1, columns);

    // The visible share is known from so many rays: the variance of Laplace's rule of succession, which is not 0 where
    // all rays agree. A pair of which no nodes face each other counts as unknown too.
    const double rays = samples.rays, hidden = samples.hidden;
    const double share = (hidden + 1.0) / (rays + 2.0);
    const double facing = samples.unoccluded > 0.0 ? samples.unoccluded : samples.facing_bound;
    const bool certain = samples.unoccluded > 0.0 && samples.rays == 0;
    const double sight = certain ? 0.0 : share * (1.0 - share) / (rays + 3.0) * facing * facing;
    const double eta = eta_of(a, b);
    const double product = product_error * samples.unoccluded / (eta * eta);
    const double common = sight + product * product;

    // What a group's basis drops is an error; what an element's drops, blocks of elements would drop too.
    Link link{.nodes = pair, .common = common};
    if (!a.is_element()) link.outside_i = onto_a.outside;
    if (!b.is_element()) link.outside_j = onto_b.outside;
    link.rays = samples.rays;
    const double outside = std::max(link.outside_i.of_constant, link.outside_j.of_constant);
    const auto numbers = static_cast<double>(a.basis_size * b.basis_size);
    link.block_error = static_cast<float>(std::sqrt(numbers * common + outside));
    if (onto_a.block[0] > 0.0) link.values.assign(onto_a.block.begin(), onto_a.block.end());
    return link;
}

Examined Linker::examine(ElementPair pair, double limit) const {
    const TreeNode &a = tree_.nodes[pair.i], &b = tree_.nodes[pair.j];
    const bool elements = a.is_element() && b.is_element();
    if (elements && !kernel::may_exchange(elements_[pair.i], elements_[pair.j])) return {};
    Examined undivided{elements ? Outcome::Near : Outcome::Divide, {}};
    if (pair.i == pair.j) return undivided;
    if (!elements && faces_away(a, b)) return {};
    if (eta_of(a, b) < least_eta) return undivided;
    for (const Ball& ball : link_options_.movers)
        if (may_enter(ball, a, b)) return undivided;
    Examined linked{Outcome::Linked, link_of(pair)};
    if (error2(linked.link) > limit) linked.outcome = undivided.outcome;
    return linked;
}

void Linker::append_children(ElementPair pair, std::vector<ElementPair>& pairs) const {
    const auto append = [&](std::uint32_t i, std::uint32_t j) {
        pairs.push_back({std::min(i, j), std::max(i, j)});
    };
    const TreeNode &a = tree_.nodes[pair.i], &b = tree_.nodes[pair.j];
    if (pair.i == pair.j) {
        append(a.first, a.first);
        append(a.first, a.second);
        append(a.second, a.second);
        return;
    }
    const bool divide_a = b.is_element() || (!a.is_element() && a.radius >= b.radius);
    const TreeNode& divided = divide_a ? a : b;
    const std::uint32_t other = divide_a ? pair.j : pair.i;
    append(divided.first, other);
    append(divided.second, other);
}

// Level after level: all pairs of one level in parallel, each into its own slot, then gathered in order.
void Linker::examine_all(std::vector<ElementPair> pairs, double limit) {
    while (!pairs.empty()) {
        std::vector<Examined> slots(pairs.size());
        core::parallel_for(pairs.size(), [&](std::size_t k) { slots[k] = examine(pairs[k], limit); });
        std::vector<ElementPair> next;
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            rays_ += slots[k].link.rays;
            if (slots[k].outcome == Outcome::Linked) links_.push_back(std::move(slots[k].link));
            if (slots[k].outcome == Outcome::Near) near_.push_back(pairs[k]);
            if (slots[k].outcome == Outcome::Divide) append_children(pairs[k], next);
        }
        pairs = std::move(next);
    }
}

double Linker::total_error2() const {
    double sum = 0.0;
    for (const Link& link : links_) sum += error2(link);
    return sum;
}

void Linker::weigh_with(const LightEstimate& light) {
    std::vector<double> coefficients(tree_.hierarchy.layout.offsets[elements_.size()], 0.0);
    std::vector<double> radiosity2(tree_.nodes.size(), 0.0), irradiance2(tree_.nodes.size(), 0.0);
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        coefficients[tree_.hierarchy.layout.offsets[e]] = light.radiosity[e] * std::sqrt(elements_[e].area);
        radiosity2[e] = elements_[e].area * light.radiosity[e] * light.radiosity[e];
        irradiance2[e] = elements_[e].area * light.irradiance[e] * light.irradiance[e];
    }
    const std::vector<double> all = model::gather_groups(tree_.hierarchy, 1, coefficients);
    power_.assign(tree_.nodes.size(), {});
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
        const TreeNode& node = tree_.nodes[n];
        if (!node.is_element()) {
            radiosity2[n] = radiosity2[node.first] + radiosity2[node.second];
            irradiance2[n] = irradiance2[node.first] + irradiance2[node.second];
        }
        const std::size_t first = tree_.hierarchy.layout.offsets[n];
        power_[n].constant = all[first] * all[first];
        for (std::size_t k = first + 1; k < tree_.hierarchy.layout.offsets[n + 1]; ++k)
            power_[n].linear += all[k] * all[k];
        power_[n].rest = std::max(0.0, radiosity2[n] - power_[n].constant - power_[n].linear);
    }
    irradiance_power_ = irradiance2[tree_.root];
}

Brought brought(double common, const Power& sent, const Residuals& outside, const Residuals& outside_sender) {
    return {common * (sent.constant + sent.linear) + likeness * outside_sender.of_constant * sent.rest,
            outside.of_constant * sent.constant + outside.of_others * sent.linear};
}

std::array<Brought, 2> Linker::brought_by(const Link& link) const {
    // The block's own error is about alike in each of the receiver's functions.
    const auto functions = [&](std::uint32_t node) {
        return static_cast<double>(tree_.nodes[node].basis_size);
    };
    return {
        brought(functions(link.nodes.i) * link.common, power_[link.nodes.j], link.outside_i, link.outside_j),
        brought(functions(link.nodes.j) * link.common, power_[link.nodes.i], link.outside_j, link.outside_i)};
}

// A link's share of the squared error of all links. Noise adds up by squares; of what is smeared, a part adds up as it
// is, so that a link weighs the more, the more is smeared at its nodes already.
double Linker::error2(const Link& link) const {
    const auto [at_i, at_j] = brought_by(link);
    const auto share = [&](const Brought& it, std::uint32_t node) {
        return it.noise + (1.0 - coherence) * it.smeared +
               coherence * std::sqrt(it.smeared * tree_.nodes[node].area) * smeared_[node];
    };
    return share(at_i, link.nodes.i) + share(at_j, link.nodes.j);
}

// The root mean square of what all links together smear, per area, for each node the mean over its elements.
void Linker::add_up_smeared() {
    smeared_.assign(tree_.nodes.size(), 0.0);
    for (const Link& link : links_) {
        const auto [at_i, at_j] = brought_by(link);
        smeared_[link.nodes.i] += std::sqrt(at_i.smeared / tree_.nodes[link.nodes.i].area);
        smeared_[link.nodes.j] += std::sqrt(at_j.smeared / tree_.nodes[link.nodes.j].area);
    }
    for (std::size_t n = tree_.nodes.size(); n-- > elements_.size();) {
        smeared_[tree_.nodes[n].first] += smeared_[n];
        smeared_[tree_.nodes[n].second] += smeared_[n];
    }
    for (std::size_t n = elements_.size(); n < tree_.nodes.size(); ++n) {
        const TreeNode &node = tree_.nodes[n], &first = tree_.nodes[node.first],
                       &second = tree_.nodes[node.second];
        smeared_[n] = (first.area * smeared_[node.first] + second.area * smeared_[node.second]) / node.area;
    }
}

// Divides the links with the largest errors until all together are within a tolerance.
void Linker::refine(double tolerance) {
    const double allowed = tolerance * tolerance * irradiance_power_;
    double limit = allowed;
    for (add_up_smeared(); total_error2() > allowed; add_up_smeared()) {
        limit *= round_factor;
        std::vector<ElementPair> divided;
        std::vector<Link> kept;
        for (Link& link : links_) {
            if (error2(link) <= limit)
                kept.push_back(std::move(link));
            else if (tree_.nodes[link.nodes.i].is_element() && tree_.nodes[link.nodes.j].is_element())
                near_.push_back(link.nodes);
            else
                append_children(link.nodes, divided);
        }
        links_ = std::move(kept);
        examine_all(std::move(divided), limit);
    }
}

LinkedPairs Linker::run() {
    weigh_with(light_);
    const auto root = static_cast<std::uint32_t>(tree_.root);
    add_up_smeared();
    examine_all({{root, root}}, std::numeric_limits<double>::infinity());
    refine(coarse * link_options_.tolerance);
    if (link_options_.refine_light) {
        model::Hierarchy hierarchy = tree_.hierarchy;
        hierarchy.links = result().links;
        weigh_with(linked_light(light_, elements_, hierarchy));
    }
    refine(link_options_.tolerance);
    return result();
}

LinkedPairs Linker::result() const {
    LinkedPairs pairs{.near = near_, .rays = rays_};
    pairs.error_estimate = std::sqrt(total_error2() / irradiance_power_);
    std::sort(pairs.near.begin(), pairs.near.end());
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < links_.size(); ++k)
        if (!links_[k].values.empty()) order.push_back(k);
    std::sort(order.begin(), order.end(),
              [&](std::size_t x, std::size_t y) { return links_[x].nodes < links_[y].nodes; });
    for (const std::size_t k : order) {
        const Link& link = links_[k];
        pairs.links.entries.push_back(
            {link.nodes.i, link.nodes.j, pairs.links.values.size(), link.block_error});
        pairs.links.values.insert(pairs.links.values.end(), link.values.begin(), link.values.end());
    }
    return pairs;
}

} // namespace

LinkedPairs link_groups(const ElementTree& tree, std::span<const geometry::ElementShape> elements,
                        const LightEstimate& light, const visibility::Occluders& occluders,
                        const kernel::TransportOptions& options, const LinkOptions& link_options) {
    return Linker(tree, elements, light, occluders, options, link_options).run();
}

} // namespace kinelux::coefficients
