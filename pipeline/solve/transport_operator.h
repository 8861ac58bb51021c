// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "model/coefficients.h"

namespace kinelux::solve {

/// The symmetric transport G as the solvers see it. Vectors are unknowns x channels, channel fastest.
class TransportOperator {
public:
    virtual ~TransportOperator() = default;
    virtual const model::UnknownLayout& layout() const = 0;
    /// out = sum_j G_ij x_j. @param x  all unknowns; @param out  count(i) x channels, overwritten
    virtual void gather(std::size_t element, std::size_t channels, std::span<const double> x,
                        std::span<double> out) const = 0;
    /// y_j += G_ji x_i for all j. @param x_i  count(i) x channels; @param y  all unknowns
    virtual void scatter(std::size_t element, std::size_t channels, std::span<const double> x_i,
                         std::span<double> y) const = 0;
};

/// y = G x, rows in parallel, the same bytes at any thread count.
void apply(const TransportOperator& transport, std::size_t channels, std::span<const double> x,
           std::span<double> y);

/// Stored blocks: a static set, some of whose pairs another set replaces for now.
class BlockOperator : public TransportOperator {
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

} // namespace kinelux::solve
