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

    /// Counts the states G has been in: what was computed from G at one version holds as long as it is the same.
    virtual std::uint64_t version() const { return 0; }
    /// y = (G - G before the last change of version) x. @param y  overwritten
    virtual void apply_change(std::size_t channels, std::span<const double> x, std::span<double> y) const = 0;
    /// What apply_change() reads, as a share of what apply() reads [1]; above 1 a new product is cheaper.
    virtual double changed_share() const { return 0.0; }
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
    void replace(std::span<const model::ElementPair> pairs, model::BlockSet blocks);

    const model::UnknownLayout& layout() const override { return layout_; }
    void gather(std::size_t element, std::size_t channels, std::span<const double> x,
                std::span<double> out) const override;
    void scatter(std::size_t element, std::size_t channels, std::span<const double> x_i,
                 std::span<double> y) const override;
    std::uint64_t version() const override { return version_; }
    void apply_change(std::size_t channels, std::span<const double> x, std::span<double> y) const override;
    double changed_share() const override;

private:
    struct Neighbour {
        std::uint32_t element;
        bool transposed; ///< the stored block is G_(neighbour,this)
        bool replaced;   ///< the static block does not hold now
        const float* values;
    };
    using Rows = std::vector<std::vector<Neighbour>>;
    static Rows rows_of(const model::BlockSet& blocks, std::size_t elements);
    void mark(const model::ElementPair& pair, bool replaced, Rows& changed);
    void add_row(const std::vector<Neighbour>& row, std::size_t element, std::size_t channels,
                 std::span<const double> x, std::span<double> out) const;

    const model::UnknownLayout& layout_;
    std::size_t static_values_;
    model::BlockSet replacing_, replaced_before_; ///< blocks of this version and of the one before
    Rows static_rows_, replacing_rows_;           ///< per element, neighbours in increasing order
    Rows removed_rows_;                           ///< of `replaced_before_`
    Rows static_left_, static_back_;              ///< static blocks that hold no longer, or again
    std::vector<model::ElementPair> replaced_;
    std::uint64_t version_ = 0;
};

/// Blocks of elements and links between groups together. Has no rows: what one element receives from groups changes with
/// every element below them.
class LinkedOperator : public TransportOperator {
public:
    /// The arguments must outlive the operator. @param blocks  of the elements
    LinkedOperator(const BlockOperator& blocks, const model::Hierarchy& hierarchy);

    const model::UnknownLayout& layout() const override { return blocks_.layout(); }
    void apply(std::size_t channels, std::span<const double> x, std::span<double> y) const override;
    std::uint64_t version() const override { return blocks_.version(); }
    /// Links never change.
    void apply_change(std::size_t channels, std::span<const double> x, std::span<double> y) const override {
        blocks_.apply_change(channels, x, y);
    }
    double changed_share() const override { return blocks_.changed_share(); }

private:
    const BlockOperator& blocks_;
    const model::Hierarchy& hierarchy_;
    BlockOperator links_; ///< between all nodes
};

} // namespace kinelux::solve
