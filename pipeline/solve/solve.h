// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "model/solution.h"
#include "solve/error_estimate.h"
#include "solve/transport_operator.h"

namespace kinelux::solve {

enum class Method : std::uint8_t {
    Automatic,        ///< Gauss-Seidel, or conjugate gradients where light decays slowly in more than one way
    Shooting,         ///< progressive refinement from zero in every frame: the paper's "classical" baseline
    TemporalShooting, ///< progressive refinement of what has changed since the frame before: the paper's method
    GaussSeidel,      ///< sweeps; conjugate gradients where G has no rows
    ConjugateGradients, ///< on the symmetric system
};

/// Where a frame begins, for all methods but shooting from zero.
enum class Start : std::uint8_t {
    LastFrame,    ///< the radiosity of the frame before, as in the paper
    Extrapolated, ///< the polynomial through the last one, two or three frames that leaves the least residual
};

struct SolveOptions {
    Method method = Method::Automatic;
    double tolerance =
        1e-4; ///< of the estimated relative L2 error of B over what does not emit [1], 1e-12..0.1
    double max_sweeps = 1000; ///< per frame; a shot counts as 1 / elements
    Start start = Start::Extrapolated;
};

/// The solver's share of a scene's accuracy. @param accuracy  relative L2 error of radiosity asked for [1]
inline double tolerance_for(double accuracy) { return std::clamp(0.01 * accuracy, 1e-12, 1e-4); }

/// B = M + rho G B.
struct System {
    const TransportOperator& transport;
    std::size_t channels;
    std::span<const double> exitance;    ///< M as coefficients, unknowns x channels [W/m2 or lm/m2]
    std::span<const double> reflectance; ///< rho, elements x channels [1], 0 <= rho < 1
    std::span<const double> areas;       ///< one per element [m2]
};

struct SystemSolution {
    std::vector<double> radiosity;  ///< B, unknowns x channels
    std::vector<double> irradiance; ///< G B, unknowns x channels
    double sweeps =
        0.0; ///< passes over the blocks; those for the irradiance of start and result do not count
    double residual = 0.0; ///< ||M + rho G B - B|| / ||M|| [1]
    double unshot = 0.0;   ///< flux still unshot (norm 1 of the residual's constant parts) / flux emitted [1]
    double solver_error = 0.0; ///< ErrorEstimate of the result [1]
    bool converged = true;     ///< solver_error is within the tolerance
};

/// Solves the system from a start vector (empty: from the exitance). Without emitters the solution is zero.
/// @throws OptionError  shooting where the transport has no rows
SystemSolution solve_system(const System& system, const SolveOptions& options, std::span<const double> start);

/// As above, from a radiosity and its irradiance G B, which need not be computed then.
/// @param from  radiosity M where nothing is reflected, and irradiance
SystemSolution solve_from(const System& system, const SolveOptions& options, const DominantMode& mode,
                          SystemSolution from);

/// The coefficient vectors of a scene's materials: exitance (constant over each element) and reflectance.
/// @param areas  one per element [m2]; @param exitance, reflectance  elements x channels
std::vector<double> constant_coefficients(const model::UnknownLayout& layout, std::size_t channels,
                                          std::span<const double> areas, std::span<const double> values);

/// Solves frame after frame, each from up to three frames before it. It keeps the reflected radiosity R = B - M of those
/// and their irradiance G R; when G changes, only G R of what has changed is added. The residual of any combination of
/// them is then known without a product, and what the last frame left unshot is in it: equation (9) of the paper with
/// rho_i and with the leftover, rho G'M' + rho G'R - R, the change of exitance being shot with the direct light.
class TemporalSolver {
public:
    /// @param reflectance  rho, elements x channels [1]; @param areas  one per element [m2]
    TemporalSolver(std::size_t channels, std::vector<double> reflectance, std::vector<double> areas,
                   const SolveOptions& options);

    /// @param exitance  M of this frame as coefficients, unknowns x channels [W/m2 or lm/m2]
    /// @return radiosity, direct and indirect irradiance, residual, unshot, sweeps; times and block counts are the
    ///         caller's to fill in
    model::FrameSolution solve_frame(const TransportOperator& transport, std::span<const double> exitance);

    /// What the next frame needs of those before.
    const model::SolverState& state() const { return state_; }
    /// Goes on from where another solver was; the transport is as it was when that one solved its last frame.
    void restore(model::SolverState state, const TransportOperator& transport);

private:
    void follow(const System& system, double& sweeps);
    SystemSolution start(const System& system, std::span<const double> direct) const;
    std::vector<double> emitted_irradiance(const System& system) const;
    void remember(const System& system, const SystemSolution& solved, const model::FrameSolution& frame);

    std::size_t channels_;
    std::vector<double> reflectance_, areas_;
    SolveOptions options_;
    model::SolverState state_;
    const TransportOperator* transport_ = nullptr; ///< the one that the state belongs to
    std::uint64_t version_ = 0;                    ///< and its version
};

} // namespace kinelux::solve
