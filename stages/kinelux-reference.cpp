// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include <fmt/format.h>

#include "cli/stage.h"
#include "reports.h"
#include "sensors.h"

using namespace kinelux;

int main(int argc, char** argv) {
    cli::Stage stage(
        {.name = "reference",
         .summary = "Measures the exported irradiance against path tracing on the cleaned triangles.",
         .inputs = {"scene.json", "view.pvd", "frames"},
         .outputs = {"reference.csv"}});
    const std::uint64_t& seed = stage.add_seed();
    const auto& range = stage.add_frames("first and last exported frame that are judged", "the first");
    std::optional<double> noise;
    std::optional<int> paths;
    stages::SensorRequest request{.count = 400, .file = {}, .trace = {}};
    stage.options().add({.member = &request.count,
                         .flags = "--points",
                         .help = "sensor points per frame, spread over all faces that do not emit",
                         .low = 1,
                         .high = 1e6});
    stage.options().add({.member = &paths,
                         .flags = "--paths",
                         .help = "per sensor point; with --noise the most",
                         .low = 4,
                         .high = 1e6,
                         .unset = "16384, with --noise 1000000"});
    stage.options().add(
        {.member = &noise,
         .flags = "--noise",
         .help = "standard error over irradiance, both as RMS of a frame, at which tracing stops; "
                 "0.01 is 1 %",
         .low = 1e-5,
         .high = 1.0,
         .unset = "all paths"});
    stage.options().add({.member = &request.file,
                         .flags = "--sensors",
                         .help = "file of sensor points instead, lines x y z nx ny nz in metres",
                         .unset = "none"});
    return stage.run(argc, argv, [&](cli::Stage&) {
        request.trace.seed = seed;
        request.trace.noise = noise.value_or(0.0);
        request.trace.paths = static_cast<std::uint32_t>(paths.value_or(noise ? 1'000'000 : 16384));
        const auto scene = stage.step("read", [&] { return stage.folder().read_scene(); });
        std::vector<stages::Judged> judged;
        for (const std::uint32_t frame : stages::frames_to_judge(stage.folder(), scene, range)) {
            const auto more = stage.step(fmt::format("frame {}", frame), [&] {
                return stages::judge_frame(stage.folder(), scene, frame, request);
            });
            judged.insert(judged.end(), more.begin(), more.end());
        }
        stages::write_reference_csv(stage.folder().file("reference.csv"), scene, judged);
        return stages::report_comparison(stages::compare(judged), scene.accuracy.target, stage);
    });
}
