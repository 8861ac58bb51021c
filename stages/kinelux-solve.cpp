// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>
#include <string>

#include <fmt/format.h>

#include "cli/stage.h"
#include "core/log.h"
#include "light_case.h"
#include "motion/exact_engine.h"
#include "reports.h"
#include "solve/animation.h"

using namespace kinelux;

namespace {

struct Options {
    std::string method = "gauss-seidel";
    std::optional<double> tolerance;
    std::uint32_t max_sweeps = solve::SolveOptions{}.max_sweeps;

    explicit Options(cli::OptionTable& table) {
        table.add(
            {.member = &method,
             .flags = "--method",
             .help =
                 "sweeps or conjugate gradients from the frames before, or progressive refinement from zero",
             .words = {"gauss-seidel", "conjugate-gradients", "shooting"}});
        table.add({.member = &tolerance,
                   .flags = "--tolerance",
                   .help = "of the residual relative to the exitance",
                   .unit = "1",
                   .low = 1e-14,
                   .high = 0.1,
                   .unset = "from the accuracy and the lamps' size"});
        table.add({.member = &max_sweeps,
                   .flags = "--max-sweeps",
                   .help = "of the solver per frame",
                   .low = 1,
                   .high = 1e9});
    }
    solve::SolveOptions with_default(double default_tolerance) const {
        return {.method = method == "shooting"              ? solve::Method::Shooting
                          : method == "conjugate-gradients" ? solve::Method::ConjugateGradients
                                                            : solve::Method::GaussSeidel,
                .tolerance = tolerance.value_or(default_tolerance),
                .max_sweeps = max_sweeps};
    }
};

} // namespace

int main(int argc, char** argv) {
    cli::Stage stage({.name = "solve",
                      .summary = "Solves for the light of every frame.",
                      .inputs = {"coefficients.h5"},
                      .outputs = {"solution.h5"}});
    const std::uint64_t& seed = stage.add_seed();
    const auto& range = stage.add_frames("first and last frame that are solved");
    const Options options(stage.options());
    return stage.run(argc, argv, [&](cli::Stage&) {
        auto light = stage.step("read", [&] { return stages::read_light_case(stage.folder()); });
        const auto blocks =
            stage.step("read coefficients", [&] { return stage.folder().read_coefficients(); });
        const std::vector<double> areas = light.areas();
        const auto frames = stages::frames_of(light.scene, range);
        motion::ExactEngine engine(blocks, light.elements, light.plan, light.occluders,
                                   light.transport_options(seed));
        const double default_tolerance = solve::residual_tolerance(light.scene, light.tree.elements, areas);
        core::Progress progress("solve", frames.size());
        const auto show = [&](const model::FrameSolution& frame) {
            cli::Stage::throw_if_stopped();
            progress.advance(1, fmt::format("frame {}, residual {:.1e}, unshot {:.2g} %", frame.frame,
                                            frame.residual, 100.0 * frame.unshot));
        };
        const model::Solution solution = stage.step("solve", [&] {
            return solve::solve_animation({light.scene, light.plan, blocks, light.tree.elements, areas},
                                          engine, frames, options.with_default(default_tolerance), show);
        });
        stage.step("write", [&] { stage.folder().write_solution(solution); });
        return stages::report_solution(solution, light.scene.accuracy.target, stage);
    });
}
