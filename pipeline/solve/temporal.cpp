// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <utility>

#include "solve/solve.h"

namespace kinelux::solve {

TemporalSolver::TemporalSolver(std::size_t channels, std::vector<double> reflectance,
                               std::vector<double> areas, const SolveOptions& options)
    : channels_(channels),
      reflectance_(std::move(reflectance)),
      areas_(std::move(areas)),
      options_(options) {}

// The polynomial through the last frames, continued by one: b1, 2 b1 - b2, 3 b1 - 3 b2 + b3.
std::vector<double> TemporalSolver::extrapolated() const {
    static constexpr std::array<std::array<double, 3>, 4> weights{
        {{0, 0, 0}, {1, 0, 0}, {2, -1, 0}, {3, -3, 1}}};
    if (previous_.empty()) return {};
    const auto& w = weights[previous_.size()];
    std::vector<double> start(previous_.front().size(), 0.0);
    for (std::size_t p = 0; p < previous_.size(); ++p)
        for (std::size_t k = 0; k < start.size(); ++k) start[k] += w[p] * previous_[p][k];
    return start;
}

// G M, element by element that emits where that can be done: they are few.
std::vector<double> TemporalSolver::emitted_irradiance(const TransportOperator& transport,
                                                       std::span<const double> exitance) const {
    const auto& layout = transport.layout();
    std::vector<double> irradiance(exitance.size());
    const RowOperator* rows = transport.rows();
    if (rows == nullptr) {
        transport.apply(channels_, exitance, irradiance);
        return irradiance;
    }
    for (std::size_t i = 0; i < layout.elements(); ++i) {
        const auto own = exitance.subspan(layout.offsets[i] * channels_, layout.count(i) * channels_);
        if (std::any_of(own.begin(), own.end(), [](double value) { return value != 0.0; }))
            rows->scatter(i, channels_, own, irradiance);
    }
    return irradiance;
}

model::FrameSolution TemporalSolver::solve_frame(const TransportOperator& transport,
                                                 std::span<const double> exitance) {
    const System system{transport, channels_, exitance, reflectance_, areas_};
    SystemSolution solved = solve_system(system, options_, extrapolated());

    model::FrameSolution frame;
    frame.sweeps = solved.sweeps;
    frame.residual = solved.residual;
    frame.unshot = solved.unshot;
    frame.converged = solved.converged;
    frame.irradiance_direct = emitted_irradiance(transport, exitance);
    frame.irradiance_indirect = std::move(solved.irradiance);
    for (std::size_t k = 0; k < exitance.size(); ++k)
        frame.irradiance_indirect[k] -= frame.irradiance_direct[k];
    frame.radiosity = solved.radiosity;

    previous_.insert(previous_.begin(), std::move(solved.radiosity));
    if (previous_.size() > 3) previous_.pop_back();
    return frame;
}

} // namespace kinelux::solve
