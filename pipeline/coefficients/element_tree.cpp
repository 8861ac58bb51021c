// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/element_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "core/parallel.h"

namespace kinelux::coefficients {

namespace {

using geometry::ElementShape;
using geometry::NodeSet;
using geometry::SurfaceNode;

constexpr std::size_t moments = 10;         ///< polynomials of degree <= 2 in three coordinates
constexpr double least_cone_cosine = 0.866; ///< wider groups are divided by normal
constexpr double flat_ratio =
    1e-6; ///< of variances: a group thinner than a thousandth of its length counts as flat
constexpr double rank_tolerance = 1e-9; ///< of moments, relative to the largest

// The moments of nodes as columns, in coordinates relative to a ball so that all are of order one.
Eigen::MatrixXd moment_matrix(std::span<const SurfaceNode> nodes, const Vec3& centre, double radius) {
    Eigen::MatrixXd matrix(moments, static_cast<Eigen::Index>(nodes.size()));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Vec3 x = (nodes[i].position - centre) / radius;
        const std::array<double, moments> column{1.0,       x.x,       x.y,       x.z,       x.x * x.x,
                                                 x.y * x.y, x.z * x.z, x.x * x.y, x.y * x.z, x.z * x.x};
        for (std::size_t k = 0; k < moments; ++k)
            matrix(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = column[k];
    }
    return matrix;
}

// Moves along a direction that leaves all moments as they are until a weight is zero; false where there is none.
bool drop_one(std::vector<SurfaceNode>& nodes, const Vec3& centre, double radius) {
    Eigen::FullPivLU<Eigen::MatrixXd> factors(moment_matrix(nodes, centre, radius));
    factors.setThreshold(rank_tolerance);
    if (factors.dimensionOfKernel() == 0) return false;
    Eigen::VectorXd direction = factors.kernel().col(0);
    if (direction.maxCoeff() <= 0.0) direction = -direction;
    std::size_t dropped = 0;
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double d = direction(static_cast<Eigen::Index>(i));
        if (d > 0.0 && nodes[i].weight / d < step) {
            step = nodes[i].weight / d;
            dropped = i;
        }
    }
    for (std::size_t i = 0; i < nodes.size(); ++i)
        nodes[i].weight -= step * direction(static_cast<Eigen::Index>(i));
    nodes.erase(nodes.begin() + static_cast<std::ptrdiff_t>(dropped));
    std::erase_if(nodes, [](const SurfaceNode& node) { return !(node.weight > 0.0); });
    return true;
}

// As few of the nodes as integrate all polynomials of degree 2 in position alike (Tchakaloff), few at a time.
std::vector<SurfaceNode> thinned(std::span<const SurfaceNode> nodes, const Vec3& centre, double radius) {
    std::vector<SurfaceNode> kept;
    for (const SurfaceNode& node : nodes) {
        kept.push_back(node);
        if (kept.size() >= 2 * moments)
            while (drop_one(kept, centre, radius)) {
            }
    }
    while (drop_one(kept, centre, radius)) {
    }
    return kept;
}

// An element's own rule where its basis is of degree 1 or more; the first rule of a constant is exact to degree 1 only and
// would not do for the groups above it.
NodeSet element_rule(const ElementShape& element) {
    if (element.basis.degree() > 0) return element.rules[0];
    NodeSet rule;
    rule.nodes = thinned(element.rules[1].nodes, element.centre, element.radius);
    rule.basis.assign(rule.nodes.size(), 1.0 / std::sqrt(element.area));
    return rule;
}

// Whether rays from all nodes, upright and oblique, meet the back of a face first.
bool buried(const NodeSet& rule, const visibility::Occluders& occluders) {
    constexpr double lean = 0.7; // of the oblique rays, tangent of the angle to the normal
    for (const SurfaceNode& node : rule.nodes) {
        const Vec3 helper = std::abs(node.normal.x) < 0.6 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
        const Vec3 u = glm::normalize(glm::cross(helper, node.normal)), v = glm::cross(node.normal, u);
        for (const Vec3& aside : {Vec3(0.0), u, -u, v, -v}) {
            const Vec3 direction = node.normal + lean * aside;
            const auto hit = occluders.first_hit(node.position, direction);
            if (!hit || glm::dot(hit->normal, direction) <= 0.0) return false;
        }
    }
    return true;
}

TreeNode node_of(const ElementShape& element, const visibility::Occluders& occluders) {
    TreeNode node;
    node.box_low = element.box_low;
    node.box_high = element.box_high;
    node.centre = element.centre;
    node.radius = element.radius;
    node.mean_normal = element.mean_normal;
    node.cone_cosine = element.cone_cosine;
    node.area = element.area;
    node.rule = element_rule(element);
    node.buried = buried(node.rule, occluders);
    node.basis_size = element.basis.size();
    return node;
}

// The cone about the mean of two cones' axes that holds both.
void join_cones(const TreeNode& a, const TreeNode& b, TreeNode& group) {
    const Vec3 sum = a.area * a.mean_normal + b.area * b.mean_normal;
    group.mean_normal = glm::length(sum) > 1e-9 * group.area ? glm::normalize(sum) : a.mean_normal;
    double widest = 0.0;
    for (const TreeNode* child : {&a, &b}) {
        const double between =
            std::acos(std::clamp(glm::dot(group.mean_normal, child->mean_normal), -1.0, 1.0));
        widest = std::max(widest, between + std::acos(std::clamp(child->cone_cosine, -1.0, 1.0)));
    }
    group.cone_cosine = std::cos(std::min(widest, std::numbers::pi));
}

// psi_0 = 1/sqrt(A) and linear functions along the principal axes of the area, divided by their norms.
void set_group_basis(TreeNode& group) {
    Vec3 centroid(0.0);
    for (const SurfaceNode& node : group.rule.nodes) centroid += node.weight / group.area * node.position;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (const SurfaceNode& node : group.rule.nodes) {
        const Vec3 d = node.position - centroid;
        const Eigen::Vector3d v(d.x, d.y, d.z);
        inertia += node.weight * v * v.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(inertia);
    const Eigen::Vector3d& variance = axes.eigenvalues(); // ascending
    std::vector<int> used;
    for (int k = 2; k >= 0; --k)
        if (variance(k) > flat_ratio * variance(2)) used.push_back(k);
    group.basis_size = 1 + used.size();
    group.rule.basis.clear();
    for (const SurfaceNode& node : group.rule.nodes) {
        const Vec3 d = node.position - centroid;
        group.rule.basis.push_back(1.0 / std::sqrt(group.area));
        for (const int k : used)
            group.rule.basis.push_back(axes.eigenvectors().col(k).dot(Eigen::Vector3d(d.x, d.y, d.z)) /
                                       std::sqrt(variance(k)));
    }
}

class Builder {
public:
    Builder(std::span<const std::uint32_t> members, ElementTree& tree)
        : tree_(tree), order_(members.begin(), members.end()) {}

    void build() {
        const auto buried = std::stable_partition(order_.begin(), order_.end(),
                                                  [&](std::uint32_t e) { return !tree_.nodes[e].buried; });
        const auto open = static_cast<std::size_t>(buried - order_.begin());
        if (open == 0 || open == order_.size())
            tree_.root = build(0, order_.size());
        else {
            const std::size_t first = build(0, open), second = build(open, order_.size());
            tree_.root = join(first, second);
        }
    }

private:
    std::size_t build(std::size_t begin, std::size_t end) {
        if (end - begin == 1) return order_[begin];
        const std::size_t middle = divide(begin, end);
        const std::size_t first = build(begin, middle), second = build(middle, end);
        return join(first, second);
    }

    Vec3 mean_normal(std::size_t begin, std::size_t end) const {
        Vec3 sum(0.0);
        for (std::size_t k = begin; k < end; ++k)
            sum += tree_.nodes[order_[k]].area * tree_.nodes[order_[k]].mean_normal;
        return glm::length(sum) > 0.0 ? glm::normalize(sum) : Vec3(0.0);
    }

    // Sorts [begin, end) into two parts, neither of them empty. @return  where the second starts
    std::size_t divide(std::size_t begin, std::size_t end) {
        const Vec3 mean = mean_normal(begin, end);
        bool by_normal = false;
        for (std::size_t k = begin; k < end; ++k)
            by_normal = by_normal || glm::dot(mean, tree_.nodes[order_[k]].mean_normal) < least_cone_cosine;
        const auto key = [&](std::uint32_t element) {
            return by_normal ? tree_.nodes[element].mean_normal : tree_.nodes[element].centre;
        };
        Vec3 low = key(order_[begin]), high = low;
        for (std::size_t k = begin; k < end; ++k) {
            low = glm::min(low, key(order_[k]));
            high = glm::max(high, key(order_[k]));
        }
        const Vec3 size = high - low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const double cut = 0.5 * (low[axis] + high[axis]);
        const auto from = order_.begin() + static_cast<std::ptrdiff_t>(begin);
        const auto to = order_.begin() + static_cast<std::ptrdiff_t>(end);
        const auto middle =
            std::stable_partition(from, to, [&](std::uint32_t element) { return key(element)[axis] < cut; });
        const bool one_sided = middle == from || middle == to;
        return one_sided ? begin + (end - begin) / 2 : static_cast<std::size_t>(middle - order_.begin());
    }

    std::size_t join(std::size_t first, std::size_t second) {
        const TreeNode &a = tree_.nodes[first], &b = tree_.nodes[second];
        TreeNode group;
        group.first = static_cast<std::uint32_t>(first);
        group.second = static_cast<std::uint32_t>(second);
        group.box_low = glm::min(a.box_low, b.box_low);
        group.box_high = glm::max(a.box_high, b.box_high);
        group.centre = 0.5 * (group.box_low + group.box_high);
        for (const TreeNode* child : {&a, &b})
            group.radius = std::max(group.radius, glm::distance(group.centre, child->centre) + child->radius);
        group.area = a.area + b.area;
        join_cones(a, b, group);
        std::vector<SurfaceNode> all = a.rule.nodes;
        all.insert(all.end(), b.rule.nodes.begin(), b.rule.nodes.end());
        group.rule.nodes = thinned(all, group.centre, group.radius);
        set_group_basis(group);
        tree_.nodes.push_back(std::move(group));
        return tree_.nodes.size() - 1;
    }

    ElementTree& tree_;
    std::vector<std::uint32_t> order_;
};

// P_kl = integral over the child of psi_k(group) psi_l(child). A group's functions are affine in position, so four of
// their values fix them; they are found from the rule of the group by least squares.
class GroupFunctions {
public:
    explicit GroupFunctions(const TreeNode& group)
        : centre_(group.centre), radius_(group.radius), size_(group.basis_size) {
        const auto rows = static_cast<Eigen::Index>(group.rule.nodes.size());
        const auto columns = static_cast<Eigen::Index>(size_);
        Eigen::MatrixXd positions(rows, 4), values(rows, columns);
        for (Eigen::Index i = 0; i < rows; ++i) {
            positions.row(i) = affine(group.rule.nodes[static_cast<std::size_t>(i)].position);
            for (Eigen::Index k = 0; k < columns; ++k)
                values(i, k) = group.rule.basis[static_cast<std::size_t>(i * columns + k)];
        }
        coefficients_ = positions.completeOrthogonalDecomposition().solve(values);
    }

    /// All functions at a point. @return  size() values
    Eigen::RowVectorXd at(const Vec3& x) const { return affine(x) * coefficients_; }
    std::size_t size() const { return size_; }

private:
    Eigen::RowVector4d affine(const Vec3& x) const {
        const Vec3 d = (x - centre_) / radius_;
        return {1.0, d.x, d.y, d.z};
    }

    Vec3 centre_;
    double radius_;
    std::size_t size_;
    Eigen::MatrixXd coefficients_; ///< 4 x size
};

void append_restriction(const GroupFunctions& functions, const TreeNode& child,
                        std::vector<double>& restrictions) {
    const std::size_t columns = child.basis_size, offset = restrictions.size();
    restrictions.resize(offset + functions.size() * columns, 0.0);
    for (std::size_t i = 0; i < child.rule.nodes.size(); ++i) {
        const SurfaceNode& node = child.rule.nodes[i];
        const Eigen::RowVectorXd psi = functions.at(node.position);
        for (std::size_t k = 0; k < functions.size(); ++k)
            for (std::size_t l = 0; l < columns; ++l)
                restrictions[offset + k * columns + l] +=
                    node.weight * psi(static_cast<Eigen::Index>(k)) * child.rule.basis[i * columns + l];
    }
}

model::Hierarchy hierarchy_of(const std::vector<TreeNode>& nodes, std::size_t elements) {
    model::Hierarchy hierarchy;
    hierarchy.layout.offsets.push_back(0);
    for (const TreeNode& node : nodes)
        hierarchy.layout.offsets.push_back(hierarchy.layout.offsets.back() +
                                           static_cast<std::uint32_t>(node.basis_size));
    for (std::size_t n = elements; n < nodes.size(); ++n) {
        hierarchy.groups.push_back({nodes[n].first, nodes[n].second, hierarchy.restrictions.size()});
        const GroupFunctions functions(nodes[n]);
        append_restriction(functions, nodes[nodes[n].first], hierarchy.restrictions);
        append_restriction(functions, nodes[nodes[n].second], hierarchy.restrictions);
    }
    return hierarchy;
}

} // namespace

ElementTree build_element_tree(std::span<const ElementShape> elements, std::span<const std::uint32_t> members,
                               const visibility::Occluders& occluders) {
    ElementTree tree;
    tree.nodes.resize(elements.size());
    core::parallel_for(elements.size(),
                       [&](std::size_t e) { tree.nodes[e] = node_of(elements[e], occluders); });
    tree.nodes.reserve(2 * elements.size());
    if (!members.empty()) Builder(members, tree).build();
    tree.hierarchy = hierarchy_of(tree.nodes, elements.size());
    return tree;
}

} // namespace kinelux::coefficients
