// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan/plan.h"

#include <fmt/format.h>

#include "cli/plan_table.h"
#include "cli/stage.h"
#include "core/log.h"
#include "cost.h"

using namespace kinelux;

namespace {

void report_cost(const stages::Cost& cost, cli::Stage& stage) {
    if (!stage.quiet())
        fmt::print(
            "  predicted from {} of {} block rows, on this machine as busy as it is: coefficients {:.2g} s "
            "(+- {:.1g}), solve {:.2g} s (+- {:.1g}); {:.3g} blocks in {:.3g} MiB (+- {:.1g}){}\n",
            cost.rows, cost.of_rows, cost.coefficients_s.value, cost.coefficients_s.error, cost.solve_s.value,
            cost.solve_s.error, cost.blocks.value, cost.memory_mib.value, cost.memory_mib.error,
            cost.blocks_per_frame > 0.0
                ? fmt::format(", {:.3g} of them change in a frame", cost.blocks_per_frame)
                : "");
    core::RunRecord& record = stage.record();
    record.set("predicted/rows_sampled", static_cast<std::uint64_t>(cost.rows));
    record.set("predicted/coefficients_seconds", cost.coefficients_s.value);
    record.set("predicted/coefficients_seconds_error", cost.coefficients_s.error);
    record.set("predicted/solve_seconds", cost.solve_s.value);
    record.set("predicted/solve_seconds_error", cost.solve_s.error);
    record.set("predicted/blocks", cost.blocks.value);
    record.set("predicted/memory_mib", cost.memory_mib.value);
    record.set("predicted/memory_mib_error", cost.memory_mib.error);
    record.set("predicted/blocks_per_frame", cost.blocks_per_frame);
}

} // namespace

int main(int argc, char** argv) {
    cli::Stage stage({.name = "plan",
                      .summary = "Decides which effects the scene calls for, and says why.",
                      .inputs = {"clusters.h5"},
                      .outputs = {"plan.json"},
                      .record = "plan-record.json"});
    std::string prediction = "yes";
    stage.options().add({.member = &prediction,
                         .flags = "--prediction",
                         .help = "compute a fiftieth of the blocks, and say what all will take",
                         .words = {"yes", "no"},
                         .decides = cli::Decides::Manners});
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
        if (prediction == "no") return core::ExitCode::Ok;
        if (tree.elements.size() > coefficients::GroupingOptions{}.most_elements) {
            core::log_info(fmt::format("no prediction of time: {} elements exchange light in groups",
                                       tree.elements.size()));
            return core::ExitCode::Ok;
        }
        auto light = stage.step("read case", [&] { return stages::read_light_case(stage.folder()); });
        report_cost(stage.step("predict", [&] { return stages::predict_cost(light, 1); }), stage);
        return core::ExitCode::Ok;
    });
}
