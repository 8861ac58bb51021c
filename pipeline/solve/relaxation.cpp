// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/relaxation.h"

#include <algorithm>
#include <cmath>

#include "solve/vectors.h"

namespace kinelux::solve {

namespace {

// One sweep in place; the change of every coefficient.
void sweep(const System& system, const RowOperator& rows, std::vector<double>& radiosity,
           std::vector<double>& change) {
    const auto& layout = system.transport.layout();
    const std::size_t channels = system.channels;
    std::vector<double> gathered;
    for (std::size_t i = 0; i < layout.elements(); ++i) {
        const std::size_t first = layout.offsets[i] * channels;
        gathered.resize(layout.count(i) * channels);
        rows.gather(i, channels, radiosity, gathered);
        for (std::size_t k = 0; k < gathered.size(); ++k) {
            const double rho = system.reflectance[i * channels + k % channels];
            const double value = system.exitance[first + k] + rho * gathered[k];
            change[first + k] = value - radiosity[first + k];
            radiosity[first + k] = value;
        }
    }
}

// The element with the most unshot flux.
std::size_t brightest(const System& system, std::span<const double> unshot) {
    const auto& layout = system.transport.layout();
    std::size_t shooter = 0;
    double most = -1.0;
    for (std::size_t i = 0; i < layout.elements(); ++i) {
        const double square = square_sum(
            unshot.subspan(layout.offsets[i] * system.channels, layout.count(i) * system.channels));
        if (square * system.areas[i] > most) {
            most = square * system.areas[i];
            shooter = i;
        }
    }
    return shooter;
}

} // namespace

std::vector<double> residual_of(const System& system, std::span<const double> radiosity,
                                std::span<const double> irradiance) {
    std::vector<double> residual(radiosity.size());
    for_each_coefficient(
        system.transport.layout(), system.channels, [&](std::size_t k, std::size_t m, std::size_t) {
            residual[k] = system.exitance[k] + system.reflectance[m] * irradiance[k] - radiosity[k];
        });
    return residual;
}

void gauss_seidel(const System& system, const RowOperator& rows, const SolveOptions& options,
                  const ErrorEstimate& estimate, SystemSolution& solution) {
    // The residual after a sweep is about q/2 times the change that the sweep made: what was changed later in the sweep
    // has not reached the elements before. The exact residual is computed once that looks small enough.
    // The slowest mode is taken out after each sweep, so that the next mode decides how many are needed.
    const double residual_by_change = 0.5 * estimate.slowest();
    std::vector<double> change(solution.radiosity.size());
    for (double again = 0.0; solution.sweeps < options.max_sweeps; again = 1.0) {
        const std::vector<double> residual = residual_of(system, solution.radiosity, solution.irradiance);
        if (estimate.of(residual, solution.radiosity) <= options.tolerance) return;
        solution.sweeps += again; // the product below was not the last one
        double error = 1.0;
        do {
            sweep(system, rows, solution.radiosity, change);
            estimate.take_mode_out(solution);
            solution.sweeps += 1.0;
            error = residual_by_change * estimate.of_rest(change, solution.radiosity);
        } while (error > options.tolerance && solution.sweeps < options.max_sweeps);
        system.transport.apply(system.channels, solution.radiosity, solution.irradiance);
    }
}

void shoot(const System& system, const RowOperator& rows, const SolveOptions& options,
           const ErrorEstimate& estimate, SystemSolution& solution) {
    const auto& layout = system.transport.layout();
    const std::size_t channels = system.channels;
    // The estimate costs about as much as a shot into few elements.
    const std::size_t shots_between_estimates = std::max<std::size_t>(1, layout.elements() / 32);
    const auto max_shots =
        static_cast<std::size_t>(options.max_sweeps * static_cast<double>(layout.elements()));
    std::vector<double> unshot = residual_of(system, solution.radiosity, solution.irradiance);
    std::vector<double> arriving(unshot.size());
    std::size_t shots = 0;
    while (shots < max_shots) {
        if (shots % shots_between_estimates == 0 &&
            estimate.of(unshot, solution.radiosity) <= options.tolerance)
            break;
        const std::size_t shooter = brightest(system, unshot);
        const std::size_t first = layout.offsets[shooter] * channels,
                          count = layout.count(shooter) * channels;
        std::fill(arriving.begin(), arriving.end(), 0.0);
        rows.scatter(shooter, channels, std::span<const double>(unshot).subspan(first, count), arriving);
        for (std::size_t k = first; k < first + count; ++k) {
            solution.radiosity[k] += unshot[k];
            unshot[k] = 0.0;
        }
        for_each_coefficient(layout, channels, [&](std::size_t k, std::size_t m, std::size_t) {
            unshot[k] += system.reflectance[m] * arriving[k];
            solution.irradiance[k] += arriving[k];
        });
        ++shots;
    }
    solution.sweeps += static_cast<double>(shots) / static_cast<double>(layout.elements());
}

} // namespace kinelux::solve
