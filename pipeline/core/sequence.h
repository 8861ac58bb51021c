// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "core/vec.h"

namespace kinelux::core {

/// A well-mixed 64-bit hash of two numbers (splitmix64 finaliser); the seed of everything that is sampled, so that a
/// sample depends on what it is for and never on which thread drew it.
std::uint64_t mix(std::uint64_t a, std::uint64_t b);

/// Point `index` of the first two dimensions of Sobol's sequence, Owen-scrambled by hashing with `seed`; in [0,1)^2.
/// @cite Burley, Practical Hash-based Owen Scrambling, JCGT 9(4), 2020
Vec2 sobol_2d(std::uint32_t index, std::uint64_t seed);

/// The same of the first four dimensions; in [0,1)^4. The first two are those of sobol_2d with the same seed.
/// @cite direction numbers: Joe and Kuo, Constructing Sobol sequences with better two-dimensional projections, SIAM J.
/// Sci. Comput. 30 (2008), new-joe-kuo-6
std::array<double, 4> sobol_4d(std::uint32_t index, std::uint64_t seed);

/// Uniform random numbers in [0,1): a counter hashed with a seed.
class Random {
public:
    explicit Random(std::uint64_t seed) : seed_(seed) {}
    double next();
    Vec2 next_2d() {
        const double x = next();
        return {x, next()};
    }

private:
    std::uint64_t seed_;
    std::uint64_t counter_ = 0;
};

} // namespace kinelux::core
