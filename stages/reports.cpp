// SPDX-License-Identifier: GPL-3.0-or-later
#include "reports.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "cli/text.h"
#include "core/log.h"

namespace kinelux::stages {

namespace {

struct Count {
    const char* name;
    std::uint64_t clean::CleanReport::*value;
};

constexpr std::array counts{Count{"faces_in", &clean::CleanReport::faces_in},
                            Count{"faces_out", &clean::CleanReport::faces_out},
                            Count{"points_in", &clean::CleanReport::points_in},
                            Count{"points_out", &clean::CleanReport::points_out},
                            Count{"merged_points", &clean::CleanReport::merged_points},
                            Count{"duplicate_faces", &clean::CleanReport::duplicate_faces},
                            Count{"opposite_faces", &clean::CleanReport::opposite_faces},
                            Count{"degenerate_faces", &clean::CleanReport::degenerate_faces},
                            Count{"joined_points", &clean::CleanReport::joined_points},
                            Count{"divided_edges", &clean::CleanReport::divided_edges},
                            Count{"flipped_faces", &clean::CleanReport::flipped_faces},
                            Count{"non_manifold_edges", &clean::CleanReport::non_manifold_edges},
                            Count{"boundary_edges", &clean::CleanReport::boundary_edges},
                            Count{"self_intersections", &clean::CleanReport::self_intersections},
                            Count{"crossing_faces", &clean::CleanReport::crossing_faces},
                            Count{"two_sided_faces", &clean::CleanReport::two_sided_faces}};

void record(const clean::CleanReport& report, const std::string& key, core::RunRecord& record) {
    record.set(key + "/object", report.object);
    for (const Count& count : counts) record.set(key + "/" + count.name, report.*count.value);
    record.set(key + "/parts", static_cast<std::uint64_t>(report.parts));
    record.set(key + "/closed_parts", static_cast<std::uint64_t>(report.closed_parts));
    record.set(key + "/stitched_within_m", report.stitched_within);
    record.set(key + "/gap_length_m", report.gap_length);
    record.set(key + "/area_in_m2", report.area_in);
    record.set(key + "/area_out_m2", report.area_out);
    record.set(key + "/volume_out_m3", report.volume_out);
    for (const std::string& note : report.notes) record.append(key + "/notes", note);
}

} // namespace

void report_cleaning(const clean::CleanResult& cleaned, cli::Stage& stage) {
    cli::TextTable table(
        {"object", "faces", "kept", "merged", "removed", "turned", "two-sided", "crossing", "area [m2]"});
    std::uint64_t faces = 0;
    for (std::size_t o = 0; o < cleaned.reports.size(); ++o) {
        const clean::CleanReport& report = cleaned.reports[o];
        record(report, fmt::format("objects/{}", o), stage.record());
        table.row({report.object, std::to_string(report.faces_in), std::to_string(report.faces_out),
                   std::to_string(report.merged_points),
                   std::to_string(report.duplicate_faces + report.degenerate_faces + report.opposite_faces),
                   std::to_string(report.flipped_faces), std::to_string(report.two_sided_faces),
                   std::to_string(report.crossing_faces), cli::short_number(report.area_out)});
        for (const std::string& note : report.notes)
            core::log_detail(fmt::format("{}: {}", report.object, note));
        faces += report.faces_out;
    }
    std::string text = table.text();
    text.pop_back();
    core::log_info(text);
    stage.count("objects", cleaned.reports.size());
    stage.count("faces", faces);
}

void report_fit(const fit::FitResult& fitted, cli::Stage& stage) {
    stage.count("patches", fitted.patches.patches.size());
    stage.count("round patches", fitted.round_patches);
    stage.count("small triangles", fitted.patches.small.triangles.size());
    stage.count("faces in patches", fitted.faces_in_patches);
    stage.count("faces left small", fitted.faces_left_small);
    stage.count("contact cuts", fitted.contact_cuts);
    stage.count("covered patches", fitted.covered_patches);
    stage.count("overlapping charts", fitted.overlapping);
    stage.figure("deviation", fitted.deviation_max, "m");
    stage.figure("chords of round faces", fitted.chord_max, "m");
    stage.figure("area of faces", fitted.area_in, "m2");
    stage.figure("area of patches", fitted.area_out, "m2");
    stage.figure("covered area", fitted.covered_area, "m2");
}

void report_coefficients(const model::Coefficients& blocks, const LightCase& light, cli::Stage& stage) {
    const Groups groups = groups_of(light, GroupBy::Object);
    const auto count = static_cast<std::uint32_t>(groups.names.size());
    const auto factors = coefficients::form_factors(blocks, light.elements, groups.group_of, count);
    const std::vector<double> sums = row_sums(factors, groups.names.size());
    core::RunRecord& record = stage.record();
    record.set("closure/complete", blocks.moving_pairs.empty()); // else pairs in relative motion are missing
    for (std::size_t g = 0; g < sums.size(); ++g) {
        record.set(fmt::format("closure/rows/{}/object", g), groups.names[g]);
        record.set(fmt::format("closure/rows/{}/sum", g), sums[g]);
    }
    // What an element's row misses, bounces multiply: the worst one says more than the means of objects.
    const std::vector<double> rows = coefficients::element_row_sums(blocks, light.elements);
    const auto [smallest, largest] = std::minmax_element(rows.begin(), rows.end());
    record.set("closure/smallest_element_row", *smallest);
    record.set("closure/largest_element_row", *largest);
    stage.count("unknowns", blocks.layout.unknowns());
    stage.count("blocks", blocks.static_blocks.entries.size());
    stage.count("groups", blocks.hierarchy.groups.size());
    stage.count("links", blocks.hierarchy.links.entries.size());
    stage.count("moving pairs", blocks.moving_pairs.size());
    stage.count("crossed pairs", blocks.crossed_pairs.size());
    stage.count("rays", static_cast<std::uint64_t>(blocks.rays_cast));
    if (!blocks.hierarchy.empty()) stage.figure("expected error of links", blocks.hierarchy.error_estimate);
    if (!blocks.moving_pairs.empty()) return;
    stage.figure("form factor rows miss up to", std::max(1.0 - *smallest, 0.0));
    stage.figure("exceed 1 by up to", std::max(*largest - 1.0, 0.0));
}

core::ExitCode report_solution(const model::Solution& solution, double target, cli::Stage& stage) {
    double unshot = 0.0, solver_error = 0.0, error = 0.0, sweeps = 0.0;
    std::uint64_t changed = 0, changing = 0, not_converged = 0;
    for (std::size_t f = 0; f < solution.frames.size(); ++f) {
        const model::FrameSolution& frame = solution.frames[f];
        const std::string key = fmt::format("frames/{}/", f);
        stage.record().set(key + "frame", static_cast<std::uint64_t>(frame.frame));
        stage.record().set(key + "residual", frame.residual);
        stage.record().set(key + "unshot", frame.unshot);
        stage.record().set(key + "solver_error", frame.solver_error);
        stage.record().set(key + "error_estimate", frame.error_estimate);
        stage.record().set(key + "sweeps", frame.sweeps);
        stage.record().set(key + "blocks_recomputed", static_cast<std::uint64_t>(frame.blocks_recomputed));
        stage.record().set(key + "blocks_changing", static_cast<std::uint64_t>(frame.blocks_changing));
        stage.record().set(key + "blocks_expanded",
                           static_cast<std::uint64_t>(frame.blocks_changing - frame.blocks_recomputed));
        stage.record().set(key + "converged", frame.converged);
        stage.record().set(key + "seconds", frame.seconds);
        unshot = std::max(unshot, frame.unshot);
        solver_error = std::max(solver_error, frame.solver_error);
        error = std::max(error, frame.error_estimate);
        sweeps += frame.sweeps;
        changed += frame.blocks_recomputed;
        changing += frame.blocks_changing;
        not_converged += frame.converged ? 0 : 1;
    }
    stage.count("frames", solution.frames.size());
    stage.count("sweeps", static_cast<std::uint64_t>(std::llround(sweeps)));
    stage.count("blocks changing", changing);
    stage.count("blocks recomputed", changed);
    stage.count("blocks expanded", changing - changed);
    stage.figure("unshot", unshot);
    stage.figure("solver error", solver_error);
    stage.figure("error estimate", error);
    stage.record().set("counts/frames_not_converged", not_converged);
    if (error > target)
        core::log_warning(fmt::format("the error estimate is {:.2g} %, {:.2g} % were asked for",
                                      100.0 * error, 100.0 * target));
    if (not_converged == 0) return core::ExitCode::Ok;
    core::log_warning(
        fmt::format("{} of {} frames did not converge; the result is marked. Raise --max-sweeps",
                    not_converged, solution.frames.size()));
    return core::ExitCode::NotConverged;
}

core::ExitCode report_comparison(const reference::Comparison& comparison, double target, cli::Stage& stage) {
    core::RunRecord& record = stage.record();
    record.set("relative_rms_difference", comparison.relative_rms);
    record.set("relative_to_mean", comparison.relative_to_mean);
    record.set("reference_noise", comparison.reference_noise);
    record.set("bias", comparison.bias);
    record.set("points", comparison.points);
    record.set("points_without_exported_value", comparison.unmatched);
    record.set("accuracy_target", target);
    fmt::print("exported irradiance differs from the path-traced reference by {:.2g} % RMS (of which the "
               "reference's own "
               "noise is {:.2g} %) at {} points\n",
               100.0 * comparison.relative_rms, 100.0 * comparison.reference_noise, comparison.points);
    if (comparison.unmatched > 0)
        core::log_warning(fmt::format("{} sensor points lie on nothing that was exported; they count nowhere",
                                      comparison.unmatched));
    if (comparison.reference_noise > target)
        core::log_warning(fmt::format("the reference's own noise is above the {:.2g} % asked for, so this "
                                      "proves little: more --paths, or --noise {:.2g}",
                                      100.0 * target, 0.3 * target));
    const double squared = comparison.relative_rms * comparison.relative_rms -
                           comparison.reference_noise * comparison.reference_noise;
    if (squared <= target * target) return core::ExitCode::Ok;
    core::log_warning(fmt::format("{:.2g} % were asked for", 100.0 * target));
    return core::ExitCode::NotConverged;
}

} // namespace kinelux::stages
