// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "coefficients/coefficients.h"

namespace kinelux::coefficients {

std::vector<FormFactor> form_factors(const model::Coefficients& coefficients,
                                     std::span<const geometry::ElementShape> elements,
                                     std::span<const std::uint32_t> group_of, std::uint32_t groups) {
    std::vector<double> exchange(std::size_t{groups} * groups), error(exchange.size()), area(groups);
    for (std::size_t e = 0; e < elements.size(); ++e) area[group_of[e]] += elements[e].area;
    // A uniform radiosity 1 has the coefficients (sqrt(A), 0, 0, ...): A_i F_ij = sqrt(A_i A_j) G_ij^00.
    for (const model::BlockEntry& entry : coefficients.static_blocks.entries) {
        const double scale = std::sqrt(elements[entry.i].area * elements[entry.j].area);
        const double value = scale * static_cast<double>(coefficients.static_blocks.values[entry.offset]);
        const std::size_t forward = std::size_t{group_of[entry.i]} * groups + group_of[entry.j];
        const std::size_t backward = std::size_t{group_of[entry.j]} * groups + group_of[entry.i];
        exchange[forward] += value;
        error[forward] += scale * static_cast<double>(entry.error);
        if (entry.i != entry.j) {
            exchange[backward] += value;
            error[backward] += scale * static_cast<double>(entry.error);
        }
    }
    std::vector<FormFactor> result;
    for (std::uint32_t from = 0; from < groups; ++from)
        for (std::uint32_t to = 0; to < groups; ++to) {
            const std::size_t k = std::size_t{from} * groups + to;
            if (area[from] > 0.0)
                result.push_back({from, to, exchange[k] / area[from], error[k] / area[from]});
        }
    return result;
}

} // namespace kinelux::coefficients
