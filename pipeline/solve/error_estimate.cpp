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

/// G rho z and G rho y in one product.
void reflect(const System& system, const std::vector<double>& z, const std::vector<double>& y,
             std::vector<double>& image_z, std::vector<double>& image_y) {
    std::vector<std::vector<double>> sent{z, y};
    for (auto& vector : sent)
        for_each_coefficient(
            system.transport.layout(), system.channels,
            [&](std::size_t k, std::size_t m, std::size_t) { vector[k] *= system.reflectance[m]; });
    const std::vector<double> all = packed(sent, system.channels);
    std::vector<double> images(all.size());
    system.transport.apply(2 * system.channels, all, images);
    image_z.resize(z.size());
    image_y.resize(y.size());
    unpack(images, 0, 2, system.channels, Into::Set, image_z);
    unpack(images, 1, 2, system.channels, Into::Set, image_y);
}

/// Scales every channel to a norm of one.
void normalize(std::size_t channels, std::vector<double>& shape) {
    const std::vector<double> squares = channel_dots(channels, shape, shape);
    for (std::size_t k = 0; k < shape.size(); k += channels)
        for (std::size_t c = 0; c < channels; ++c)
            if (squares[c] > 0.0) shape[k + c] /= std::sqrt(squares[c]);
}

/// Takes out of y its part along z, per channel.
void take_out(const System& system, const std::vector<double>& z, std::vector<double>& y) {
    const std::vector<double> shared = reflected_dots(system, y, z), square = reflected_dots(system, z, z);
    for (std::size_t k = 0; k < y.size(); k += system.channels)
        for (std::size_t c = 0; c < system.channels; ++c) y[k + c] -= ratio(shared[c], square[c]) * z[k + c];
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

/// The Rayleigh quotient of one eigenvalue, and what it last changed by.
struct Seen {
    double value = 0.0, step = 1.0;

    void note(double now) {
        step = std::abs(now - value);
        value = now;
    }
    bool within(double share) const { return step <= share * (1.0 - value); }
};

} // namespace

DominantMode dominant_mode(const System& system, DominantMode mode, std::size_t& products) {
    constexpr double known = 0.05; // of 1 - eigenvalue
    constexpr double least_ratio = 0.5, largest_ratio = 0.99;
    constexpr int fewest = 6, most = 40;
    const std::size_t channels = system.channels, size = system.exitance.size();
    if (mode.shape.empty())
        mode.shape = constant_coefficients(system.transport.layout(), channels, system.areas,
                                           std::vector<double>(system.reflectance.size(), 1.0));
    mode.margin.assign(channels, 0.0);
    mode.second.assign(channels, least_ratio);
    std::vector<double> other(size), other_image; // y, which becomes the second mode
    for (std::size_t k = 0; k < size; ++k) other[k] = std::sin(static_cast<double>(k + 1));
    std::vector<Seen> first(channels), second(channels);
    bool enough = false;
    for (int step = 1; step <= most && !enough; ++step) {
        if (step > 1) {
            mode.shape = mode.image;
            other = other_image;
        }
        take_out(system, mode.shape, other);
        normalize(channels, mode.shape);
        normalize(channels, other);
        reflect(system, mode.shape, other, mode.image, other_image);
        ++products;
        const std::vector<double> shares = returned_shares(system, mode),
                                  other_shares = reflected_dots(system, other, other_image),
                                  other_square = reflected_dots(system, other, other);
        enough = step >= fewest;
        for (std::size_t c = 0; c < channels; ++c) {
            first[c].note(shares[c]);
            second[c].note(std::abs(ratio(other_shares[c], other_square[c])));
            enough = enough && first[c].within(known) && second[c].within(known);
        }
    }
    for (std::size_t c = 0; c < channels; ++c) {
        // Quotients approach by steps that shrink like the square of the ratio of eigenvalues.
        const double bound = second[c].value + second[c].step;
        mode.second[c] = std::clamp(ratio(bound, first[c].value), least_ratio, largest_ratio);
        const double shrinks = mode.second[c] * mode.second[c];
        mode.margin[c] = first[c].step * shrinks / (1.0 - shrinks);
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
