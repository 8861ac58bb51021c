// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace kinelux::motion {

/// What an error of a block does to the light, from an estimate of the light: a block G_ij that is off by e changes the
/// reflected light of i by rho_i e ||b_j|| at most, that of j by rho_j e ||b_i||.
struct Importance {
    std::vector<double> radiosity;   ///< ||b_j||, one per element, the largest over some frames [W/m or lm/m]
    std::vector<double> reflectance; ///< one per element, the largest of the channels [1]
    double size =
        0.0; ///< norm of the radiosity of all elements that do not emit, the least of these frames [W/m or lm/m]
    double bounces = 1.0; ///< what becomes of an error after all bounces, 1 / (1 - mean rho) [1]

    /// Of the pair: change of light per error of its block [W/m or lm/m].
    double of(std::size_t i, std::size_t j) const {
        return std::hypot(reflectance[i] * radiosity[j], reflectance[j] * radiosity[i]);
    }
};

/// Error that the block of each pair may have: all together, independent of each other, change the light by `tolerance`.
class ErrorBudget {
public:
    /// @param tolerance  relative L2 error of radiosity, over elements that do not emit [1]
    /// @param pairs      that change, at least 1
    /// @param better     how much better than asked for most blocks are in most frames, measured [1]
    ErrorBudget(const Importance& importance, double tolerance, std::size_t pairs, double better)
        : importance_(importance),
          share_(better * tolerance * importance.size /
                 (importance.bounces * std::sqrt(static_cast<double>(pairs > 0 ? pairs : 1)))) {}

    /// Frobenius norm of the error of block ij that is allowed [1]; infinite where the block lights nothing.
    double of(std::size_t i, std::size_t j) const {
        const double weight = importance_.of(i, j);
        return weight > 0.0 ? share_ / weight : INFINITY;
    }

private:
    const Importance& importance_;
    double share_;
};

} // namespace kinelux::motion
