// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve_saver.h"

#include <algorithm>

#include <fmt/format.h>

#include "cli/program.h"
#include "core/error.h"
#include "core/log.h"

namespace kinelux::stages {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

} // namespace

SolveSaver::SolveSaver(const cli::Stage& stage, double every_s)
    : stage_(stage), every_s_(every_s), wait_s_(every_s), saved_(Clock::now()) {}

model::SolutionSoFar SolveSaver::left() const {
    if (!stage_.resumes()) return {};
    try {
        auto found = stage_.folder().read_solution_so_far(stage_.key());
        if (!found || found->solution.frames.empty()) return {};
        core::log_info(fmt::format("resumes after frame {}: {} frames are done",
                                   found->solution.frames.back().frame, found->solution.frames.size()));
        return std::move(*found);
    } catch (const core::FileError& error) {
        core::log_warning(fmt::format("begins at the first frame: {}", error.what()));
        return {};
    }
}

void SolveSaver::save(const model::Solution& solution, const model::SolverState& state) {
    constexpr double share_of_time = 0.05;
    const bool stopped = cli::stop_signal() != 0;
    if (!stopped && seconds_since(saved_) < wait_s_) return;
    const auto started = Clock::now();
    stage_.folder().write_solution_so_far(solution, state, stage_.key());
    saved_ = Clock::now();
    wait_s_ = every_s_ > 0.0 ? std::max(every_s_, seconds_since(started) / share_of_time) : 0.0;
    if (stopped)
        core::log_info(fmt::format("saved {} frames; the same command resumes after frame {}",
                                   solution.frames.size(), solution.frames.back().frame));
}

solve::Checkpoint SolveSaver::checkpoint() {
    return {.from = left(), .save = [this](const model::Solution& solution, const model::SolverState& state) {
                save(solution, state);
            }};
}

} // namespace kinelux::stages
