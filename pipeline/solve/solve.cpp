// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/solve.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "solve/conjugate_gradients.h"

namespace kinelux::solve {

namespace {

double norm(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

// The flux of the constant parts of a coefficient vector: sum over elements and channels of |x^0| sqrt(A).
double flux(const System& system, std::span<const double> x) {
    const auto& layout = system.transport.layout();
    double sum = 0.0;
    for (std::size_t i = 0; i < layout.elements(); ++i)
        for (std::size_t c = 0; c < system.channels; ++c)
            sum += std::abs(x[layout.offsets[i] * system.channels + c]) * std::sqrt(system.areas[i]);
    return sum;
}

// r = M + rho E - B, with the irradiance E = G B.
std::vector<double> residual_of(const System& system, std::span<const double> radiosity,
                                std::span<const double> irradiance) {
    const auto& layout = system.transport.layout();
    std::vector<double> residual(radiosity.size());
    for (std::size_t i = 0; i < layout.elements(); ++i)
        for (std::size_t u = layout.offsets[i]; u < layout.offsets[i + 1]; ++u)
            for (std::size_t c = 0; c < system.channels; ++c) {
                const std::size_t k = u * system.channels + c;
                residual[k] = system.exitance[k] +
                              system.reflectance[i * system.channels + c] * irradiance[k] - radiosity[k];
            }
    return residual;
}

// One Gauss-Seidel sweep in place; the norm of the change.
double sweep(const System& system, const RowOperator& rows, std::vector<double>& radiosity) {
    const auto& layout = system.transport.layout();
    const std::size_t channels = system.channels;
    std::vector<double> gathered;
    double change = 0.0;
    for (std::size_t i = 0; i < layout.elements(); ++i) {
        const std::size_t first = layout.offsets[i] * channels;
        gathered.resize(layout.count(i) * channels);
        rows.gather(i, channels, radiosity, gathered);
        for (std::size_t k = 0; k < gathered.size(); ++k) {
            const double rho = system.reflectance[i * channels + k % channels];
            const double value = system.exitance[first + k] + rho * gathered[k];
            change += (value - radiosity[first + k]) * (value - radiosity[first + k]);
            radiosity[first + k] = value;
        }
    }
    return std::sqrt(change);
}

void gauss_seidel(const System& system, const RowOperator& rows, const SolveOptions& options, double scale,
                  SystemSolution& solution) {
    // The change of a sweep is about the residual before it; the exact residual is computed once it looks small.
    while (true) {
        apply(system.transport, system.channels, solution.radiosity, solution.irradiance);
        const double residual = norm(residual_of(system, solution.radiosity, solution.irradiance));
        if (residual <= options.tolerance * scale || solution.sweeps >= options.max_sweeps) return;
        double change = residual;
        while (change > options.tolerance * scale && solution.sweeps < options.max_sweeps) {
            change = sweep(system, rows, solution.radiosity);
            ++solution.sweeps;
        }
    }
}

// Progressive refinement: the element with the most unshot flux shoots it all, again and again.
void shoot(const System& system, const RowOperator& rows, const SolveOptions& options, double scale,
           SystemSolution& solution) {
    const auto& layout = system.transport.layout();
    const std::size_t channels = system.channels;
    std::vector<double> unshot(system.exitance.begin(), system.exitance.end());
    std::vector<double> arriving(unshot.size());
    const std::size_t max_shots = std::size_t{options.max_sweeps} * layout.elements();
    std::size_t shots = 0;
    while (norm(unshot) > options.tolerance * scale && shots < max_shots) {
        std::size_t shooter = 0;
        double most = -1.0;
        for (std::size_t i = 0; i < layout.elements(); ++i) {
            const double power =
                norm(std::span(unshot).subspan(layout.offsets[i] * channels, layout.count(i) * channels)) *
                std::sqrt(system.areas[i]);
            if (power > most) {
                most = power;
                shooter = i;
            }
        }
        const std::size_t first = layout.offsets[shooter] * channels,
                          count = layout.count(shooter) * channels;
        std::fill(arriving.begin(), arriving.end(), 0.0);
        rows.scatter(shooter, channels, std::span<const double>(unshot).subspan(first, count), arriving);
        for (std::size_t k = first; k < first + count; ++k) {
            solution.radiosity[k] += unshot[k];
            unshot[k] = 0.0;
        }
        for (std::size_t i = 0; i < layout.elements(); ++i)
            for (std::size_t u = layout.offsets[i]; u < layout.offsets[i + 1]; ++u)
                for (std::size_t c = 0; c < channels; ++c)
                    unshot[u * channels + c] +=
                        system.reflectance[i * channels + c] * arriving[u * channels + c];
        ++shots;
    }
    solution.sweeps = static_cast<std::uint32_t>((shots + layout.elements() - 1) / layout.elements());
    apply(system.transport, channels, solution.radiosity, solution.irradiance);
}

} // namespace

SystemSolution solve_system(const System& system, const SolveOptions& options,
                            std::span<const double> start) {
    SystemSolution solution;
    const double scale = norm(system.exitance);
    solution.radiosity.assign(system.exitance.size(), 0.0);
    solution.irradiance.assign(system.exitance.size(), 0.0);
    if (!(scale > 0.0)) return solution;
    const RowOperator* rows = system.transport.rows();
    if (options.method == Method::Shooting) {
        if (rows == nullptr)
            throw core::OptionError(
                "shooting needs the blocks of all pairs of elements, but distant groups are "
                "linked; compute the coefficients with --groups never, or use another method");
        shoot(system, *rows, options, scale, solution);
    } else {
        const auto& from = start.empty() ? system.exitance : start;
        solution.radiosity.assign(from.begin(), from.end());
        if (options.method == Method::GaussSeidel && rows != nullptr)
            gauss_seidel(system, *rows, options, scale, solution);
        else
            conjugate_gradients(system, options, scale, solution);
    }
    const std::vector<double> residual = residual_of(system, solution.radiosity, solution.irradiance);
    solution.residual = norm(residual) / scale;
    solution.unshot = flux(system, residual) / flux(system, system.exitance);
    solution.converged = solution.residual <= 1.01 * options.tolerance;
    return solution;
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
