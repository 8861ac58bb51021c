// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "solve/conjugate_gradients.h"
#include "solve/relaxation.h"
#include "solve/vectors.h"

namespace kinelux::solve {

namespace {

// The flux of the constant parts of a coefficient vector: sum over elements and channels of |x^0| sqrt(A).
double flux(const System& system, std::span<const double> x) {
    const auto& layout = system.transport.layout();
    double sum = 0.0;
    for (std::size_t i = 0; i < layout.elements(); ++i)
        for (std::size_t c = 0; c < system.channels; ++c)
            sum += std::abs(x[layout.offsets[i] * system.channels + c]) * std::sqrt(system.areas[i]);
    return sum;
}

// The choice is measured: docs/theory.md, Solving.
Method chosen(const SolveOptions& options, const RowOperator* rows, const ErrorEstimate& estimate) {
    constexpr double slow = 0.7;
    if (rows == nullptr && options.method != Method::Shooting && options.method != Method::TemporalShooting)
        return Method::ConjugateGradients;
    if (options.method != Method::Automatic) return options.method;
    return estimate.second_slowest() > slow ? Method::ConjugateGradients : Method::GaussSeidel;
}

// The start that solve_from() expects of a radiosity: M where nothing is reflected, with its irradiance.
SystemSolution prepared(const System& system, const SolveOptions& options, std::span<const double> start) {
    SystemSolution from;
    from.irradiance.assign(system.exitance.size(), 0.0);
    if (options.method == Method::Shooting) {
        from.radiosity = from.irradiance;
        return from;
    }
    const auto& radiosity = start.empty() ? system.exitance : start;
    from.radiosity.assign(radiosity.begin(), radiosity.end());
    for_each_coefficient(system.transport.layout(), system.channels,
                         [&](std::size_t k, std::size_t m, std::size_t) {
                             if (system.reflectance[m] == 0.0) from.radiosity[k] = system.exitance[k];
                         });
    system.transport.apply(system.channels, from.radiosity, from.irradiance);
    return from;
}

} // namespace

SystemSolution solve_from(const System& system, const SolveOptions& options, const DominantMode& mode,
                          SystemSolution from) {
    SystemSolution solution = std::move(from);
    const double scale = std::sqrt(square_sum(system.exitance));
    if (!(scale > 0.0)) {
        solution.radiosity.assign(system.exitance.size(), 0.0);
        solution.irradiance = solution.radiosity;
        return solution;
    }
    const ErrorEstimate estimate(system, mode);
    const RowOperator* rows = system.transport.rows();
    const Method method = chosen(options, rows, estimate);
    if (method == Method::ConjugateGradients) {
        conjugate_gradients(system, options, estimate, solution);
    } else if (rows == nullptr) {
        throw core::OptionError(
            "shooting needs the blocks of all pairs of elements, but distant groups are "
            "linked; compute the coefficients with --groups never, or use another method");
    } else if (method == Method::GaussSeidel) {
        gauss_seidel(system, *rows, options, estimate, solution);
    } else {
        shoot(system, *rows, options, estimate, solution);
    }
    const std::vector<double> residual = residual_of(system, solution.radiosity, solution.irradiance);
    solution.residual = std::sqrt(square_sum(residual)) / scale;
    solution.unshot = flux(system, residual) / flux(system, system.exitance);
    solution.solver_error = estimate.of(residual, solution.radiosity);
    solution.converged = solution.solver_error <= 1.01 * options.tolerance;
    return solution;
}

SystemSolution solve_system(const System& system, const SolveOptions& options,
                            std::span<const double> start) {
    std::size_t products = 0;
    const DominantMode mode = dominant_mode(system, {}, products);
    return solve_from(system, options, mode, prepared(system, options, start));
}

std::vector<double> constant_coefficients(const model::UnknownLayout& layout, std::size_t channels,
                                          std::span<const double> areas, std::span<const double> values) {
    std::vector<double> result(layout.unknowns() * channels);
    for (std::size_t i = 0; i < layout.elements(); ++i)
        for (std::size_t c = 0; c < channels; ++c)
            result[layout.offsets[i] * channels + c] = values[i * channels + c] * std::sqrt(areas[i]);
    return result;
}

} // namespace kinelux::solve
