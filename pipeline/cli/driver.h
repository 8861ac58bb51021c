// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/option_table.h"
#include "cli/scene_overrides.h"

namespace kinelux::cli {

/// Options of commands that run stages on a scene; each stage is given those it knows.
class RunTable {
public:
    RunTable(const std::string& program, const std::string& summary, const std::string& argument_help);
    /// With an accuracy of the command's own, that the stages are not given.
    RunTable(const std::string& program, const std::string& summary, const std::string& argument_help,
             const AccuracyRow& accuracy_row);

    OptionTable& options() { return options_; }
    const std::filesystem::path& argument() const { return argument_; }
    std::uint64_t seed() const { return seed_; }
    std::optional<double> accuracy() const;  ///< as given [1]
    std::filesystem::path case_path() const; ///< --output, or <scene stem>.case
    void apply() const;                      ///< log and threads

    /// Runs the stages from clean to `last`, each a program of its own; what is up to date is skipped unless --force.
    /// @return  0, 5 when a stage fell short of the accuracy, or the code of the first stage that failed
    int run_until(const std::string& last) const;
    /// Runs one stage, up to date or not. @return  its exit code
    int run_stage(const std::string& stage) const;
    /// Writes run.json into the case: the records of all stages, and totals.
    void write_record() const;

private:
    std::vector<std::string> stage_arguments(const std::string& stage) const;

    std::filesystem::path argument_, log_file_;
    OptionTable options_;
    std::optional<SceneOverrides> overrides_; // after the argument, so that it comes second in the table
    std::optional<double> memory_limit_;
    std::optional<FrameRange> frames_;
    std::uint64_t threads_ = 0, seed_ = 1;
    bool stages_take_accuracy_ = true;
    bool force_ = false, quiet_ = false, verbose_ = false;
};

/// One word behind `kinelux`.
struct Command {
    std::string name, summary;
    std::function<int(const std::vector<std::string>& arguments)> run;
};

/// `kinelux COMMAND ...`: runs the command, or the stage of that name. @throws OptionError  there is no such command
int drive(const std::vector<std::string>& arguments, std::span<const Command> commands);

int run_command(const std::vector<std::string>& arguments);  ///< kinelux run
int info_command(const std::vector<std::string>& arguments); ///< kinelux info

} // namespace kinelux::cli
