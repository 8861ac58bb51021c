// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/transport.h"
#include "motion/changing_pairs.h"

namespace kinelux::motion {

/// One pair's block over the frames of an animation: pieces of polynomials through exact blocks at some frames.
///
/// Where nothing stands between, the nodes are those of Chebyshev and Lobatto (3, 5 or 9, moved onto frames); each set holds
/// the one before, whose error at the nodes that are new is measured, and the error of the new set follows from how much
/// the last steps brought. Where something may stand between, blocks have kinks: quadratics over quarters of a piece,
/// checked at two frames. What is not good enough is halved, down to exact blocks at all frames.
class BlockPath {
public:
    static constexpr std::size_t most_nodes = 9;

    /// @param size   values of the block
    /// @param bound  no block of this pair has a larger norm; infinite where nothing is known [1]
    BlockPath(std::size_t size, double bound) : size_(size), bound_(bound) {}

    // While it is made.
    /// A block that has to be integrated.
    struct Request {
        std::uint32_t frame;
        Change change;
    };
    /// Frames first..last, through which the pair is `change`: Clear, Horizon, Near or Shaded. Later runs begin later, at the
    /// last frame of one before at the earliest.
    void add_run(Change change, std::uint32_t first, std::uint32_t last);
    bool finished() const { return open_.empty(); }
    std::vector<Request> requests() const; ///< sorted by frame, each frame once; none asked for twice
    void set(std::uint32_t frame, const kernel::TransportBlock& block);
    /// Accepts, refines or halves what is open; all requests have been set. @param tolerance  Frobenius norm [1]
    void judge(double tolerance);
    /// Forgets the blocks that no piece needs, once finished.
    void compact();

    // Afterwards.
    struct Value {
        double error = 0.0;      ///< Frobenius norm, of interpolation and integration [1]
        bool integrated = false; ///< at this very frame
    };
    /// Whether the block is not the static one (nor zero where there is none) from one frame to another.
    bool covers(std::uint32_t first, std::uint32_t last) const { return piece_at(first, last) != nullptr; }
    /// @param frame  first..last of a piece that covers its neighbours; between frames the polynomial
    /// @param values  size of the block, overwritten
    Value at(double frame, std::span<double> values) const;

    std::size_t size() const { return size_; }
    std::size_t samples() const { return samples_.size(); } ///< blocks held
    std::uint64_t integrated() const { return integrated_; }
    std::size_t bytes() const;

private:
    struct Sample {
        std::uint32_t frame;
        float error;
        std::uint32_t place; ///< into values_, in blocks; `zero`
    };
    struct Span {
        std::uint32_t first, last;
        Change change;
        std::uint8_t level = 0; ///< 0: three frames are looked at, 1: five, 2: nine, `all`: each
    };
    struct Piece {
        std::uint32_t first, last;
        float error;         ///< of interpolation
        std::uint32_t count; ///< of nodes; 0 = every frame has its own block
        std::array<std::uint32_t, most_nodes> nodes;
    };
    static constexpr std::uint32_t zero = static_cast<std::uint32_t>(-1);
    static constexpr std::uint8_t all = 255;

    static std::vector<std::uint32_t> frames_of(const Span& span);
    const Piece* piece_at(std::uint32_t first, std::uint32_t last) const;
    const Sample* find(std::uint32_t frame) const;
    double interpolate(std::span<const std::uint32_t> nodes, double frame, std::span<double> values) const;
    double deviation(std::span<const std::uint32_t> nodes, std::uint32_t check) const;
    double norm(std::uint32_t frame) const;
    void accept(const Span& span, std::span<const std::uint32_t> nodes, double error);
    void judge_clear(const Span& span, double tolerance);
    void judge_shaded(const Span& span, double tolerance);
    bool negligible(const Span& span, std::span<const std::uint32_t> frames, double tolerance);
    void halve(const Span& span, std::uint32_t middle);
    void take_all(const Span& span);

    std::size_t size_;
    double bound_;
    std::vector<Sample> samples_; ///< sorted by frame
    std::vector<float> values_;
    std::vector<Span> open_;
    std::vector<Piece> pieces_; ///< sorted; neighbours may share a frame
    std::uint64_t integrated_ = 0;
};

} // namespace kinelux::motion
