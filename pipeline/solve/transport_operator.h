// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "model/coefficients.h"

namespace kinelux::solve {

class RowOperator;

/// The symmetric transport G as the solvers see it. Vectors are unknowns x channels, channel fastest.
class TransportOperator {
public:
    virtual ~TransportOperator() = default;
    virtual const model::UnknownLayout& layout() const = 0;
    /// y = G x, the same bytes at any thread count. @param y  overwritten
    virtual void apply(std::size_t channels, std::span<const double> x, std::span<double> y) const = 0;
    /// The operator by rows, where rows of single elements can be had; else nothing.
    virtual const RowOperator* rows() const { return nullptr; }
};

/// A transport whose rows can be used one by one.
class RowOperator : public TransportOperator {
public:
    /// out = sum_j G_ij x_j. @param x  all unknowns; @param out  count(i) x channels, overwritten
    virtual void gather(std::size_t element, std::size_t channels, std::span<const double> x,
                        std::span<double> out) const = 0;
    /// y_j += G_ji x_i for all j. @param x_i  count(i) x channels; @param y  all unknowns
    virtual void scatter(std::size_t element, std::size_t channels, std::span<const double> x_i,
                         std::span<double> y) const = 0;
    void apply(std::size_t channels, std::span<const double> x, std::span<double> y) const override;
    const RowOperator* rows() const override { return this; }
};

/// y = G x.
void apply(const TransportOperator& transport, std::size_t channels, std::span<const double> x,
           std::span<double> y);

/// Stored blocks: a static set, some of whose pairs another set replaces for now.
class BlockOperator : public RowOperator {
public:
    /// The arguments must outlive the operator.
    BlockOperator(const model::UnknownLayout& layout, const model::BlockSet& static_blocks);

    /// Replaces the blocks of `pairs` (sorted) by those in `blocks` (zero where it has none), until the next call.
    void replace(std::span<const model::ElementPair> pairs, const model::BlockSet& blocks);

    const model::UnknownLayout& layout() const override { return layout_; }
    void gather(std::size_t element, std::size_t channels, std::span<const double> x,
                std::span<double> out) const override;
    void scatter(std::size_t element, std::size_t channels, std::span<const double> x_i,
                 std::span<double> y) const override;

private:
    struct Neighbour {
        std::uint32_t element;
        bool transposed; ///< the stored block is G_(neighbour,this)
        bool replaced;   ///< the static block does not hold now
        const float* values;
    };
    using Rows = std::vector<std::vector<Neighbour>>;
    static Rows rows_of(const model::BlockSet& blocks, std::size_t elements);
    void mark(std::uint32_t element, std::uint32_t neighbour, bool replaced);

    const model::UnknownLayout& layout_;
    Rows static_rows_, replacing_rows_; ///< per element, neighbours in increasing order
    std::vector<model::ElementPair> replaced_;
};

/// Blocks of elements and links between groups together. Has no rows: what one element receives from groups changes with
/// every element below them.
class LinkedOperator : public TransportOperator {
public:
    /// The arguments must outlive the operator. @param blocks  of the elements
    LinkedOperator(const BlockOperator& blocks, const model::Hierarchy& hierarchy);

    const model::UnknownLayout& layout() const override { return blocks_.layout(); }
    void apply(std::size_t channels, std::span<const double> x, std::span<double> y) const override;

private:
    const BlockOperator& blocks_;
    const model::Hierarchy& hierarchy_;
    BlockOperator links_; ///< between all nodes
};

} // namespace kinelux::solve
