// SPDX-License-Identifier: GPL-3.0-or-later
// Key: S = sqrt(rho); c the unknown; r = S G M - (I - S G S) c its residual, S r that of B; p the direction; q = p - S G S p.
#include "solve/conjugate_gradients.h"

#include <algorithm>
#include <cmath>

namespace kinelux::solve {

namespace {

// Per unknown and channel: the root of the reflectance.
std::vector<double> reflectance_roots(const System& system) {
    const auto& layout = system.transport.layout();
    std::vector<double> roots(system.exitance.size());
    for (std::size_t i = 0; i < layout.elements(); ++i)
        for (std::size_t u = layout.offsets[i]; u < layout.offsets[i + 1]; ++u)
            for (std::size_t c = 0; c < system.channels; ++c)
                roots[u * system.channels + c] = std::sqrt(system.reflectance[i * system.channels + c]);
    return roots;
}

std::vector<double> dots(std::size_t channels, std::span<const double> x, std::span<const double> y) {
    std::vector<double> sums(channels, 0.0);
    for (std::size_t k = 0; k < x.size(); ++k) sums[k % channels] += x[k] * y[k];
    return sums;
}

double norm_of_product(std::span<const double> x, std::span<const double> y) {
    double sum = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) sum += x[k] * y[k] * x[k] * y[k];
    return std::sqrt(sum);
}

double ratio(double numerator, double denominator) {
    return denominator > 0.0 ? numerator / denominator : 0.0;
}

class Iteration {
public:
    Iteration(const System& system, SystemSolution& solution)
        : system_(system), solution_(solution), roots_(reflectance_roots(system)), scaled_(roots_.size()) {}

    // c and r from the radiosity: where nothing is reflected the radiosity is the exitance.
    void start() {
        const std::size_t n = roots_.size();
        unknown_.assign(n, 0.0);
        for (std::size_t k = 0; k < n; ++k)
            if (roots_[k] > 0.0) unknown_[k] = (solution_.radiosity[k] - system_.exitance[k]) / roots_[k];
        update_radiosity();
        update_irradiance();
        residual_.resize(n);
        for (std::size_t k = 0; k < n; ++k) residual_[k] = roots_[k] * solution_.irradiance[k] - unknown_[k];
        direction_ = residual_;
        residual_square_ = dots(system_.channels, residual_, residual_);
    }

    double residual_norm() const { return norm_of_product(roots_, residual_); }

    void step() {
        const std::size_t n = roots_.size(), channels = system_.channels;
        for (std::size_t k = 0; k < n; ++k) scaled_[k] = roots_[k] * direction_[k];
        system_.transport.apply(channels, scaled_, solution_.irradiance);
        std::vector<double>& image = scaled_;
        for (std::size_t k = 0; k < n; ++k) image[k] = direction_[k] - roots_[k] * solution_.irradiance[k];
        const std::vector<double> curvature = dots(channels, direction_, image);
        for (std::size_t k = 0; k < n; ++k) {
            const double length = ratio(residual_square_[k % channels], curvature[k % channels]);
            unknown_[k] += length * direction_[k];
            residual_[k] -= length * image[k];
        }
        const std::vector<double> square = dots(channels, residual_, residual_);
        for (std::size_t k = 0; k < n; ++k)
            direction_[k] =
                residual_[k] + ratio(square[k % channels], residual_square_[k % channels]) * direction_[k];
        residual_square_ = square;
    }

    void update_radiosity() {
        for (std::size_t k = 0; k < roots_.size(); ++k)
            solution_.radiosity[k] = system_.exitance[k] + roots_[k] * unknown_[k];
    }

    void update_irradiance() {
        system_.transport.apply(system_.channels, solution_.radiosity, solution_.irradiance);
    }

private:
    const System& system_;
    SystemSolution& solution_;
    std::vector<double> roots_, scaled_, unknown_, residual_, direction_;
    std::vector<double> residual_square_; ///< per channel
};

} // namespace

void conjugate_gradients(const System& system, const SolveOptions& options, double scale,
                         SystemSolution& solution) {
    Iteration iteration(system, solution);
    iteration.start();
    ++solution.sweeps;
    // The residual carried along drifts from the true one; a restart from the true one costs one product.
    while (iteration.residual_norm() > options.tolerance * scale && solution.sweeps < options.max_sweeps) {
        while (iteration.residual_norm() > options.tolerance * scale &&
               solution.sweeps < options.max_sweeps) {
            iteration.step();
            ++solution.sweeps;
        }
        iteration.update_radiosity();
        iteration.start();
        ++solution.sweeps;
    }
}

} // namespace kinelux::solve
