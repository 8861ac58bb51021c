// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

#include "cli/stage.h"
#include "io/case_folder.h"
#include "solve/animation.h"

namespace kinelux::stages {

/// Keeps what a solve has done in solution-so-far.h5: every so many seconds, and when the user stops it.
class SolveSaver {
public:
    /// @param every_s  seconds from one save to the next; more where saving itself takes longer than a twentieth of that
    SolveSaver(const cli::Stage& stage, double every_s);

    /// What an interrupted run of the same input and options has left; the rest of it is the caller's.
    solve::Checkpoint checkpoint();

private:
    model::SolutionSoFar left() const;
    void save(const model::Solution& solution, const model::SolverState& state);

    const cli::Stage& stage_;
    double every_s_, wait_s_;
    std::chrono::steady_clock::time_point saved_;
};

} // namespace kinelux::stages
