// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/stage.h"
#include "fit/fit.h"
#include "reports.h"

using namespace kinelux;

namespace {

void add_options(cli::OptionTable& table, fit::FitOptions& options) {
    table.add({.member = &options.distance_tolerance,
               .flags = "--distance-tolerance",
               .help = "of the scene's size: a face may be this far from its patch",
               .unit = "1",
               .low = 0.0,
               .high = 0.1});
    table.add({.member = &options.normal_tolerance_deg,
               .flags = "--normal-tolerance",
               .help = "a face may be turned this far against its patch",
               .unit = "deg",
               .low = 0.0,
               .high = 45.0});
    table.add(
        {.member = &options.min_patch_area,
         .flags = "--min-patch-area",
         .help = "of the scene's area: smaller round patches, and facets of curved surfaces, stay triangles",
         .unit = "1",
         .low = 0.0,
         .high = 1.0});
    table.add(
        {.member = &options.round_face_turn_deg,
         .flags = "--round-face-turn",
         .help = "faces of a round patch turn this far from one to the next at most; 0: no round patches",
         .unit = "deg",
         .low = 0.0,
         .high = 30.0});
    table.add({.member = &options.contact_tolerance,
               .flags = "--contact-tolerance",
               .help = "of the scene's size: what is this near to a patch touches it",
               .unit = "1",
               .low = 0.0,
               .high = 1e-2});
    table.add({.member = &options.small_triangle_edge,
               .flags = "--small-triangle-edge",
               .help = "of the scene's size: longer edges of small triangles are halved",
               .unit = "1",
               .low = 1e-4,
               .high = 10.0});
}

} // namespace

int main(int argc, char** argv) {
    cli::Stage stage({.name = "fit",
                      .summary = "Fits parametric patches to the cleaned meshes.",
                      .inputs = {"scene.json"},
                      .outputs = {"patches.h5", "patches.vtu"}});
    fit::FitOptions options;
    add_options(stage.options(), options);
    return stage.run(argc, argv, [&](cli::Stage&) {
        const model::Scene scene = stage.step("read", [&] { return stage.folder().read_scene(); });
        const fit::FitResult fitted = stage.step("fit", [&] { return fit::fit_patches(scene, options); });
        stage.step("write", [&] { stage.folder().write_patches(fitted.patches, scene); });
        stages::report_fit(fitted, stage);
        return core::ExitCode::Ok;
    });
}
