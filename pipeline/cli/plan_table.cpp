// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/plan_table.h"

#include <fmt/format.h>

#include "cli/text.h"

namespace kinelux::cli {

std::string plan_table(const model::Plan& plan) {
    TextTable table({"effect", "decision", "error risked", "reason"});
    for (const model::Effect& effect : plan.effects)
        table.row({effect.name, std::string(effect.simulated ? "simulated" : "left out"),
                   effect.risked_error > 0.0 ? fmt::format("{:.2g} %", 100.0 * effect.risked_error) : "none",
                   effect.overridden ? "the scene says so; " + effect.reason : effect.reason});
    return table.text() +
           fmt::format("  degree {} on patches, {} on clusters; {} unknowns, at most {} blocks, {:.0f} MiB\n",
                       plan.degree, plan.cluster_degree, plan.unknowns, plan.predicted_blocks,
                       plan.predicted_memory_mib);
}

} // namespace kinelux::cli
