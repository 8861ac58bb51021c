// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/coefficients.h"

#include <optional>

#include "cli/stage.h"
#include "light_case.h"
#include "reports.h"

using namespace kinelux;

int main(int argc, char** argv) {
    cli::Stage stage({.name = "coefficients",
                      .summary = "Computes the transport blocks between all elements.",
                      .inputs = {"plan.json"},
                      .outputs = {"coefficients.h5"}});
    const std::uint64_t& seed = stage.add_seed();
    std::optional<double> memory_limit;
    stage.options().add({.member = &memory_limit,
                         .flags = "--memory-limit",
                         .help = "refuse work that would need more",
                         .unit = "MiB",
                         .low = 1e-3,
                         .high = 1e9,
                         .unset = "4/5 of the machine's",
                         .decides = cli::Decides::Manners});
    return stage.run(argc, argv, [&](cli::Stage&) {
        const auto light = stage.step("read", [&] { return stages::read_light_case(stage.folder()); });
        const auto blocks = stage.step("coefficients", [&] {
            return coefficients::compute_coefficients(light.elements, light.scene, light.plan,
                                                      light.occluders, light.transport_options(seed),
                                                      memory_limit.value_or(cli::default_memory_limit_mib()));
        });
        stage.step("write", [&] { stage.folder().write_coefficients(blocks); });
        stages::report_coefficients(blocks, light, stage);
        return core::ExitCode::Ok;
    });
}
