// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iterator>
#include <utility>

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
      static_values_(static_blocks.values.size()),
      static_rows_(rows_of(static_blocks, layout.elements())),
      replacing_rows_(layout.elements()),
      removed_rows_(layout.elements()),
      static_left_(layout.elements()),
      static_back_(layout.elements()) {}

BlockOperator::Rows BlockOperator::rows_of(const model::BlockSet& blocks, std::size_t elements) {
    Rows rows(elements);
    // Entries are sorted by (i, j): every row receives its smaller neighbours (as transposes) before its larger ones.
    for (const model::BlockEntry& entry : blocks.entries)
        if (entry.i != entry.j) rows[entry.j].push_back({entry.i, true, false, &blocks.values[entry.offset]});
    for (const model::BlockEntry& entry : blocks.entries)
        rows[entry.i].push_back({entry.j, false, false, &blocks.values[entry.offset]});
    return rows;
}

// Notes whether the static block of a pair holds, in both of its rows; one that exists is added to `changed`.
void BlockOperator::mark(const model::ElementPair& pair, bool replaced, Rows& changed) {
    const auto mark_one = [&](std::uint32_t element, std::uint32_t neighbour) {
        auto& row = static_rows_[element];
        const auto found =
            std::lower_bound(row.begin(), row.end(), neighbour,
                             [](const Neighbour& n, std::uint32_t id) { return n.element < id; });
        if (found == row.end() || found->element != neighbour) return;
        found->replaced = replaced;
        changed[element].push_back({neighbour, found->transposed, false, found->values});
    };
    mark_one(pair.i, pair.j);
    if (pair.i != pair.j) mark_one(pair.j, pair.i);
}

void BlockOperator::replace(std::span<const model::ElementPair> pairs, model::BlockSet blocks) {
    // Moved vectors keep their values where they are: the rows of the version before stay valid.
    replaced_before_ = std::move(replacing_);
    removed_rows_ = std::move(replacing_rows_);
    replacing_ = std::move(blocks);
    replacing_rows_ = rows_of(replacing_, layout_.elements());
    static_left_.assign(layout_.elements(), {});
    static_back_.assign(layout_.elements(), {});
    std::vector<model::ElementPair> differing;
    std::set_difference(replaced_.begin(), replaced_.end(), pairs.begin(), pairs.end(),
                        std::back_inserter(differing));
    for (const model::ElementPair& pair : differing) mark(pair, false, static_back_);
    differing.clear();
    std::set_difference(pairs.begin(), pairs.end(), replaced_.begin(), replaced_.end(),
                        std::back_inserter(differing));
    for (const model::ElementPair& pair : differing) mark(pair, true, static_left_);
    replaced_.assign(pairs.begin(), pairs.end());
    ++version_;
}

void BlockOperator::add_row(const std::vector<Neighbour>& row, std::size_t element, std::size_t channels,
                            std::span<const double> x, std::span<double> out) const {
    for (const Neighbour& n : row)
        if (!n.replaced)
            add_block(n.values, n.transposed, layout_.count(element), layout_.count(n.element), channels,
                      &x[layout_.offsets[n.element] * channels], out.data());
}

void BlockOperator::gather(std::size_t element, std::size_t channels, std::span<const double> x,
                           std::span<double> out) const {
    std::fill(out.begin(), out.end(), 0.0);
    add_row(static_rows_[element], element, channels, x, out);
    add_row(replacing_rows_[element], element, channels, x, out);
}

void BlockOperator::apply_change(std::size_t channels, std::span<const double> x, std::span<double> y) const {
    core::parallel_for(layout_.elements(), [&](std::size_t i) {
        const auto now = y.subspan(layout_.offsets[i] * channels, layout_.count(i) * channels);
        std::fill(now.begin(), now.end(), 0.0);
        std::vector<double> before(now.size(), 0.0);
        add_row(replacing_rows_[i], i, channels, x, now);
        add_row(static_back_[i], i, channels, x, now);
        add_row(removed_rows_[i], i, channels, x, before);
        add_row(static_left_[i], i, channels, x, before);
        for (std::size_t k = 0; k < now.size(); ++k) now[k] -= before[k];
    });
}

double BlockOperator::changed_share() const {
    // Each block stands in two rows, in one when it is its element's with itself; halving both counts is exact enough.
    std::size_t in_rows = 0;
    for (const Rows* rows : {&static_left_, &static_back_})
        for (std::size_t i = 0; i < rows->size(); ++i)
            for (const Neighbour& n : (*rows)[i]) in_rows += layout_.count(i) * layout_.count(n.element);
    const std::size_t changed = replacing_.values.size() + replaced_before_.values.size() + in_rows / 2;
    const std::size_t all = static_values_ + replacing_.values.size();
    return all == 0 ? 0.0 : static_cast<double>(changed) / static_cast<double>(all);
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
