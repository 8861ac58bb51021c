// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/sequence.h"

#include <array>

namespace kinelux::core {

namespace {

constexpr double two_to_minus_32 = 1.0 / 4294967296.0;
constexpr double two_to_minus_53 = 1.0 / 9007199254740992.0;

std::uint32_t reverse_bits(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    return __builtin_bswap32(x);
}

// Sobol's second dimension: the direction numbers of the primitive polynomial x + 1 are the rows of Pascal's triangle
// modulo 2, each v_{k+1} = v_k xor (v_k >> 1).
std::uint32_t sobol_second(std::uint32_t index) {
    std::uint32_t result = 0;
    for (std::uint32_t v = 1u << 31; index != 0; index >>= 1, v ^= v >> 1)
        if (index & 1u) result ^= v;
    return result;
}

// Direction numbers of one dimension by Sobol's recurrence of a primitive polynomial over the integers modulo 2, whose
// inner coefficients are the bits of `inner`, from the first odd numbers m.
template <std::size_t degree>
std::array<std::uint32_t, 32> direction_numbers(const std::array<std::uint32_t, degree>& m,
                                                std::uint32_t inner) {
    std::array<std::uint32_t, 32> v{};
    for (std::size_t k = 0; k < degree; ++k) v[k] = m[k] << (31 - k);
    for (std::size_t k = degree; k < 32; ++k) {
        v[k] = v[k - degree] ^ (v[k - degree] >> degree);
        for (std::size_t i = 1; i < degree; ++i)
            if ((inner >> (degree - 1 - i)) & 1u) v[k] ^= v[k - i];
    }
    return v;
}

std::uint32_t sobol_by(const std::array<std::uint32_t, 32>& directions, std::uint32_t index) {
    std::uint32_t result = 0;
    for (std::size_t k = 0; index != 0; index >>= 1, ++k)
        if (index & 1u) result ^= directions[k];
    return result;
}

// A hash in which each bit depends on lower bits only: applied to reversed bits it is a nested uniform scramble.
std::uint32_t laine_karras(std::uint32_t x, std::uint32_t seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
    return reverse_bits(laine_karras(reverse_bits(x), seed));
}

} // namespace

std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
    std::uint64_t z = a + 0x9e3779b97f4a7c15ull * (b + 1);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

Vec2 sobol_2d(std::uint32_t index, std::uint64_t seed) {
    const std::uint64_t seeds = mix(seed, 0);
    const auto shuffled = owen_scramble(index, static_cast<std::uint32_t>(mix(seed, 1)));
    const auto x = owen_scramble(reverse_bits(shuffled), static_cast<std::uint32_t>(seeds));
    const auto y = owen_scramble(sobol_second(shuffled), static_cast<std::uint32_t>(seeds >> 32));
    return {x * two_to_minus_32, y * two_to_minus_32};
}

std::array<double, 4> sobol_4d(std::uint32_t index, std::uint64_t seed) {
    static const auto third = direction_numbers<2>({1, 3}, 1), fourth = direction_numbers<3>({1, 3, 1}, 1);
    const Vec2 first = sobol_2d(index, seed);
    const std::uint64_t seeds = mix(seed, 2);
    const auto shuffled = owen_scramble(index, static_cast<std::uint32_t>(mix(seed, 1)));
    const auto z = owen_scramble(sobol_by(third, shuffled), static_cast<std::uint32_t>(seeds));
    const auto w = owen_scramble(sobol_by(fourth, shuffled), static_cast<std::uint32_t>(seeds >> 32));
    return {first.x, first.y, z * two_to_minus_32, w * two_to_minus_32};
}

double Random::next() { return static_cast<double>(mix(seed_, counter_++) >> 11) * two_to_minus_53; }

} // namespace kinelux::core
