// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/hierarchy.h"

#include <algorithm>

namespace kinelux::model {

namespace {

// y += G x, or G^T x, for one row-major block of rows x columns.
void add_block(const float* values, std::size_t rows, std::size_t columns, std::size_t channels,
               const double* x, double* y) {
    for (std::size_t k = 0; k < rows; ++k)
        for (std::size_t l = 0; l < columns; ++l)
            for (std::size_t c = 0; c < channels; ++c)
                y[k * channels + c] += static_cast<double>(values[k * columns + l]) * x[l * channels + c];
}

void add_transposed_block(const float* values, std::size_t rows, std::size_t columns, std::size_t channels,
                          const double* x, double* y) {
    for (std::size_t k = 0; k < rows; ++k)
        for (std::size_t l = 0; l < columns; ++l)
            for (std::size_t c = 0; c < channels; ++c)
                y[l * channels + c] += static_cast<double>(values[k * columns + l]) * x[k * channels + c];
}

// visit(node of the group, child node, restriction) for both children of group g.
template <class Visit>
void for_children(const Hierarchy& hierarchy, std::size_t g, const Visit& visit) {
    const ElementGroup& group = hierarchy.groups[g];
    const std::size_t node = hierarchy.layout.elements() - hierarchy.groups.size() + g;
    const double* restriction = hierarchy.restrictions.data() + group.offset;
    visit(node, std::size_t{group.first}, restriction);
    visit(node, std::size_t{group.second},
          restriction + hierarchy.layout.count(node) * hierarchy.layout.count(group.first));
}

} // namespace

std::vector<double> gather_groups(const Hierarchy& hierarchy, std::size_t channels,
                                  std::span<const double> x) {
    const UnknownLayout& layout = hierarchy.layout;
    std::vector<double> all(layout.unknowns() * channels, 0.0);
    std::copy(x.begin(), x.end(), all.begin());
    for (std::size_t g = 0; g < hierarchy.groups.size(); ++g)
        for_children(hierarchy, g, [&](std::size_t node, std::size_t child, const double* restriction) {
            const std::size_t columns = layout.count(child);
            for (std::size_t k = 0; k < layout.count(node); ++k)
                for (std::size_t l = 0; l < columns; ++l)
                    for (std::size_t c = 0; c < channels; ++c)
                        all[(layout.offsets[node] + k) * channels + c] +=
                            restriction[k * columns + l] * all[(layout.offsets[child] + l) * channels + c];
        });
    return all;
}

void spread_groups(const Hierarchy& hierarchy, std::size_t channels, std::span<double> arrived,
                   std::span<double> y) {
    const UnknownLayout& layout = hierarchy.layout;
    for (std::size_t g = hierarchy.groups.size(); g-- > 0;)
        for_children(hierarchy, g, [&](std::size_t node, std::size_t child, const double* restriction) {
            const std::size_t columns = layout.count(child);
            for (std::size_t k = 0; k < layout.count(node); ++k)
                for (std::size_t l = 0; l < columns; ++l)
                    for (std::size_t c = 0; c < channels; ++c)
                        arrived[(layout.offsets[child] + l) * channels + c] +=
                            restriction[k * columns + l] * arrived[(layout.offsets[node] + k) * channels + c];
        });
    for (std::size_t k = 0; k < y.size(); ++k) y[k] += arrived[k];
}

void add_link_transport(const Hierarchy& hierarchy, std::size_t channels, std::span<const double> x,
                        std::span<double> y) {
    if (hierarchy.empty()) return;
    const UnknownLayout& layout = hierarchy.layout;
    const std::vector<double> sent = gather_groups(hierarchy, channels, x);
    std::vector<double> arrived(sent.size(), 0.0);
    for (const BlockEntry& link : hierarchy.links.entries) {
        const float* values = &hierarchy.links.values[link.offset];
        const std::size_t rows = layout.count(link.i), columns = layout.count(link.j);
        const std::size_t i = layout.offsets[link.i] * channels, j = layout.offsets[link.j] * channels;
        add_block(values, rows, columns, channels, &sent[j], &arrived[i]);
        if (link.i != link.j) add_transposed_block(values, rows, columns, channels, &sent[i], &arrived[j]);
    }
    spread_groups(hierarchy, channels, arrived, y);
}

} // namespace kinelux::model
