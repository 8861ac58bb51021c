// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "model/solution.h"
#include "solve/transport_operator.h"

namespace kinelux::solve {

enum class Method : std::uint8_t {
    Shooting, ///< progressive refinement from zero: the element with the most unshot flux shoots; the paper's baseline
    GaussSeidel, ///< sweeps from the extrapolated previous frames; conjugate gradients where G has no rows
    ConjugateGradients, ///< on the symmetric system, from the extrapolated previous frames
};

struct SolveOptions {
    Method method = Method::GaussSeidel;
    double tolerance = 1e-4; ///< of the residual relative to the exitance, ||r|| / ||M|| [1], 1e-14..0.1
    std::uint32_t max_sweeps = 1000; ///< a shot counts as 1 / elements of a sweep
};

/// B = M + rho G B.
struct System {
    const TransportOperator& transport;
    std::size_t channels;
    std::span<const double> exitance;    ///< M as coefficients, unknowns x channels [W/m2 or lm/m2]
    std::span<const double> reflectance; ///< rho, elements x channels [1]
    std::span<const double> areas;       ///< one per element [m2]
};

struct SystemSolution {
    std::vector<double> radiosity;  ///< B, unknowns x channels
    std::vector<double> irradiance; ///< G B, unknowns x channels
    std::uint32_t sweeps = 0;
    double residual = 0.0; ///< ||M + rho G B - B|| / ||M|| [1], recomputed exactly at the end
    double unshot = 0.0;   ///< flux still unshot (norm 1 of the residual's constant parts) / flux emitted [1]
    bool converged = true;
};

/// Solves the system from a start vector (empty: from the exitance). Without emitters the solution is zero.
/// @throws OptionError  shooting where the transport has no rows
SystemSolution solve_system(const System& system, const SolveOptions& options, std::span<const double> start);

/// The coefficient vectors of a scene's materials: exitance (constant over each element) and reflectance.
/// @param areas  one per element [m2]; @param exitance, reflectance  elements x channels
std::vector<double> constant_coefficients(const model::UnknownLayout& layout, std::size_t channels,
                                          std::span<const double> areas, std::span<const double> values);

/// Solves frame after frame, each from the extrapolation of up to three frames before it (3 b1 - 3 b2 + b3).
class TemporalSolver {
public:
    /// @param reflectance  rho, elements x channels [1]; @param areas  one per element [m2]
    TemporalSolver(std::size_t channels, std::vector<double> reflectance, std::vector<double> areas,
                   const SolveOptions& options);

    /// @param exitance  M of this frame as coefficients, unknowns x channels [W/m2 or lm/m2]
    /// @return radiosity, direct and indirect irradiance, residual, unshot, sweeps; times and block counts are the
    ///         caller's to fill in
    model::FrameSolution solve_frame(const TransportOperator& transport, std::span<const double> exitance);

private:
    std::vector<double> extrapolated() const;
    std::vector<double> emitted_irradiance(const TransportOperator& transport,
                                           std::span<const double> exitance) const;

    std::size_t channels_;
    std::vector<double> reflectance_, areas_;
    SolveOptions options_;
    std::vector<std::vector<double>> previous_; ///< radiosity of the last frames, newest first
};

} // namespace kinelux::solve
