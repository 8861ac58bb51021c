// SPDX-License-Identifier: GPL-3.0-or-later
#include "savers.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

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

// What read() finds, where the stage resumes at all; a damaged file is nothing.
template <class Read>
auto left(const cli::Stage& stage, const std::string& beginning, Read read) -> decltype(read()) {
    if (!stage.resumes()) return std::nullopt;
    try {
        return read();
    } catch (const core::FileError& error) {
        core::log_warning(fmt::format("begins at the first {}: {}", beginning, error.what()));
        return std::nullopt;
    }
}

} // namespace

SaveClock::SaveClock(double every_s) : every_s_(every_s), wait_s_(every_s), saved_(Clock::now()) {}

bool SaveClock::save_if_due(const std::function<void()>& write) {
    constexpr double share_of_time = 0.05;
    const bool stopped = cli::stop_signal() != 0;
    if (!stopped && seconds_since(saved_) < wait_s_) return false;
    const auto started = Clock::now();
    write();
    saved_ = Clock::now();
    wait_s_ = every_s_ > 0.0 ? std::max(every_s_, seconds_since(started) / share_of_time) : 0.0;
    return stopped;
}

cli::OptionRow save_every_row(double& member, const std::string& what) {
    return {.member = &member,
            .flags = "--save-every",
            .help = fmt::format("from one save of {} that are done to the next; 0 = after each", what),
            .unit = "s",
            .low = 0,
            .high = 1e9,
            .decides = cli::Decides::Manners};
}

SolveSaver::SolveSaver(const cli::Stage& stage, double every_s) : stage_(stage), clock_(every_s) {}

solve::Checkpoint SolveSaver::checkpoint() {
    const auto save = [this](const model::Solution& solution, const model::SolverState& state) {
        if (clock_.save_if_due([&] { stage_.folder().write_solution_so_far(solution, state, stage_.key()); }))
            core::log_info(fmt::format("saved {} frames; the same command resumes after frame {}",
                                       solution.frames.size(), solution.frames.back().frame));
    };
    auto found = left(stage_, "frame", [&] { return stage_.folder().read_solution_so_far(stage_.key()); });
    if (!found || found->solution.frames.empty()) return {.from = {}, .save = save};
    core::log_info(fmt::format("resumes after frame {}: {} frames are done",
                               found->solution.frames.back().frame, found->solution.frames.size()));
    return {.from = std::move(*found), .save = save};
}

CoefficientsSaver::CoefficientsSaver(const cli::Stage& stage, double every_s)
    : stage_(stage), clock_(every_s) {}

coefficients::Checkpoint CoefficientsSaver::checkpoint() {
    const auto save = [this](const model::CoefficientsSoFar& so_far) {
        if (clock_.save_if_due([&] { stage_.folder().write_coefficients_so_far(so_far, stage_.key()); }))
            core::log_info(fmt::format("saved {} rows; the same command resumes there", so_far.rows));
        cli::Stage::throw_if_stopped();
    };
    auto found = left(stage_, "row", [&] { return stage_.folder().read_coefficients_so_far(stage_.key()); });
    if (!found || found->rows == 0) return {.from = {}, .save = save};
    core::log_info(
        fmt::format("resumes after row {} of {}", found->rows, found->coefficients.layout.elements()));
    return {.from = std::move(*found), .save = save};
}

} // namespace kinelux::stages
