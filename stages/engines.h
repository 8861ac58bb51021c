// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "cli/option_table.h"
#include "light_case.h"
#include "motion/engine.h"

// Which engine of motion a stage works with.
namespace kinelux::stages {

/// What a user may say about engines of motion.
struct EngineOptions {
    std::string name =
        "auto"; ///< exact, online, offline, paper; auto: offline for bodies that move over more than 8 frames,
                ///< else exact
    std::string paper_shadows = "publication"; ///< publication, exact, sources-too; of the engine `paper`
};

/// The options --engine and --paper-shadows.
void add_engine_options(EngineOptions& options, cli::OptionTable& table);

struct NamedEngine {
    std::string name;
    std::unique_ptr<motion::Engine> engine;
};

/// @param areas  one per element [m2]
/// @param frames  numbers of those that will be solved, ascending, at least one
/// Everything must outlive the engine. Engines that spread errors get a quarter of the accuracy asked for.
NamedEngine make_engine(const EngineOptions& wanted, LightCase& light, const model::Coefficients& blocks,
                        std::span<const double> areas, std::span<const std::uint32_t> frames,
                        std::uint64_t seed);

/// What it holds and what it integrated beforehand: counts and figures of the record.
void report_engine(const NamedEngine& engine, cli::Stage& stage);

} // namespace kinelux::stages
