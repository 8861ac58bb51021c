// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <functional>

#include "cli/stage.h"
#include "coefficients/coefficients.h"
#include "io/case_folder.h"
#include "solve/animation.h"

// Stages that take long keep what they have done in the case, so that an interrupted run can go on.
namespace kinelux::stages {

/// When to save: every so many seconds, less often where saving would take a twentieth of the time, and when the user
/// stops the program.
class SaveClock {
public:
    explicit SaveClock(double every_s);
    /// Calls `write` if it is time. @return  whether the user has stopped the program
    bool save_if_due(const std::function<void()>& write);

private:
    double every_s_, wait_s_;
    std::chrono::steady_clock::time_point saved_;
};

/// The option --save-every. @param what  is saved, e.g. "the frames"
cli::OptionRow save_every_row(double& member, const std::string& what);
constexpr double default_save_every_s = 30.0;

/// Keeps finished frames in solution-so-far.h5.
class SolveSaver {
public:
    /// @param every_s  seconds from one save to the next
    SolveSaver(const cli::Stage& stage, double every_s);

    /// What an interrupted run of the same input and options has left; the rest of it is the caller's.
    solve::Checkpoint checkpoint();

private:
    const cli::Stage& stage_;
    SaveClock clock_;
};

/// Keeps finished block rows in coefficients-so-far.h5.
class CoefficientsSaver {
public:
    /// @param every_s  seconds from one save to the next
    CoefficientsSaver(const cli::Stage& stage, double every_s);

    /// What an interrupted run of the same input and options has left; the rest of it is the caller's. Its save() throws
    /// when the user has stopped the program.
    coefficients::Checkpoint checkpoint();

private:
    const cli::Stage& stage_;
    SaveClock clock_;
};

} // namespace kinelux::stages
