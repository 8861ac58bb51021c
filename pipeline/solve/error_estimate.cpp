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

/// Scales every channel to a norm of one. @return  the norms before, per channel
std::vector<double> normalize(std::size_t channels, std::vector<double>& shape) {
    std::vector<double> norms = channel_dots(channels, shape, shape);
    for (double& norm : norms) norm = std::sqrt(norm);
    for (std::size_t k = 0; k < shape.size(); k += channels)
        for (std::size_t c = 0; c < channels; ++c)
            if (norms[c] > 0.0) shape[k + c] /= norms[c];
    return norms;
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

namespace {

/// Light that is brighter from element to element: every mode is in it, so that the decay of the second can be seen.
std::vector<double> ramp(const System& system) {
    std::vector<double> values(system.reflectance.size());
    for (std::size_t m = 0; m < values.size(); ++m)
        values[m] = 0.5 + static_cast<double>(m) / static_cast<double>(values.size());
    return constant_coefficients(system.transport.layout(), system.channels, system.areas, values);
}

/// What a power iteration knows of the eigenvalues of one channel.
struct Seen {
    double first = 0.0, step = 1.0; ///< Rayleigh quotient, and what it last changed by
    double second = 0.0, second_step = 1.0;

    /// Rayleigh quotients approach by steps that shrink like the square of the ratio of eigenvalues: what is to come.
    double margin(double ratio) const { return step * ratio * ratio / (1.0 - ratio * ratio); }
};

} // namespace

DominantMode dominant_mode(const System& system, DominantMode mode, std::size_t& products) {
    constexpr double known = 0.05; // of 1 - eigenvalue
    constexpr double largest_ratio = 0.99;
    constexpr int fewest = 4, most = 40;
    const std::size_t channels = system.channels;
    if (mode.shape.empty()) {
        mode.shape = ramp(system);
        mode.second.assign(channels, 0.5);
    }
    mode.margin.assign(channels, 0.0);
    std::vector<Seen> seen(channels);
    std::vector<double> gap, last_gap; // G rho z - q z: what is left of the other modes
    bool enough = false;
    for (int step = 1; step <= most && !enough; ++step) {
        if (step > 1) mode.shape = mode.image;
        const std::vector<double> scale = normalize(channels, mode.shape);
        reflect(system, mode.shape, mode.image);
        ++products;
        std::fill(mode.margin.begin(), mode.margin.end(), 0.0);
        const std::vector<double> first = returned_shares(system, mode);
        gap = mode.image;
        for (std::size_t k = 0; k < gap.size(); ++k) gap[k] -= first[k % channels] * mode.shape[k];
        const std::vector<double> product = last_gap.empty() ? std::vector<double>(channels, 0.0)
                                                             : reflected_dots(system, last_gap, gap),
                                  square =
                                      last_gap.empty() ? product : reflected_dots(system, last_gap, last_gap);
        enough = step >= fewest;
        for (std::size_t c = 0; c < channels; ++c) {
            Seen& now = seen[c];
            now.step = std::abs(first[c] - now.first);
            now.first = first[c];
            const double second = scale[c] * std::abs(ratio(product[c], square[c]));
            now.second_step = std::abs(second - now.second);
            now.second = second;
            if (first[c] > 0.0 && second > 0.0)
                mode.second[c] = std::clamp((second + now.second_step) / first[c], 0.5, largest_ratio);
            mode.margin[c] = now.margin(mode.second[c]);
            enough = enough && mode.margin[c] <= known * (1.0 - first[c]) &&
                     now.second_step <= 2.0 * known * (1.0 - second);
        }
        last_gap = gap;
    }
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

double ErrorEstimate::second_slowest() const {
    double largest = 0.0;
    for (std::size_t c = 0; c < returned_.size(); ++c)
        largest = std::max(largest, returned_[c] * mode_.second[c]);
    return largest;
}

double ErrorEstimate::slowest() const { return *std::max_element(returned_.begin(), returned_.end()); }

} // namespace kinelux::solve
