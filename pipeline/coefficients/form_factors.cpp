// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "coefficients/coefficients.h"
#include "model/hierarchy.h"

namespace kinelux::coefficients {

namespace {

constexpr std::size_t groups_at_once = 16; ///< of links' form factors: one channel each

// Adds what the links carry between groups of elements, A_a F_ab: a few groups at a time shine with radiosity 1.
void add_links(const model::Coefficients& coefficients, std::span<const geometry::ElementShape> elements,
               std::span<const std::uint32_t> group_of, std::uint32_t groups, std::vector<double>& exchange) {
    const auto& offsets = coefficients.layout.offsets;
    for (std::uint32_t first = 0; first < groups; first += groups_at_once) {
        const std::size_t channels = std::min<std::size_t>(groups_at_once, groups - first);
        std::vector<double> sent(coefficients.layout.unknowns() * channels, 0.0), arrived(sent.size(), 0.0);
        for (std::size_t e = 0; e < elements.size(); ++e)
            if (group_of[e] >= first && group_of[e] < first + channels)
                sent[offsets[e] * channels + group_of[e] - first] = std::sqrt(elements[e].area);
        model::add_link_transport(coefficients.hierarchy, channels, sent, arrived);
        for (std::size_t e = 0; e < elements.size(); ++e)
            for (std::size_t c = 0; c < channels; ++c)
                exchange[(first + c) * groups + group_of[e]] +=
                    std::sqrt(elements[e].area) * arrived[offsets[e] * channels + c];
    }
}

// Adds the links' error, which is known for all of them together, to each factor in proportion to what it carries.
void add_link_errors(const model::Hierarchy& hierarchy, std::span<const double> exchange,
                     std::vector<double>& error) {
    for (std::size_t k = 0; k < error.size(); ++k) error[k] += hierarchy.error_estimate * exchange[k];
}

} // namespace

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
    if (!coefficients.hierarchy.empty()) {
        add_links(coefficients, elements, group_of, groups, exchange);
        add_link_errors(coefficients.hierarchy, exchange, error);
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

std::vector<double> element_row_sums(const model::Coefficients& coefficients,
                                     std::span<const geometry::ElementShape> elements) {
    // Everything shines with radiosity 1: sqrt(A_i) sum_j F_ij = sum_j G_ij^00 sqrt(A_j).
    std::vector<double> sums(elements.size(), 0.0);
    if (!coefficients.hierarchy.empty()) {
        const auto& offsets = coefficients.layout.offsets;
        std::vector<double> sent(coefficients.layout.unknowns(), 0.0), arrived(sent.size(), 0.0);
        for (std::size_t e = 0; e < elements.size(); ++e) sent[offsets[e]] = std::sqrt(elements[e].area);
        model::add_link_transport(coefficients.hierarchy, 1, sent, arrived);
        for (std::size_t e = 0; e < elements.size(); ++e) sums[e] = arrived[offsets[e]];
    }
    for (const model::BlockEntry& entry : coefficients.static_blocks.entries) {
        const auto value = static_cast<double>(coefficients.static_blocks.values[entry.offset]);
        sums[entry.i] += value * std::sqrt(elements[entry.j].area);
        if (entry.i != entry.j) sums[entry.j] += value * std::sqrt(elements[entry.i].area);
    }
    for (std::size_t e = 0; e < elements.size(); ++e) sums[e] /= std::sqrt(elements[e].area);
    return sums;
}

} // namespace kinelux::coefficients
