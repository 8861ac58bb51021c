// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/clean.h"
#include "cli/scene_overrides.h"
#include "cli/stage.h"
#include "io/read_scene.h"
#include "reports.h"

using namespace kinelux;

int main(int argc, char** argv) {
    cli::Stage stage({.name = "clean",
                      .summary = "Reads a scene, repairs its meshes and begins a case.",
                      .inputs = {},
                      .outputs = {"scene.json", "clean.vtm", "clean"}});
    cli::SceneOverrides overrides(stage.options());
    clean::CleanOptions options;
    stage.options().add({.member = &options.merge_tolerance,
                         .flags = "--merge-tolerance",
                         .help = "points nearer than this times the object's size become one",
                         .unit = "1",
                         .low = 0.0,
                         .high = 1e-3});
    stage.options().add(
        {.member = &options.stitch_tolerance,
         .flags = "--stitch-tolerance",
         .help = "cracks and T-junctions narrower than this times the object's size are closed",
         .unit = "1",
         .low = 0.0,
         .high = 1e-2});
    return stage.run(argc, argv, [&](cli::Stage&) {
        stage.use_case(overrides.case_path(stage.argument()));
        model::Scene scene = stage.step("read", [&] {
            return io::read_scene(stage.argument(), {.allow_outside = overrides.allow_outside});
        });
        overrides.apply_to(scene);
        if (stage.unchanged(cli::scene_fingerprint(scene))) return core::ExitCode::Ok;
        stage.record().add_input(stage.argument());

        const clean::CleanResult cleaned =
            stage.step("clean", [&] { return clean::clean_scene(std::move(scene), options); });
        stage.make_folder();
        stage.step("write", [&] { stage.folder().write_scene(cleaned.scene); });
        stages::report_cleaning(cleaned, stage);
        return core::ExitCode::Ok;
    });
}
