// SPDX-License-Identifier: GPL-3.0-or-later
// Key: A, B nodes; G = integral integral psi_k K V phi_l the block; u = 1/sqrt(area) the constant function;
// residual = what (K V)(., phi_l) has outside the basis of A, squared and integrated over A.
#include "coefficients/links.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace kinelux::coefficients {

namespace {

using geometry::SurfaceNode;
using model::ElementPair;

// Closer groups, by the distance of their balls over the diameter of the larger one, are always divided: products of
// rules of degree 2 are then off by more than a tenth.
constexpr double least_eta = 0.5;

// Error of a product of two rules of degree 2 relative to the block, at eta = 1; it falls with eta^2.
constexpr double product_error = 0.02;

// What radiosity has beyond its mean in a group, squared and relative to the mean squared, in linear functions or in
// functions that no basis of the group holds.
constexpr double variation = 0.1;

// Each round's limit of a single link's squared error, relative to the round before.
constexpr double round_factor = 0.25;

struct Link {
    ElementPair nodes;
    double error2 = 0.0;      ///< squared L2 error of irradiance, over both nodes
    float block_error = 0.0f; ///< Frobenius norm
    std::uint32_t rays = 0;
    std::vector<float> values; ///< empty: hidden
};

enum class Outcome : std::uint8_t { Nothing, Linked, Divide, Near };

struct Examined {
    Outcome outcome = Outcome::Nothing;
    Link link;
};

// Kernel and visibility of all pairs of nodes of two rules.
struct Samples {
    std::vector<double> kernel;  ///< with visibility [1/m2], rows of A
    double unoccluded = 0.0;     ///< the block's constant part without visibility
    double facing_bound = 0.0;   ///< the same with the cosines' absolute values
    std::uint32_t rays = 0, hidden = 0;
};

// The largest n . (y - x) over normals n of a's cone, x in a, y in b.
double highest_above(const TreeNode& a, const TreeNode& b) {
    double reach = 0.0; // over the boxes, for the cone's axis
    for (int axis = 0; axis < 3; ++axis) {
        const double n = a.mean_normal[axis];
        reach += n > 0.0 ? n * (b.box_high[axis] - a.box_low[axis]) : n * (b.box_low[axis] - a.box_high[axis]);
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
    const double t = length2 > 0.0 ? std::clamp(glm::dot(ball.centre - a.centre, axis) / length2, 0.0, 1.0) : 0.0;
    if (glm::distance(ball.centre, a.centre + t * axis) > ball.radius + std::max(a.radius, b.radius)) return false;
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
           const visibility::Occluders& occluders, const kernel::TransportOptions& options,
           const LinkOptions& link_options)
        : tree_(tree), elements_(elements), occluders_(occluders), options_(options), link_options_(link_options) {}

    LinkedPairs run();

private:
    void examine_all(std::vector<ElementPair> pairs, double limit);
    Examined examine(ElementPair pair, double limit) const;
    void append_children(ElementPair pair, std::vector<ElementPair>& pairs) const;
    Samples sample(const TreeNode& a, const TreeNode& b) const;
    void cast_rays(const TreeNode& a, const TreeNode& b, Samples& samples) const;
    Link link_of(ElementPair pair) const;
    double total_error2() const;
    LinkedPairs result() const;

    const ElementTree& tree_;
    std::span<const geometry::ElementShape> elements_;
    const visibility::Occluders& occluders_;
    const kernel::TransportOptions& options_;
    const LinkOptions& link_options_;
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
            segments.push_back({a.rule.nodes[k / columns].position, b.rule.nodes[k % columns].position});
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
    double constant_residual = 0.0, other_residual = 0.0;
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
        (l == 0 ? result.constant_residual : result.other_residual) += std::max(0.0, norm[l]);
    }
    return result;
}

