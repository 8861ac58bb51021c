// SPDX-License-Identifier: GPL-3.0-or-later
// Key: S = sqrt(rho); c the unknown; r = S G M - (I - S G S) c its residual, S r that of B; p the direction; q = p - S G S p.
#include "solve/conjugate_gradients.h"

#include <cmath>

#include "solve/vectors.h"

namespace kinelux::solve {

namespace {

double ratio(double numerator, double denominator) {
    return denominator > 0.0 ? numerator / denominator : 0.0;
}

class Iteration {
public:
    Iteration(const System& system, const ErrorEstimate& estimate, SystemSolution& solution)
        : system_(system),
          estimate_(estimate),
          solution_(solution),
          roots_(system.exitance.size()),
          scaled_(roots_.size()),
          unknown_(roots_.size()),
          residual_(roots_.size()) {
        for_each_coefficient(
            system.transport.layout(), system.channels,
            [&](std::size_t k, std::size_t m, std::size_t) { roots_[k] = std::sqrt(system.reflectance[m]); });
    }

    // c and r from the radiosity and its irradiance.
    void start() {
        for (std::size_t k = 0; k < roots_.size(); ++k) {
            unknown_[k] = roots_[k] > 0.0 ? (solution_.radiosity[k] - system_.exitance[k]) / roots_[k] : 0.0;
            residual_[k] = roots_[k] * solution_.irradiance[k] - unknown_[k];
        }
        direction_ = residual_;
        residual_square_ = channel_dots(system_.channels, residual_, residual_);
    }

    double error() {
        for (std::size_t k = 0; k < roots_.size(); ++k) scaled_[k] = roots_[k] * residual_[k];
        return estimate_.of(scaled_, solution_.radiosity);
    }

    void step() {
        const std::size_t n = roots_.size(), channels = system_.channels;
        for (std::size_t k = 0; k < n; ++k) scaled_[k] = roots_[k] * direction_[k];
        system_.transport.apply(channels, scaled_, solution_.irradiance);
        std::vector<double>& image = scaled_;
        for (std::size_t k = 0; k < n; ++k) image[k] = direction_[k] - roots_[k] * solution_.irradiance[k];
        std::vector<double> length = channel_dots(channels, direction_, image);
        for (std::size_t c = 0; c < channels; ++c) length[c] = ratio(residual_square_[c], length[c]);
        for (std::size_t k = 0; k < n; k += channels)
            for (std::size_t c = 0; c < channels; ++c) {
                unknown_[k + c] += length[c] * direction_[k + c];
                residual_[k + c] -= length[c] * image[k + c];
            }
        const std::vector<double> square = channel_dots(channels, residual_, residual_);
        for (std::size_t k = 0; k < n; k += channels)
            for (std::size_t c = 0; c < channels; ++c)
                direction_[k + c] =
                    residual_[k + c] + ratio(square[c], residual_square_[c]) * direction_[k + c];
        residual_square_ = square;
        for (std::size_t k = 0; k < n; ++k)
            solution_.radiosity[k] = system_.exitance[k] + roots_[k] * unknown_[k];
    }

    void update_irradiance() {
        system_.transport.apply(system_.channels, solution_.radiosity, solution_.irradiance);
    }

private:
    const System& system_;
    const ErrorEstimate& estimate_;
    SystemSolution& solution_;
    std::vector<double> roots_, scaled_, unknown_, residual_, direction_;
    std::vector<double> residual_square_; ///< per channel
};

} // namespace

void conjugate_gradients(const System& system, const SolveOptions& options, const ErrorEstimate& estimate,
                         SystemSolution& solution) {
    Iteration iteration(system, estimate, solution);
    iteration.start();
    // The residual carried along drifts from the true one; a restart from the true one costs one product.
    for (double again = 0.0; iteration.error() > options.tolerance && solution.sweeps < options.max_sweeps;
         again = 1.0) {
        solution.sweeps += again; // the product below was not the last one
        do {
            iteration.step();
            solution.sweeps += 1.0;
        } while (iteration.error() > options.tolerance && solution.sweeps < options.max_sweeps);
        iteration.update_irradiance();
        iteration.start();
    }
}

} // namespace kinelux::solve
