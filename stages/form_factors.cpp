// SPDX-License-Identifier: GPL-3.0-or-later
#include "form_factors.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "cli/driver.h"
#include "cli/text.h"
#include "coefficients/whole_patch_factors.h"
#include "core/error.h"
#include "core/run_record.h"
#include "geometry/pose.h"
#include "light_case.h"

namespace kinelux::stages {

namespace {

constexpr double default_accuracy = 1e-3;
constexpr std::size_t most_blockers =
    100; ///< between two whole walls stands much; clipping is worth its time

// A case's surfaces at one frame, planar patches whole.
struct Surfaces {
    model::Scene scene;
    model::PatchSet patches;
    model::ClusterTree tree;
    std::vector<geometry::ElementShape> elements;
    visibility::Occluders occluders;
};

Surfaces read_surfaces(const io::CaseFolder& folder, std::uint32_t frame) {
    model::Scene scene = folder.read_scene();
    if (frame >= scene.time.frames)
        throw core::OptionError(
            fmt::format("--frame {}: the scene has frames 0 to {}", frame, scene.time.frames - 1));
    model::PatchSet patches = folder.read_patches();
    const model::ClusterTree tree = folder.read_clusters();
    model::ClusterTree whole = coefficients::whole_patch_elements(patches, tree);
    auto elements = geometry::element_shapes(patches, whole, 0, 0);
    visibility::Occluders occluders(visibility::bodies_of(patches, scene));
    const auto poses = geometry::object_poses(scene, scene.time.time_of_frame(frame));
    occluders.set_poses(poses);
    for (geometry::ElementShape& element : elements)
        element = geometry::moved(element, poses[element.object.value]);
    return {std::move(scene), std::move(patches), std::move(whole), std::move(elements),
            std::move(occluders)};
}

std::vector<double> group_areas(const Surfaces& surfaces, const Groups& groups) {
    std::vector<double> areas(groups.names.size(), 0.0);
    for (std::size_t e = 0; e < surfaces.elements.size(); ++e)
        areas[groups.group_of[e]] += surfaces.elements[e].area;
    return areas;
}

void write_csv(const std::filesystem::path& file, const Groups& groups, std::span<const double> areas,
               const std::vector<coefficients::FormFactor>& factors) {
    std::string text = "from,to,form_factor,error_estimate,from_area_m2,to_area_m2\n";
    for (const coefficients::FormFactor& factor : factors)
        text +=
            fmt::format("{},{},{:.12g},{:.3g},{:.12g},{:.12g}\n", cli::csv_field(groups.names[factor.from]),
                        cli::csv_field(groups.names[factor.to]), factor.value, factor.error_estimate,
                        areas[factor.from], areas[factor.to]);
    core::write_whole_file(file, text);
}

void print_sums(const std::string& kind, const Groups& groups, std::span<const double> areas,
                std::span<const coefficients::FormFactor> factors) {
    std::vector<double> errors(groups.names.size(), 0.0);
    for (const coefficients::FormFactor& factor : factors) errors[factor.from] += factor.error_estimate;
    const std::vector<double> sums = row_sums(factors, groups.names.size());
    cli::TextTable table({kind, "area m2", "row sum", "error estimate", "reaches nothing"});
    bool open = false, twice = false;
    for (std::size_t g = 0; g < sums.size(); ++g) {
        if (!(areas[g] > 0.0)) continue;
        const double slack = std::max(errors[g], default_accuracy);
        const bool missing = 1.0 - sums[g] > slack;
        open = open || missing;
        twice = twice || sums[g] - 1.0 > slack;
        table.row({groups.names[g], fmt::format("{:.6g}", areas[g]), fmt::format("{:.9f}", sums[g]),
                   fmt::format("{:.1e}", errors[g]), missing ? fmt::format("{:.6f}", 1.0 - sums[g]) : "-"});
    }
    fmt::print("{}  Sums are as computed, never normalised: 1 where a scene is closed.\n", table.text());
    if (open)
        fmt::print(
            "  What reaches nothing leaves an open scene, meets the backs of one-sided faces, or cannot "
            "leave "
            "where a body touches\n  another one (a cupboard's foot and the floor below it). In balances of "
            "open scenes it goes to the surroundings:\n  F(g, surroundings) = 1 - row sum.\n");
    if (twice)
        fmt::print(
            "  Sums above 1: surfaces lie on each other twice, or pass through each other; both copies are "
            "counted.\n");
}

} // namespace

int form_factors_command(const std::vector<std::string>& arguments) {
    cli::RunTable run(
        "kinelux form-factors",
        "Form factors between objects: the share of what leaves one uniformly that reaches the other. Planar "
        "patches "
        "are taken whole; where nothing stands between, their factors are exact. The CSV has the columns "
        "from, to, "
        "form_factor, error_estimate, from_area_m2, to_area_m2. Row sums are printed as computed, never "
        "normalised. "
        "A scene is brought up to its clusters first, in its case; of a folder only what is there is read.",
        "scene, mesh, or folder of a case that has its clusters",
        {.help = "relative error of a form factor with nothing or few polygons in between, as 0.1% or 0.001",
         .low = 1e-9,
         .high = 0.1,
         .unset = "0.1%"});
    std::filesystem::path csv;
    bool patches = false;
    std::uint32_t frame = 0;
    run.options().add({.member = &csv, .flags = "--csv", .help = "file to write", .unset = "none"});
    run.options().add(
        {.member = &patches, .flags = "--patches", .help = "between patches and clusters, not objects"});
    run.options().add({.member = &frame, .flags = "--frame", .help = "frame whose positions count"});
    if (run.options().parse(arguments) == cli::OptionTable::Parsed::Answered) return 0;
    run.apply();
    if (!csv.empty() && csv.has_parent_path() && !std::filesystem::is_directory(csv.parent_path()))
        throw core::FileError(fmt::format("--csv {}: there is no such folder", csv.string()));

    std::filesystem::path folder = run.argument();
    if (!std::filesystem::is_directory(folder)) {
        folder = run.case_path();
        if (const int code = run.run_until("cluster"); code != 0) return code;
    }
    const Surfaces surfaces = read_surfaces(io::CaseFolder(folder), frame);
    const Groups groups = groups_of(surfaces.scene, surfaces.patches, surfaces.tree,
                                    patches ? GroupBy::Patch : GroupBy::Object);
    const double accuracy = run.accuracy().value_or(default_accuracy);
    const auto factors =
        coefficients::whole_patch_factors(surfaces.elements, surfaces.occluders,
                                          {.tolerance = accuracy,
                                           .sight_tolerance = accuracy,
                                           .most_blockers = most_blockers,
                                           .seed = run.seed()},
                                          groups.group_of, static_cast<std::uint32_t>(groups.names.size()));
    const std::vector<double> areas = group_areas(surfaces, groups);
    if (!csv.empty()) write_csv(csv, groups, areas, factors);
    print_sums(patches ? "patch" : "object", groups, areas, factors);
    return 0;
}

} // namespace kinelux::stages
