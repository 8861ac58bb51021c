// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/whole_patch_factors.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "kernel/polygon_form_factor.h"
#include "visibility/pair_blockers.h"

namespace kinelux::coefficients {

namespace {

using geometry::ElementShape;
using visibility::Sight;

// Exchange area A_i F_ij of one pair, and what it may be off [m2].
struct Exchange {
    std::uint32_t other;
    double value, error;
};

Sight sight_between(const ElementShape& a, const ElementShape& b, const visibility::Occluders& occluders,
                    const kernel::TransportOptions& options) {
    if (!options.occlusion || occluders.empty()) return Sight::Clear;
    thread_local visibility::PairBlockers blockers;
    return blockers.between(visibility::shaft_end(a), visibility::shaft_end(b), occluders.polygons(),
                            options.occluders, 0);
}

Exchange exchange(const ElementShape& a, const ElementShape& b, const visibility::Occluders& occluders,
                  const kernel::TransportOptions& options) {
    // Measured errors overlook shadow lines that pass between nodes: no less than this of the tolerance is claimed.
    constexpr double least_claim = 1.0 / 3.0;
    if (a.planar && b.planar) {
        const Sight sight = sight_between(a, b, occluders, options);
        if (sight == Sight::Hidden) return {b.id.value, 0.0, 0.0};
        if (sight == Sight::Clear) {
            const auto factor = kernel::polygon_form_factor(a.outline, b.outline);
            return {b.id.value, a.area * factor.value, a.area * factor.error};
        }
    }
    // A uniform radiosity 1 has the coefficient sqrt(A): A_i F_ij = sqrt(A_i A_j) G_ij^00.
    const auto block = kernel::transport(a, b, occluders, options);
    if (block.values.empty()) return {b.id.value, 0.0, 0.0};
    const double scale = std::sqrt(a.area * b.area);
    const double value = scale * block.values[0];
    return {b.id.value, value, std::max(scale * block.error, least_claim * options.sight_tolerance * value)};
}

std::vector<Exchange> row_of(std::size_t i, std::span<const ElementShape> elements,
                             const visibility::Occluders& occluders,
                             const kernel::TransportOptions& options) {
    std::vector<Exchange> row;
    for (std::size_t j = i; j < elements.size(); ++j) {
        if (!kernel::may_exchange(elements[i], elements[j])) continue;
        const Exchange pair = exchange(elements[i], elements[j], occluders, options);
        if (pair.value > 0.0 || pair.error > 0.0) row.push_back(pair);
    }
    return row;
}

} // namespace

model::ClusterTree whole_patch_elements(const model::PatchSet& patches, const model::ClusterTree& tree) {
    model::ClusterTree whole{
        .clusters = tree.clusters, .elements = {}, .domain_triangles = {}, .element_size = 0.0};
    std::vector<bool> done(patches.patches.size(), false);
    for (model::Element element : tree.elements) {
        if (!element.patch) {
            whole.elements.push_back(element);
            continue;
        }
        const model::Patch& patch = patches.patches[element.patch->value];
        const auto first = static_cast<std::uint32_t>(whole.domain_triangles.size());
        if (patch.surface.type == model::SurfaceType::Plane) {
            if (done[element.patch->value]) continue;
            done[element.patch->value] = true;
            for (const model::Triangle& t : patch.triangles)
                whole.domain_triangles.push_back(
                    {patch.points[t[0]], patch.points[t[1]], patch.points[t[2]]});
        } else {
            const auto begin = tree.domain_triangles.begin() + element.first_triangle;
            whole.domain_triangles.insert(whole.domain_triangles.end(), begin,
                                          begin + element.triangle_count);
        }
        element.first_triangle = first;
        element.triangle_count = static_cast<std::uint32_t>(whole.domain_triangles.size()) - first;
        whole.elements.push_back(element);
    }
    return whole;
}

std::vector<FormFactor> whole_patch_factors(std::span<const ElementShape> elements,
                                            const visibility::Occluders& occluders,
                                            const kernel::TransportOptions& options,
                                            std::span<const std::uint32_t> group_of, std::uint32_t groups) {
    std::vector<std::vector<Exchange>> rows(elements.size());
    core::parallel_for(rows.size(),
                       [&](std::size_t i) { rows[i] = row_of(i, elements, occluders, options); });

    std::vector<double> sums(std::size_t{groups} * groups), errors(sums.size()), areas(groups);
    const auto add = [&](std::uint32_t from, std::uint32_t to, const Exchange& pair) {
        sums[std::size_t{from} * groups + to] += pair.value;
        errors[std::size_t{from} * groups + to] += pair.error;
    };
    for (std::size_t i = 0; i < elements.size(); ++i) {
        areas[group_of[i]] += elements[i].area;
        for (const Exchange& pair : rows[i]) {
            add(group_of[i], group_of[pair.other], pair);
            if (pair.other != i) add(group_of[pair.other], group_of[i], pair);
        }
    }
    std::vector<FormFactor> factors;
    for (std::uint32_t from = 0; from < groups; ++from)
        for (std::uint32_t to = 0; to < groups; ++to) {
            const std::size_t k = std::size_t{from} * groups + to;
            if (areas[from] > 0.0)
                factors.push_back({from, to, sums[k] / areas[from], errors[k] / areas[from]});
        }
    return factors;
}

} // namespace kinelux::coefficients
