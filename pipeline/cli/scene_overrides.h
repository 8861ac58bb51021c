// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "cli/option_table.h"
#include "model/scene.h"

namespace kinelux::cli {

/// What --accuracy means to a program, its range and what holds when it is not given.
struct AccuracyRow {
    std::string help = "relative error of radiosity asked for, as 1% or 0.01";
    double low = 1e-6, high = 0.5; ///< [1]
    std::string unset = "what the scene says, else 3%";
};

/// The options of a program that reads a scene: where the case is, and what the command line knows better than the
/// scene file. Must outlive the table.
struct SceneOverrides {
    std::filesystem::path output;
    std::optional<Share> accuracy;
    std::optional<int> degree;
    std::optional<double> element_size; ///< [m]
    bool allow_outside = false;

    explicit SceneOverrides(OptionTable& table, const AccuracyRow& accuracy_row = {});

    /// --output, or <scene stem>.case in the current folder.
    std::filesystem::path case_path(const std::filesystem::path& scene) const;
    /// What the command line says goes into scene.accuracy, from where every later stage takes it.
    void apply_to(model::Scene& scene) const;
};

} // namespace kinelux::cli
