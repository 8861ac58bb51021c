// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/coefficients.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/error.h"

namespace kinelux::model {

namespace {

void check_layout(const UnknownLayout& layout) {
    if (layout.offsets.empty()) return;
    if (layout.offsets.front() != 0)
        throw core::GeometryError("coefficients: the first element starts not at unknown 0");
    for (std::size_t element = 0; element < layout.elements(); ++element)
        if (layout.offsets[element + 1] < layout.offsets[element])
            throw core::GeometryError(fmt::format("coefficients: element {} ends before it starts", element));
}

void check_pair(const std::string& what, ElementPair pair, std::size_t elements) {
    if (pair.i > pair.j || pair.j >= elements)
        throw core::GeometryError(
            fmt::format("coefficients: {} ({}, {}) is no pair i <= j of the {} elements", what, pair.i,
                        pair.j, elements));
}

void check_entry(const BlockEntry& entry, const UnknownLayout& layout, std::size_t value_count) {
    check_pair("block", {entry.i, entry.j}, layout.elements());
    const std::size_t size = layout.count(entry.i) * layout.count(entry.j);
    if (entry.offset > value_count || size > value_count - entry.offset)
        throw core::GeometryError(fmt::format("coefficients: block ({}, {}) ends beyond the {} stored values",
                                              entry.i, entry.j, value_count));
    if (!std::isfinite(entry.error))
        throw core::GeometryError(fmt::format(
            "coefficients: the error of block ({}, {}) is not a finite number", entry.i, entry.j));
}

void check_order(const std::vector<BlockEntry>& entries) {
    for (std::size_t k = 1; k < entries.size(); ++k) {
        const ElementPair before{entries[k - 1].i, entries[k - 1].j};
        const ElementPair here{entries[k].i, entries[k].j};
        if (!(before < here))
            throw core::GeometryError(fmt::format(
                "coefficients: block ({}, {}) follows block ({}, {}); blocks are sorted, each pair once",
                here.i, here.j, before.i, before.j));
    }
}

void check_blocks(const BlockSet& blocks, const UnknownLayout& layout) {
    const auto& [entries, values] = blocks;
    for (const BlockEntry& entry : entries) check_entry(entry, layout, values.size());
    check_order(entries);
    for (std::size_t k = 0; k < values.size(); ++k)
        if (!std::isfinite(values[k]))
            throw core::GeometryError(fmt::format("coefficients: value {} is not a finite number", k));
}

void check_group(const Hierarchy& hierarchy, std::size_t group, std::size_t elements,
                 std::vector<std::uint8_t>& has_parent) {
    const ElementGroup& it = hierarchy.groups[group];
    for (const std::uint32_t child : {it.first, it.second}) {
        if (child >= elements + group || has_parent[child] != 0)
            throw core::GeometryError(
                fmt::format("coefficients: node {} cannot be a child of group {}", child, group));
        has_parent[child] = 1;
    }
    const std::size_t size = hierarchy.layout.count(elements + group) *
                             (hierarchy.layout.count(it.first) + hierarchy.layout.count(it.second));
    if (it.offset > hierarchy.restrictions.size() || size > hierarchy.restrictions.size() - it.offset)
        throw core::GeometryError(
            fmt::format("coefficients: the restrictions of group {} end beyond the {} stored values", group,
                        hierarchy.restrictions.size()));
}

void check_hierarchy(const Hierarchy& hierarchy, const UnknownLayout& elements) {
    if (hierarchy.empty()) {
        if (!hierarchy.groups.empty() || !hierarchy.links.entries.empty())
            throw core::GeometryError("coefficients: groups or links without a layout");
        return;
    }
    check_layout(hierarchy.layout);
    if (hierarchy.layout.elements() != elements.elements() + hierarchy.groups.size() ||
        !std::equal(elements.offsets.begin(), elements.offsets.end(), hierarchy.layout.offsets.begin()))
        throw core::GeometryError("coefficients: the nodes are not the elements followed by the groups");
    std::vector<std::uint8_t> has_parent(hierarchy.layout.elements(), 0);
    for (std::size_t group = 0; group < hierarchy.groups.size(); ++group)
        check_group(hierarchy, group, elements.elements(), has_parent);
    for (const double value : hierarchy.restrictions)
        if (!std::isfinite(value))
            throw core::GeometryError("coefficients: a restriction is not a finite number");
    check_blocks(hierarchy.links, hierarchy.layout);
}

} // namespace

void check(const Coefficients& coefficients) {
    check_layout(coefficients.layout);
    check_blocks(coefficients.static_blocks, coefficients.layout);
    check_hierarchy(coefficients.hierarchy, coefficients.layout);
    const std::size_t elements = coefficients.layout.elements();
    for (const ElementPair& pair : coefficients.moving_pairs) check_pair("moving pair", pair, elements);
    for (const ElementPair& pair : coefficients.crossed_pairs) check_pair("crossed pair", pair, elements);
}

} // namespace kinelux::model
