// SPDX-License-Identifier: GPL-3.0-or-later
// Key: R = B - M reflected radiosity; H = G R its irradiance; D = G M direct irradiance; r = rho (D + H) - R the residual.
#include <algorithm>
#include <array>
#include <utility>

#include "solve/relaxation.h"
#include "solve/solve.h"
#include "solve/vectors.h"

namespace kinelux::solve {

TemporalSolver::TemporalSolver(std::size_t channels, std::vector<double> reflectance,
                               std::vector<double> areas, const SolveOptions& options)
    : channels_(channels),
      reflectance_(std::move(reflectance)),
      areas_(std::move(areas)),
      options_(options) {}

void TemporalSolver::restore(model::SolverState state, const TransportOperator& transport) {
    state_ = std::move(state);
    transport_ = &transport;
    version_ = transport.version();
}

// Brings what is kept to the present G: by what has changed, or anew where that is cheaper, where the change is not known,
// and every hundredth time, so that rounding does not add up.
void TemporalSolver::follow(const System& system, double& sweeps) {
    constexpr std::uint32_t exact_after = 100;
    const TransportOperator& transport = system.transport;
    const std::uint64_t version = transport.version();
    const bool same = transport_ == &transport && version_ == version;
    const bool next = transport_ == &transport && version_ + 1 == version;
    transport_ = &transport;
    version_ = version;
    const bool exact = state_.empty() || state_.frames_since_exact >= exact_after;
    if (same && !exact) {
        ++state_.frames_since_exact;
        return;
    }
    const Into into = next && !exact && transport.changed_share() < 1.0 ? Into::Add : Into::Set;
    state_.frames_since_exact = into == Into::Add ? state_.frames_since_exact + 1 : 0;

    std::vector<std::vector<double>> sent = state_.reflected;
    if (!exact) {
        sent.push_back(state_.mode.shape);
        for_each_coefficient(transport.layout(), channels_, [&](std::size_t k, std::size_t m, std::size_t) {
            sent.back()[k] *= reflectance_[m];
        });
    }
    if (!sent.empty()) {
        const std::vector<double> all = packed(sent, channels_);
        std::vector<double> images(all.size());
        const std::size_t width = channels_ * sent.size();
        if (into == Into::Add)
            transport.apply_change(width, all, images);
        else
            transport.apply(width, all, images);
        sweeps += into == Into::Add ? transport.changed_share() : 1.0;
        for (std::size_t v = 0; v < state_.irradiance.size(); ++v)
            unpack(images, v, sent.size(), channels_, into, state_.irradiance[v]);
        if (!exact) unpack(images, sent.size() - 1, sent.size(), channels_, into, state_.mode.image);
    }
    if (exact) {
        std::size_t products = 0;
        state_.mode = dominant_mode(system, std::move(state_.mode), products);
        sweeps += static_cast<double>(products);
    }
}

// The polynomial through the last one, two or three frames, continued by one step: whichever is the nearest by its
// residual, after the slowest mode is taken out of that. The last frame alone is left as it is.
SystemSolution TemporalSolver::start(const System& system, std::span<const double> direct) const {
    static constexpr std::array<std::array<double, 3>, 3> weights{{{1, 0, 0}, {2, -1, 0}, {3, -3, 1}}};
    const bool extrapolates = options_.start == Start::Extrapolated;
    const ErrorEstimate estimate(system, state_.mode);
    SystemSolution best;
    best.radiosity.assign(system.exitance.begin(), system.exitance.end());
    best.irradiance.assign(direct.begin(), direct.end());
    const SystemSolution none = best;
    double least = 0.0;
    for (std::size_t order = 0; order < state_.reflected.size() && (extrapolates || order == 0); ++order) {
        SystemSolution from = none;
        for (std::size_t p = 0; p <= order; ++p)
            for (std::size_t k = 0; k < direct.size(); ++k) {
                from.radiosity[k] += weights[order][p] * state_.reflected[p][k];
                from.irradiance[k] += weights[order][p] * state_.irradiance[p][k];
            }
        if (extrapolates) estimate.take_mode_out(from);
        const double error =
            estimate.of(residual_of(system, from.radiosity, from.irradiance), from.radiosity);
        if (order > 0 && error >= least) continue;
        least = error;
        best = std::move(from);
    }
    return best;
}

// G M, element by element that emits where that can be done: they are few.
std::vector<double> TemporalSolver::emitted_irradiance(const System& system) const {
    const auto& layout = system.transport.layout();
    std::vector<double> irradiance(system.exitance.size());
    const RowOperator* rows = system.transport.rows();
    if (rows == nullptr) {
        system.transport.apply(channels_, system.exitance, irradiance);
        return irradiance;
    }
    for (std::size_t i = 0; i < layout.elements(); ++i) {
        const auto own = system.exitance.subspan(layout.offsets[i] * channels_, layout.count(i) * channels_);
        if (std::any_of(own.begin(), own.end(), [](double value) { return value != 0.0; }))
            rows->scatter(i, channels_, own, irradiance);
    }
    return irradiance;
}

void TemporalSolver::remember(const System& system, const SystemSolution& solved,
                              const model::FrameSolution& frame) {
    std::vector<double> reflected = solved.radiosity;
    for (std::size_t k = 0; k < reflected.size(); ++k) reflected[k] -= system.exitance[k];
    state_.reflected.insert(state_.reflected.begin(), std::move(reflected));
    state_.irradiance.insert(state_.irradiance.begin(), frame.irradiance_indirect);
    if (state_.reflected.size() > 3) {
        state_.reflected.pop_back();
        state_.irradiance.pop_back();
    }
}

model::FrameSolution TemporalSolver::solve_frame(const TransportOperator& transport,
                                                 std::span<const double> exitance) {
    const System system{transport, channels_, exitance, reflectance_, areas_};
    double sweeps = 0.0;
    follow(system, sweeps);
    model::FrameSolution frame;
    frame.irradiance_direct = emitted_irradiance(system);
    SystemSolution from;
    if (options_.method == Method::Shooting)
        from.radiosity = from.irradiance = std::vector<double>(exitance.size(), 0.0);
    else
        from = start(system, frame.irradiance_direct);
    SystemSolution solved = solve_from(system, options_, state_.mode, std::move(from));

    frame.sweeps = sweeps + solved.sweeps;
    frame.residual = solved.residual;
    frame.unshot = solved.unshot;
    frame.solver_error = solved.solver_error;
    frame.converged = solved.converged;
    frame.irradiance_indirect = solved.irradiance;
    for (std::size_t k = 0; k < exitance.size(); ++k)
        frame.irradiance_indirect[k] -= frame.irradiance_direct[k];
    remember(system, solved, frame);
    frame.radiosity = std::move(solved.radiosity);
    return frame;
}

} // namespace kinelux::solve
