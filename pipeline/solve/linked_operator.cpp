// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/hierarchy.h"
#include "solve/transport_operator.h"

namespace kinelux::solve {

LinkedOperator::LinkedOperator(const BlockOperator& blocks, const model::Hierarchy& hierarchy)
    : blocks_(blocks), hierarchy_(hierarchy), links_(hierarchy.layout, hierarchy.links) {}

void LinkedOperator::apply(std::size_t channels, std::span<const double> x, std::span<double> y) const {
    blocks_.apply(channels, x, y);
    const std::vector<double> sent = model::gather_groups(hierarchy_, channels, x);
    std::vector<double> arrived(sent.size());
    links_.apply(channels, sent, arrived);
    model::spread_groups(hierarchy_, channels, arrived, y);
}

} // namespace kinelux::solve
