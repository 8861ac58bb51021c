// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "cli/stage.h"
#include "core/log.h"
#include "engines.h"
#include "light_case.h"
#include "reports.h"
#include "solve/animation.h"

using namespace kinelux;

namespace {

struct Options {
    std::string method = "gauss-seidel";
    std::optional<double> tolerance;
    std::uint32_t max_sweeps = solve::SolveOptions{}.max_sweeps;
    std::string engine = "auto";

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
                   .unset = "1/100 of the accuracy, at most 1e-4"});
        table.add({.member = &max_sweeps,
                   .flags = "--max-sweeps",
                   .help = "of the solver per frame",
                   .low = 1,
                   .high = 1e9});
        table.add(stages::engine_row(engine));
    }
    solve::SolveOptions for_target(double target) const {
        return {.method = method == "shooting"              ? solve::Method::Shooting
                          : method == "conjugate-gradients" ? solve::Method::ConjugateGradients
                                                            : solve::Method::GaussSeidel,
                .tolerance = tolerance.value_or(std::min(1e-4, 0.01 * target)),
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
        const stages::NamedEngine engine = stage.step("prepare motion", [&] {
            return stages::make_engine(options.engine, light, blocks, areas, frames, seed);
        });
        core::Progress progress("solve", frames.size());
        const auto show = [&](const model::FrameSolution& frame) {
            cli::Stage::throw_if_stopped();
            progress.advance(1, fmt::format("frame {}, residual {:.1e}, unshot {:.2g} %", frame.frame,
                                            frame.residual, 100.0 * frame.unshot));
        };
        const model::Solution solution = stage.step("solve", [&] {
            return solve::solve_animation({light.scene, light.plan, blocks, light.tree.elements, areas},
                                          *engine.engine, frames,
                                          options.for_target(light.scene.accuracy.target), show);
        });
        stage.step("write", [&] { stage.folder().write_solution(solution); });
        stages::report_engine(engine, stage);
        return stages::report_solution(solution, light.scene.accuracy.target, stage);
    });
}
