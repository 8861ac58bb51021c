// SPDX-License-Identifier: GPL-3.0-or-later
// Key: z irradiance of the dominant mode, u = rho z its radiosity, q its eigenvalue: rho G u = q u, and z is the left
// eigenvector, z^T rho G = q z^T.
#include "solve/error_estimate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/solve.h"
#include "solve/vectors.h"

namespace kinelux::solve {

namespace {

/// <x, rho y> per channel.
std::vector<double> reflected_dots(const System& system, std::span<const double> x,
                                   std::span<const double> y) {
    std::vector<double> sums(system.channels, 0.0);
    for_each_coefficient(
        system.transport.layout(), system.channels,
        [&](std::size_t k, std::size_t m, std::size_t c) { sums[c] += x[k] * system.reflectance[m] * y[k]; });
    return sums;
}

double ratio(double numerator, double denominator) {
    return denominator > 0.0 ? numerator / denominator : 0.0;
}

/// image = G rho z.
void reflect(const System& system, std::span<const double> shape, std::vector<double>& image) {
    std::vector<double> sent(shape.size());
    for_each_coefficient(
        system.transport.layout(), system.channels,
        [&](std::size_t k, std::size_t m, std::size_t) { sent[k] = system.reflectance[m] * shape[k]; });
    image.resize(shape.size());
    system.transport.apply(system.channels, sent, image);
}

/// Scales every channel to a norm of one.
void normalize(std::size_t channels, std::vector<double>& shape) {
    const std::vector<double> squares = channel_dots(channels, shape, shape);
    for (std::size_t k = 0; k < shape.size(); k += channels)
        for (std::size_t c = 0; c < channels; ++c)
            if (squares[c] > 0.0) shape[k + c] /= std::sqrt(squares[c]);
}

} // namespace

std::vector<double> returned_shares(const System& system, const DominantMode& mode) {
    constexpr double most = 0.9999;
    std::vector<double> shares = reflected_dots(system, mode.shape, mode.image);
    const std::vector<double> squares = reflected_dots(system, mode.shape, mode.shape);
    for (std::size_t c = 0; c < shares.size(); ++c)
        shares[c] = std::clamp(ratio(shares[c], squares[c]) + mode.margin[c], 0.0, most);
    return shares;
}

DominantMode dominant_mode(const System& system, std::vector<double> from, std::size_t& products) {
    constexpr double known = 0.05; // of 1 - q
    constexpr int fewest = 3, most = 40;
    DominantMode mode{.shape = std::move(from), .image = {}, .margin = {}, .second = {}};
    if (mode.shape.empty())
        mode.shape = constant_coefficients(system.transport.layout(), system.channels, system.areas,
                                           std::vector<double>(system.reflectance.size(), 1.0));
    mode.margin.assign(system.channels, 0.0);
    mode.second.assign(system.channels, 1.0);
    std::vector<double> last(system.channels, 0.0), last_step(system.channels, 1.0);
    for (int step = 1; step <= most; ++step) {
        if (step > 1) mode.shape = mode.image;
        normalize(system.channels, mode.shape);
        reflect(system, mode.shape, mode.image);
        ++products;
        std::fill(mode.margin.begin(), mode.margin.end(), 0.0);
        const std::vector<double> now = returned_shares(system, mode);
        bool enough = step >= fewest;
        for (std::size_t c = 0; c < system.channels; ++c) {
            // The Rayleigh quotient approaches q by steps that shrink like the square of the second eigenvalue.
            const double change = std::abs(now[c] - last[c]);
            const double shrinks = std::clamp(ratio(change, last_step[c]), 0.0, 0.98);
            mode.second[c] = std::sqrt(shrinks);
            mode.margin[c] = change * shrinks / (1.0 - shrinks);
            enough = enough && mode.margin[c] <= known * (1.0 - now[c]);
            last_step[c] = change;
        }
        last = now;
        if (enough) break;
    }
    // Two steps say little of the second eigenvalue: it counts as a half of the first at least.
    for (double& second : mode.second) second = std::max(second, 0.5);
    return mode;
}

ErrorEstimate::ErrorEstimate(const System& system, const DominantMode& mode)
    : system_(system),
      mode_(mode),
      returned_(returned_shares(system, mode)),
      mode_square_(reflected_dots(system, mode.shape, mode.shape)),
      mode_size_(system.channels, 0.0),
      kept_(mode_square_) {
    constexpr double dark = 1e-6; // of ||M||
    const auto& layout = system.transport.layout();
    counts_.assign(layout.elements(), true);
    for_each_coefficient(layout, system.channels, [&](std::size_t k, std::size_t m, std::size_t) {
        if (system.exitance[k] != 0.0) counts_[m / system.channels] = false;
    });
    if (std::none_of(counts_.begin(), counts_.end(), [](bool counts) { return counts; }))
        counts_.assign(layout.elements(), true);
    for_each_coefficient(layout, system.channels, [&](std::size_t k, std::size_t m, std::size_t c) {
        const double u = system.reflectance[m] * mode.shape[k];
        if (counts_[m / system.channels]) mode_size_[c] += u * u;
    });
    for (double& size : mode_size_) size = std::sqrt(size);
    const std::vector<double> returned = reflected_dots(system, mode.shape, mode.image);
    for (std::size_t c = 0; c < system.channels; ++c) kept_[c] -= returned[c];
    least_size_ = dark * std::sqrt(square_sum(system.exitance));
}

ErrorEstimate::Parts ErrorEstimate::parts(std::span<const double> residual,
                                          std::span<const double> radiosity) const {
    const std::size_t channels = system_.channels;
    std::vector<double> part = channel_dots(channels, mode_.shape, residual), rest(channels, 0.0);
    for (std::size_t c = 0; c < channels; ++c) part[c] = ratio(part[c], mode_square_[c]);
    double size = 0.0;
    for_each_coefficient(
        system_.transport.layout(), channels, [&](std::size_t k, std::size_t m, std::size_t c) {
            const double left = residual[k] - part[c] * system_.reflectance[m] * mode_.shape[k];
            rest[c] += left * left;
            if (counts_[m / channels]) size += radiosity[k] * radiosity[k];
        });
    Parts parts{.size = std::max(std::sqrt(size), least_size_)};
    for (std::size_t c = 0; c < channels; ++c) {
        const double of_mode = std::abs(part[c]) * mode_size_[c] / (1.0 - returned_[c]);
        const double of_rest = std::sqrt(rest[c]) / (1.0 - returned_[c] * mode_.second[c]);
        parts.of_mode += of_mode * of_mode;
        parts.of_rest += of_rest * of_rest;
    }
    return parts;
}

double ErrorEstimate::of(std::span<const double> residual, std::span<const double> radiosity) const {
    const Parts found = parts(residual, radiosity);
    return (std::sqrt(found.of_mode) + std::sqrt(found.of_rest)) / found.size;
}

double ErrorEstimate::of_rest(std::span<const double> residual, std::span<const double> radiosity) const {
    const Parts found = parts(residual, radiosity);
    return std::sqrt(found.of_rest) / found.size;
}

void ErrorEstimate::take_mode_out(SystemSolution& solution) const {
    const std::size_t channels = system_.channels;
    std::vector<double> part(channels, 0.0);
    for (std::size_t k = 0; k < solution.radiosity.size(); k += channels)
        for (std::size_t c = 0; c < channels; ++c)
            part[c] += mode_.shape[k + c] * (system_.exitance[k + c] - solution.radiosity[k + c]) +
                       mode_.image[k + c] * solution.radiosity[k + c];
    for (std::size_t c = 0; c < channels; ++c) part[c] = ratio(part[c], kept_[c]);
    for_each_coefficient(system_.transport.layout(), channels,
                         [&](std::size_t k, std::size_t m, std::size_t c) {
                             solution.radiosity[k] += part[c] * system_.reflectance[m] * mode_.shape[k];
                             solution.irradiance[k] += part[c] * mode_.image[k];
                         });
}

double ErrorEstimate::slowest() const { return *std::max_element(returned_.begin(), returned_.end()); }

} // namespace kinelux::solve