// What a group's basis drops is an error; what an element's drops, the elements would drop too.
double weight_of_residual(const TreeNode& node) { return node.is_element() ? 0.0 : 1.0; }

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
    const double eta = std::max(1.0, eta_of(a, b));
    const double product = product_error * samples.unoccluded / (eta * eta);
    const double common = sight + product * product;

    const double at_a = common + weight_of_residual(a) * (onto_a.constant_residual + variation * onto_a.other_residual) +
                        weight_of_residual(b) * variation * onto_b.constant_residual;
    const double at_b = common + weight_of_residual(b) * (onto_b.constant_residual + variation * onto_b.other_residual) +
                        weight_of_residual(a) * variation * onto_a.constant_residual;

    Link link{.nodes = pair};
    link.rays = samples.rays;
    link.error2 = at_a * b.power + at_b * a.power;
    link.block_error = static_cast<float>(std::sqrt(std::max(at_a, at_b)));
    if (onto_a.block[0] > 0.0) link.values.assign(onto_a.block.begin(), onto_a.block.end());
    return link;
}

Examined Linker::examine(ElementPair pair, double limit) const {
    const TreeNode &a = tree_.nodes[pair.i], &b = tree_.nodes[pair.j];
    const bool elements = a.is_element() && b.is_element();
    if (elements && !kernel::may_exchange(elements_[pair.i], elements_[pair.j])) return {};
    const Examined undivided{elements ? Outcome::Near : Outcome::Divide, {}};
    if (pair.i == pair.j) return undivided;
    if (!elements && faces_away(a, b)) return {};
    if (eta_of(a, b) < least_eta) return undivided;
    for (const Ball& ball : link_options_.movers)
        if (may_enter(ball, a, b)) return undivided;
    Examined linked{Outcome::Linked, link_of(pair)};
    if (linked.link.error2 > limit) linked.outcome = undivided.outcome;
    return linked;
}

void Linker::append_children(ElementPair pair, std::vector<ElementPair>& pairs) const {
    const auto append = [&](std::uint32_t i, std::uint32_t j) { pairs.push_back({std::min(i, j), std::max(i, j)}); };
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
    for (const Link& link : links_) sum += link.error2;
    return sum;
}

LinkedPairs Linker::run() {
    const TreeNode& root = tree_.nodes[tree_.root];
    const auto root_number = static_cast<std::uint32_t>(tree_.root);
    // In a closed scene the irradiance is on the average as large as the radiosity.
    const double allowed = link_options_.tolerance * link_options_.tolerance * root.power;
    double limit = allowed;
    examine_all({{root_number, root_number}}, limit);
    while (total_error2() > allowed) {
        limit *= round_factor;
        std::vector<ElementPair> divided;
        std::vector<Link> kept;
        for (Link& link : links_) {
            if (link.error2 <= limit)
                kept.push_back(std::move(link));
            else if (tree_.nodes[link.nodes.i].is_element() && tree_.nodes[link.nodes.j].is_element())
                near_.push_back(link.nodes);
            else
                append_children(link.nodes, divided);
        }
        links_ = std::move(kept);
        examine_all(std::move(divided), limit);
    }
    return result();
}

LinkedPairs Linker::result() const {
    LinkedPairs pairs{.near = near_, .rays = rays_};
    pairs.error_estimate = std::sqrt(total_error2() / tree_.nodes[tree_.root].power);
    std::sort(pairs.near.begin(), pairs.near.end());
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < links_.size(); ++k)
        if (!links_[k].values.empty()) order.push_back(k);
    std::sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return links_[x].nodes < links_[y].nodes; });
    for (const std::size_t k : order) {
        const Link& link = links_[k];
        pairs.links.entries.push_back({link.nodes.i, link.nodes.j, pairs.links.values.size(), link.block_error});
        pairs.links.values.insert(pairs.links.values.end(), link.values.begin(), link.values.end());
    }
    return pairs;
}

} // namespace

LinkedPairs link_groups(const ElementTree& tree, std::span<const geometry::ElementShape> elements,
                        const visibility::Occluders& occluders, const kernel::TransportOptions& options,
                        const LinkOptions& link_options) {
    return Linker(tree, elements, occluders, options, link_options).run();
}

} // namespace kinelux::coefficients
