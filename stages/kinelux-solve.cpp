// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "cli/stage.h"
#include "core/log.h"
#include "engines.h"
#include "flux_balance.h"
#include "light_case.h"
#include "reports.h"
#include "savers.h"
#include "solve/animation.h"

using namespace kinelux;

namespace {

struct Options {
    std::string method = "automatic", start = "extrapolated";
    std::optional<double> tolerance;
    double max_sweeps = solve::SolveOptions{}.max_sweeps;
    double save_every_s = stages::default_save_every_s;
    stages::EngineOptions engine;

    explicit Options(cli::OptionTable& table) {
        table.add(
            {.member = &method,
             .flags = "--method",
             .help =
                 "automatic: Gauss-Seidel sweeps, or conjugate gradients where rooms exchange little light; "
                 "shooting begins each frame at zero, temporal shooting at the frame before",
             .words = {"automatic", "gauss-seidel", "conjugate-gradients", "temporal-shooting", "shooting"}});
        table.add({.member = &start,
                   .flags = "--start",
                   .help = "of a frame: the frames before, continued by a step, or the last frame as it is",
                   .words = {"extrapolated", "last-frame"}});
        table.add({.member = &tolerance,
                   .flags = "--tolerance",
                   .help = "relative error of radiosity that the solver may leave",
                   .unit = "1",
                   .low = 1e-12,
                   .high = 0.1,
                   .unset = "1/100 of the accuracy, at most 1e-4"});
        table.add({.member = &max_sweeps,
                   .flags = "--max-sweeps",
                   .help = "of the solver per frame",
                   .low = 1,
                   .high = 1e9});
        table.add(stages::save_every_row(save_every_s, "the frames"));
        stages::add_engine_options(engine, table);
    }
    solve::SolveOptions for_target(double target) const {
        static const std::map<std::string, solve::Method> methods{
            {"automatic", solve::Method::Automatic},
            {"gauss-seidel", solve::Method::GaussSeidel},
            {"conjugate-gradients", solve::Method::ConjugateGradients},
            {"temporal-shooting", solve::Method::TemporalShooting},
            {"shooting", solve::Method::Shooting}};
        return {.method = methods.at(method),
                .tolerance = tolerance.value_or(solve::tolerance_for(target)),
                .max_sweeps = max_sweeps,
                .start = start == "last-frame" ? solve::Start::LastFrame : solve::Start::Extrapolated};
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
    stage.add_resume();
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
            progress.advance(1, fmt::format("frame {}, solver's error {:.1e}, unshot {:.2g} %", frame.frame,
                                            frame.solver_error, 100.0 * frame.unshot));
        };
        stages::SolveSaver saver(stage, options.save_every_s);
        solve::Checkpoint checkpoint = saver.checkpoint();
        progress.advance(checkpoint.from.solution.frames.size());
        const solve::SolveOptions solving = options.for_target(light.scene.accuracy.target);
        stage.record().set("tolerance", solving.tolerance);
        const model::Solution solution = stage.step("solve", [&] {
            return solve::solve_animation({light.scene, light.plan, blocks, light.tree.elements, areas},
                                          *engine.engine, frames, solving, show, std::move(checkpoint));
        });
        stage.step("write", [&] { stage.folder().write_solution(solution); });
        stages::report_engine(engine, stage);
        std::vector<MaterialId> materials;
        for (const auto& element : light.elements) materials.push_back(element.material);
        stages::report_balances(light.scene, materials, areas, solution, stage);
        return stages::report_solution(solution, light.scene.accuracy.target, stage);
    });
}
