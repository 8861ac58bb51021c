// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/coefficients.h"

#include <optional>
#include <string>

#include "cli/stage.h"
#include "light_case.h"
#include "reports.h"
#include "savers.h"

using namespace kinelux;

namespace {

coefficients::Grouping grouping(const std::string& word) {
    if (word == "never") return coefficients::Grouping::Never;
    return word == "always" ? coefficients::Grouping::Always : coefficients::Grouping::Auto;
}

kernel::Integration integration_named(const std::string& word) {
    if (word == "sobol") return kernel::Integration::Sobol;
    return word == "monte-carlo" ? kernel::Integration::Random : kernel::Integration::Automatic;
}

} // namespace

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
    std::string groups = "auto";
    stage.options().add(
        {.member = &groups,
         .flags = "--groups",
         .help = "whether distant groups of elements exchange light as one: in large scenes, never, always",
         .words = {"auto", "never", "always"}});
    std::string integration = "automatic";
    stage.options().add({.member = &integration,
                         .flags = "--integration",
                         .help =
                             "of blocks at rest: the rule that suits the pair, scrambled Sobol points, or "
                             "independent points as the publication has them",
                         .words = {"automatic", "sobol", "monte-carlo"}});
    std::uint32_t samples = kernel::TransportOptions{}.samples;
    stage.options().add({.member = &samples,
                         .flags = "--samples",
                         .help = "points per block and scrambling, of 8, where points are chosen",
                         .low = 1,
                         .high = 1u << 28u});
    stage.add_resume();
    double save_every_s = stages::default_save_every_s;
    stage.options().add(stages::save_every_row(save_every_s, "the block rows"));
    return stage.run(argc, argv, [&](cli::Stage&) {
        const auto light = stage.step("read", [&] { return stages::read_light_case(stage.folder()); });
        const auto blocks = stage.step("coefficients", [&] {
            kernel::TransportOptions options = light.transport_options(seed);
            options.integration = integration_named(integration);
            options.samples = samples;
            stages::CoefficientsSaver saver(stage, save_every_s);
            return coefficients::compute_coefficients(light.elements, light.scene, light.plan,
                                                      light.occluders, options,
                                                      memory_limit.value_or(cli::default_memory_limit_mib()),
                                                      {.use = grouping(groups)}, saver.checkpoint());
        });
        stage.step("write", [&] { stage.folder().write_coefficients(blocks); });
        stages::report_coefficients(blocks, light, stage);
        return core::ExitCode::Ok;
    });
}
