// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/quadrature_compression.h"

#include <Eigen/Dense>

#include <limits>

namespace kinelux::geometry {

std::optional<std::vector<KeptNode>> compress_quadrature(std::span<const DomainPoint> rule, int degree) {
    if (degree > max_degree || 2 * rule.size() < 3 * basis_size(degree)) return std::nullopt;
    const Basis moments(rule, degree);
    const std::size_t conditions = moments.size();

    // One node leaves at a time: of conditions + 1 nodes some combination has all moments zero; it is subtracted until
    // the first weight vanishes.
    std::vector<KeptNode> kept;
    std::size_t next = 0;
    Eigen::MatrixXd matrix(conditions, conditions + 1);
    std::vector<double> values(conditions);
    while (true) {
        while (kept.size() <= conditions && next < rule.size()) {
            kept.push_back({next, rule[next].weight});
            ++next;
        }
        if (kept.size() <= conditions) return kept;
        for (std::size_t i = 0; i < kept.size(); ++i) {
            moments.evaluate(rule[kept[i].index].parameter, values);
            for (std::size_t k = 0; k < conditions; ++k)
                matrix(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = values[k];
        }
        const Eigen::VectorXd null = matrix.fullPivLu().kernel().col(0);
        double step = std::numeric_limits<double>::infinity();
        std::size_t leaving = kept.size();
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const double change = null(static_cast<Eigen::Index>(i));
            if (change > 0.0 && kept[i].weight / change < step) {
                step = kept[i].weight / change;
                leaving = i;
            }
        }
        if (leaving == kept.size()) return std::nullopt;
        for (std::size_t i = 0; i < kept.size(); ++i)
            kept[i].weight = std::max(0.0, kept[i].weight - step * null(static_cast<Eigen::Index>(i)));
        kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(leaving));
        std::erase_if(kept, [](const KeptNode& node) { return node.weight <= 0.0; });
    }
}

} // namespace kinelux::geometry
