// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan/plan.h"

#include <fmt/format.h>

#include "cli/plan_table.h"
#include "cli/stage.h"

using namespace kinelux;

int main(int argc, char** argv) {
    cli::Stage stage({.name = "plan",
                      .summary = "Decides which effects the scene calls for, and says why.",
                      .inputs = {"clusters.h5"},
                      .outputs = {"plan.json"},
                      .record = "plan-record.json"});
    return stage.run(argc, argv, [&](cli::Stage&) {
        const auto scene = stage.step("read scene", [&] { return stage.folder().read_scene(); });
        const auto patches = stage.step("read patches", [&] { return stage.folder().read_patches(); });
        const auto tree = stage.step("read clusters", [&] { return stage.folder().read_clusters(); });
        const auto plan = stage.step("plan", [&] { return plan::plan_effects(scene, patches, tree); });
        stage.step("write", [&] { stage.folder().write_plan(plan); });

        if (!stage.quiet()) fmt::print("{}", cli::plan_table(plan));
        stage.count("unknowns", plan.unknowns);
        stage.count("bounces", plan.bounces);
        stage.count("moving objects", plan.moving_objects.size());
        stage.figure("predicted memory", plan.predicted_memory_mib, "MiB");
        return core::ExitCode::Ok;
    });
}
