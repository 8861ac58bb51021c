// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "clean/clean.h"
#include "cli/stage.h"
#include "fit/fit.h"
#include "light_case.h"
#include "model/coefficients.h"
#include "model/solution.h"
#include "reference/reference.h"

// What stages put into their record and onto the terminal when the work is done.
namespace kinelux::stages {

/// What cleaning did, per object: a table on the terminal, "objects" in the record.
void report_cleaning(const clean::CleanResult& cleaned, cli::Stage& stage);

void report_fit(const fit::FitResult& fitted, cli::Stage& stage);

/// Sizes, and "closure": the row sums of the form factors between objects as they are. 1 in a closed scene; what is
/// missing is open, or an error.
void report_coefficients(const model::Coefficients& blocks, const LightCase& light, cli::Stage& stage);

/// "frames": residual, estimates and work of each frame.
/// @return  NotConverged when a frame did not converge
core::ExitCode report_solution(const model::Solution& solution, double target, cli::Stage& stage);

/// The comparison at the top of the record, and one sentence on stdout.
/// @return  NotConverged when the difference, less the reference's own noise, is above the accuracy asked for
core::ExitCode report_comparison(const reference::Comparison& comparison, double target, cli::Stage& stage);

} // namespace kinelux::stages
