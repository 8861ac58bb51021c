// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/parallel.h"
#include "solve/transport_operator.h"

namespace kinelux::solve {

namespace {

// out += G x or G^T x for one block; Channels > 0 fixes the number of channels so that the loop unrolls.
template <std::size_t Channels>
void add_product(const float* values, bool transposed, std::size_t rows, std::size_t columns,
                 std::size_t channels, const double* x, double* out) {
    const std::size_t n = Channels > 0 ? Channels : channels;
    const std::size_t row_step = transposed ? 1 : columns;
    const std::size_t column_step = transposed ? rows : 1;
    for (std::size_t k = 0; k < rows; ++k)
        for (std::size_t l = 0; l < columns; ++l) {
            const double value = static_cast<double>(values[k * row_step + l * column_step]);
            for (std::size_t c = 0; c < n; ++c) out[k * n + c] += value * x[l * n + c];
        }
}

void add_block(const float* values, bool transposed, std::size_t rows, std::size_t columns,
               std::size_t channels, const double* x, double* out) {
    if (channels == 1)
        add_product<1>(values, transposed, rows, columns, 1, x, out);
    else if (channels == 3)
        add_product<3>(values, transposed, rows, columns, 3, x, out);
    else
        add_product<0>(values, transposed, rows, columns, channels, x, out);
}

} // namespace

void apply(const TransportOperator& transport, std::size_t channels, std::span<const double> x,
           std::span<double> y) {
    transport.apply(channels, x, y);
}

void RowOperator::apply(std::size_t channels, std::span<const double> x, std::span<double> y) const {
    const auto& rows = layout();
    core::parallel_for(rows.elements(), [&](std::size_t i) {
        gather(i, channels, x, y.subspan(rows.offsets[i] * channels, rows.count(i) * channels));
    });
}

BlockOperator::BlockOperator(const model::UnknownLayout& layout, const model::BlockSet& static_blocks)
    : layout_(layout),
      static_rows_(rows_of(static_blocks, layout.elements())),
      replacing_rows_(layout.elements()) {}

BlockOperator::Rows BlockOperator::rows_of(const model::BlockSet& blocks, std::size_t elements) {
    Rows rows(elements);
    // Entries are sorted by (i, j): every row receives its smaller neighbours (as transposes) before its larger ones.
    for (const model::BlockEntry& entry : blocks.entries)
        if (entry.i != entry.j) rows[entry.j].push_back({entry.i, true, false, &blocks.values[entry.offset]});
    for (const model::BlockEntry& entry : blocks.entries)
        rows[entry.i].push_back({entry.j, false, false, &blocks.values[entry.offset]});
    return rows;
}

void BlockOperator::mark(std::uint32_t element, std::uint32_t neighbour, bool replaced) {
    auto& row = static_rows_[element];
    const auto found = std::lower_bound(row.begin(), row.end(), neighbour,
                                        [](const Neighbour& n, std::uint32_t id) { return n.element < id; });
    if (found != row.end() && found->element == neighbour) found->replaced = replaced;
}

void BlockOperator::replace(std::span<const model::ElementPair> pairs, const model::BlockSet& blocks) {
    for (const model::ElementPair& pair : replaced_) {
        mark(pair.i, pair.j, false);
        mark(pair.j, pair.i, false);
    }
    replaced_.assign(pairs.begin(), pairs.end());
    for (const model::ElementPair& pair : replaced_) {
        mark(pair.i, pair.j, true);
        mark(pair.j, pair.i, true);
    }
    replacing_rows_ = rows_of(blocks, layout_.elements());
}

void BlockOperator::gather(std::size_t element, std::size_t channels, std::span<const double> x,
                           std::span<double> out) const {
    std::fill(out.begin(), out.end(), 0.0);
    const std::size_t rows = layout_.count(element);
    for (const Rows* set : {&static_rows_, &replacing_rows_})
        for (const Neighbour& n : (*set)[element])
            if (!n.replaced)
                add_block(n.values, n.transposed, rows, layout_.count(n.element), channels,
                          &x[layout_.offsets[n.element] * channels], out.data());
}

void BlockOperator::scatter(std::size_t element, std::size_t channels, std::span<const double> x_i,
                            std::span<double> y) const {
    const std::size_t columns = layout_.count(element);
    for (const Rows* set : {&static_rows_, &replacing_rows_})
        for (const Neighbour& n : (*set)[element])
            if (!n.replaced)
                add_block(n.values, !n.transposed, layout_.count(n.element), columns, channels, x_i.data(),
                          &y[layout_.offsets[n.element] * channels]);
}

} // namespace kinelux::solve
