// SPDX-License-Identifier: GPL-3.0-or-later
#include "form_factors.h"

#include <filesystem>

#include <fmt/format.h>

#include "cli/driver.h"
#include "cli/text.h"
#include "core/error.h"
#include "core/run_record.h"
#include "light_case.h"

namespace kinelux::stages {

namespace {

void write_csv(const std::filesystem::path& file, const Groups& groups,
               const std::vector<coefficients::FormFactor>& factors) {
    std::string text = "from,to,form_factor,error_estimate\n";
    for (const coefficients::FormFactor& factor : factors)
        text += fmt::format("{},{},{:.9g},{:.3g}\n", cli::csv_field(groups.names[factor.from]),
                            cli::csv_field(groups.names[factor.to]), factor.value, factor.error_estimate);
    core::write_whole_file(file, text);
}

} // namespace

int form_factors_command(const std::vector<std::string>& arguments) {
    cli::RunTable run(
        "kinelux form-factors",
        "Form factors between objects: the share of what leaves one uniformly that reaches the other.",
        "scene, mesh, or folder of a case that has its coefficients");
    std::filesystem::path csv;
    bool patches = false;
    std::uint32_t frame = 0;
    run.options().add({.member = &csv, .flags = "--csv", .help = "file to write", .unset = "none"});
    run.options().add(
        {.member = &patches, .flags = "--patches", .help = "between patches and clusters, not objects"});
    run.options().add({.member = &frame, .flags = "--frame", .help = "frame whose positions count"});
    if (run.options().parse(arguments) == cli::OptionTable::Parsed::Answered) return 0;
    run.apply();

    std::filesystem::path folder = run.argument();
    if (!std::filesystem::is_directory(folder)) {
        folder = run.case_path();
        if (const int code = run.run_until("coefficients"); code != 0) return code;
    }
    const io::CaseFolder opened(folder);
    LightCase light = read_light_case(opened);
    if (frame >= light.scene.time.frames)
        throw core::OptionError(
            fmt::format("--frame {}: the scene has frames 0 to {}", frame, light.scene.time.frames - 1));
    const auto blocks = coefficients_at(opened.read_coefficients(), light, frame, run.seed());
    const Groups groups = groups_of(light, patches ? GroupBy::Patch : GroupBy::Object);
    const auto factors = coefficients::form_factors(blocks, light.elements, groups.group_of,
                                                    static_cast<std::uint32_t>(groups.names.size()));
    if (!csv.empty()) write_csv(csv, groups, factors);

    cli::TextTable table({patches ? "patch" : "object", "row sum"});
    const std::vector<double> sums = row_sums(factors, groups.names.size());
    for (std::size_t g = 0; g < sums.size(); ++g)
        table.row({groups.names[g], fmt::format("{:.6f}", sums[g])});
    fmt::print("{}  Sums are as computed, never normalised: 1 where a scene is closed.\n", table.text());
    return 0;
}

} // namespace kinelux::stages
