// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/quadrature_compression.h"

#include <Eigen/Dense>

#include <algorithm>
#include <limits>

namespace kinelux::geometry {

namespace {

// Products whose part independent of the others is below this share of the largest are taken as dependent on the domain.
constexpr double rank_tolerance = 1e-13;

using Index = Eigen::Index;

// Column i holds the moments' integrands at node i.
Eigen::MatrixXd integrands(std::span<const DomainPoint> rule, std::span<const KeptNode> nodes,
                           const LegendreFrame& frame, int degree) {
    Eigen::MatrixXd matrix(static_cast<Index>(basis_size(degree)), static_cast<Index>(nodes.size()));
    for (std::size_t i = 0; i < nodes.size(); ++i)
        frame.products(rule[nodes[i].index].parameter, degree,
                       std::span(matrix.col(static_cast<Index>(i)).data(), basis_size(degree)));
    return matrix;
}

// The node that vanishes first when a multiple of `direction` is taken from the weights, and that multiple. The
// direction has entries of both signs, for its sum is the moment of the constant.
std::pair<Index, double> first_to_vanish(const Eigen::VectorXd& weights, const Eigen::VectorXd& direction) {
    double step = std::numeric_limits<double>::infinity();
    Index leaving = -1;
    for (Index i = 0; i < weights.size(); ++i)
        if (direction[i] > 0.0 && weights[i] < step * direction[i]) {
            step = weights[i] / direction[i];
            leaving = i;
        }
    return {leaving, step};
}

// Leaves no more nodes than independent moments: each direction of weights without moments is subtracted until a
// weight vanishes, and the directions left are freed of that node.
void thin_out(std::vector<KeptNode>& nodes, const Eigen::MatrixXd& moments) {
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(moments.transpose());
    qr.setThreshold(rank_tolerance);
    const Index count = moments.cols(), rank = qr.rank();
    Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(count, count - rank);
    directions.bottomRows(count - rank).setIdentity();
    directions = qr.householderQ() * directions;

    Eigen::VectorXd weights(count);
    for (Index i = 0; i < count; ++i) weights[i] = nodes[static_cast<std::size_t>(i)].weight;
    for (Index k = 0; k < directions.cols(); ++k) {
        const Eigen::VectorXd direction = directions.col(k);
        const auto [leaving, step] = first_to_vanish(weights, direction);
        if (leaving < 0) break;
        weights = (weights - step * direction).cwiseMax(0.0);
        weights[leaving] = 0.0;
        for (Index j = k + 1; j < directions.cols(); ++j) {
            directions.col(j) -= directions(leaving, j) / direction[leaving] * direction;
            directions(leaving, j) = 0.0;
        }
    }
    for (Index i = 0; i < count; ++i) nodes[static_cast<std::size_t>(i)].weight = weights[i];
    std::erase_if(nodes, [](const KeptNode& node) { return !(node.weight > 0.0); });
}

// Takes away what rounding has done to the moments, by the smallest change of the weights.
void restore_moments(std::vector<KeptNode>& nodes, const Eigen::MatrixXd& moments,
                     const Eigen::VectorXd& wanted) {
    Eigen::VectorXd weights(moments.cols());
    for (Index i = 0; i < moments.cols(); ++i) weights[i] = nodes[static_cast<std::size_t>(i)].weight;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(moments);
    solver.setThreshold(rank_tolerance);
    const Eigen::VectorXd restored = weights + solver.solve(wanted - moments * weights);
    if (!(restored.minCoeff() > 0.0)) return;
    for (Index i = 0; i < moments.cols(); ++i) nodes[static_cast<std::size_t>(i)].weight = restored[i];
}

} // namespace

std::optional<std::vector<KeptNode>> compress_quadrature(std::span<const DomainPoint> rule, int degree) {
    const std::size_t conditions = basis_size(degree);
    if (2 * rule.size() < 3 * conditions) return std::nullopt;
    const LegendreFrame frame(rule);

    // Twice as many nodes as moments at a time, of which one in two leaves.
    std::vector<KeptNode> kept;
    Eigen::VectorXd wanted = Eigen::VectorXd::Zero(static_cast<Index>(conditions));
    Eigen::VectorXd products(static_cast<Index>(conditions));
    for (std::size_t next = 0; next < rule.size();) {
        for (; next < rule.size() && kept.size() < 2 * conditions; ++next) {
            kept.push_back({next, rule[next].weight});
            frame.products(rule[next].parameter, degree, std::span(products.data(), conditions));
            wanted += rule[next].weight * products;
        }
        if (kept.size() > conditions) thin_out(kept, integrands(rule, kept, frame, degree));
    }
    if (kept.size() > conditions) return std::nullopt;
    restore_moments(kept, integrands(rule, kept, frame, degree), wanted);
    return kept;
}

} // namespace kinelux::geometry
