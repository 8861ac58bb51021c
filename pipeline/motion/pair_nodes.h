// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/element_shape.h"

namespace kinelux::motion {

/// How far integrals by the nodes of a pair may be off; what is left of PairNodes once they are computed.
struct NodeError {
    double kernel = 0.0; ///< estimated Frobenius error of the kernel's block [1]
    int excess = 0;      ///< degrees that the finer rule integrates beyond the basis

    /// The same of the sum over n >= 1 of p^n phi_n: the rules' error grows with the nearness of the singularity, which a
    /// move by p brings nearer by p. @param t  p / least distance, 0 <= t < 1
    double of_move(double t) const;
};

/// Products of the ready nodes of two elements, of those that face each other: one set for a kernel and for all terms of
/// its expansion.
class PairNodes {
public:
    /// The cheapest rules that resolve the kernel, or the finest where none does.
    /// @param a, b       in world position; must outlive this
    /// @param tolerance  of the kernel's block, relative to its size [1]
    PairNodes(const geometry::ElementShape& a, const geometry::ElementShape& b, double tolerance);

    std::size_t block_size() const { return na_ * nb_; } ///< size(a) x size(b)

    /// By the rules' bound, or where the elements are too close for one the difference from the rules one level coarser.
    /// Of elements that wholly face each other.
    const NodeError& error() const { return error_; }

    /// Integrals of phi_k(x) f_m(x, y) phi_l(y) for several functions f_m at once, over nodes that face each other.
    /// @param at  called with the node of a, the node of b, and the values f_0.. to be set
    /// @return    terms x size(a) x size(b)
    template <typename Function>
    std::vector<double> project(std::size_t terms, const Function& at) const {
        return project(*xs_, *ys_, terms, at);
    }

private:
    template <typename Function>
    std::vector<double> project(const geometry::NodeSet& xs, const geometry::NodeSet& ys, std::size_t terms,
                                const Function& at) const;

    const geometry::NodeSet* xs_;
    const geometry::NodeSet* ys_;
    std::size_t na_, nb_;
    NodeError error_;
};

/// Whether two nodes are each in front of the other.
bool face_each_other(const geometry::SurfaceNode& x, const geometry::SurfaceNode& y);

/// K = -(n_x.r)(n_y.r) / (pi r^4), without clamps [1/m2]: the kernel of nodes that face each other.
double facing_kernel(const geometry::SurfaceNode& x, const geometry::SurfaceNode& y);

template <typename Function>
std::vector<double> PairNodes::project(const geometry::NodeSet& xs, const geometry::NodeSet& ys,
                                       std::size_t terms, const Function& at) const {
    std::vector<double> blocks(terms * na_ * nb_, 0.0), gathered(terms * nb_), values(terms);
    for (std::size_t i = 0; i < xs.nodes.size(); ++i) {
        gathered.assign(gathered.size(), 0.0);
        for (std::size_t j = 0; j < ys.nodes.size(); ++j) {
            if (!face_each_other(xs.nodes[i], ys.nodes[j])) continue;
            at(xs.nodes[i], ys.nodes[j], std::span<double>(values));
            for (std::size_t m = 0; m < terms; ++m) {
                const double weighted = values[m] * ys.nodes[j].weight;
                for (std::size_t l = 0; l < nb_; ++l)
                    gathered[m * nb_ + l] += weighted * ys.basis[j * nb_ + l];
            }
        }
        for (std::size_t m = 0; m < terms; ++m)
            for (std::size_t k = 0; k < na_; ++k) {
                const double weighted = xs.nodes[i].weight * xs.basis[i * na_ + k];
                for (std::size_t l = 0; l < nb_; ++l)
                    blocks[(m * na_ + k) * nb_ + l] += weighted * gathered[m * nb_ + l];
            }
    }
    return blocks;
}

} // namespace kinelux::motion
