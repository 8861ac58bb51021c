// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "model/coefficients.h"

// Sums and loops over vectors of unknowns x channels, channel fastest; all in a fixed order.
namespace kinelux::solve {

/// Calls f(k, m, c) for every coefficient: k its place in the vector, m = element * channels + c that of its element's
/// reflectance, c its channel.
template <class Function>
void for_each_coefficient(const model::UnknownLayout& layout, std::size_t channels, Function f) {
    for (std::size_t i = 0; i < layout.elements(); ++i)
        for (std::size_t u = layout.offsets[i]; u < layout.offsets[i + 1]; ++u)
            for (std::size_t c = 0; c < channels; ++c) f(u * channels + c, i * channels + c, c);
}

inline double square_sum(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return sum;
}

/// One sum of x y per channel.
inline std::vector<double> channel_dots(std::size_t channels, std::span<const double> x,
                                        std::span<const double> y) {
    std::vector<double> sums(channels, 0.0);
    for (std::size_t k = 0; k < x.size(); k += channels)
        for (std::size_t c = 0; c < channels; ++c) sums[c] += x[k + c] * y[k + c];
    return sums;
}

/// Vectors that go through G together, so that every block is read once: channels x vectors, vector by vector fastest.
inline std::vector<double> packed(const std::vector<std::vector<double>>& vectors, std::size_t channels) {
    const std::size_t size = vectors.front().size(), width = channels * vectors.size();
    std::vector<double> all(size * vectors.size());
    for (std::size_t v = 0; v < vectors.size(); ++v)
        for (std::size_t u = 0; u < size / channels; ++u)
            for (std::size_t c = 0; c < channels; ++c)
                all[u * width + v * channels + c] = vectors[v][u * channels + c];
    return all;
}

/// Sets or adds vector `v` of `count` that are packed in `all`.
enum class Into : std::uint8_t { Set, Add };
inline void unpack(std::span<const double> all, std::size_t v, std::size_t count, std::size_t channels,
                   Into into, std::vector<double>& vector) {
    const std::size_t width = channels * count;
    for (std::size_t u = 0; u < vector.size() / channels; ++u)
        for (std::size_t c = 0; c < channels; ++c) {
            double& value = vector[u * channels + c];
            value = all[u * width + v * channels + c] + (into == Into::Add ? value : 0.0);
        }
}

} // namespace kinelux::solve
