// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "cli/stage.h"
#include "export_frames.h"
#include "io/write_view.h"
#include "light_case.h"
#include "sample/sampler.h"

using namespace kinelux;

int main(int argc, char** argv) {
    cli::Stage stage({.name = "export",
                      .summary = "Writes fields for ParaView, meters and the script that draws pictures.",
                      .inputs = {"solution.h5"},
                      .outputs = {"view.pvd", "view.py", "meters.csv", "frames"}});
    const std::uint64_t& seed = stage.add_seed();
    const auto& range = stage.add_frames("first and last frame that are exported");
    std::optional<double> cell_size, shadow_cell, shadow_tolerance;
    bool gather = false;
    std::optional<int> probe_rays, shadow_rays;
    stage.options().add({.member = &cell_size,
                         .flags = "--cell-size",
                         .help = "largest edge of a displayed cell",
                         .unit = "m",
                         .low = 1e-9,
                         .high = 1e9,
                         .unset = "what the scene says, else half an element"});
    stage.options().add({.member = &shadow_cell,
                         .flags = "--shadow-cell",
                         .help = "cells along shadows get no smaller; the cell size or more: none are cut",
                         .unit = "m",
                         .low = 1e-9,
                         .high = 1e9,
                         .unset = "a sixteenth of the cell size"});
    stage.options().add({.member = &shadow_tolerance,
                         .flags = "--shadow-tolerance",
                         .help = "direct light may differ by this share of its value from a linear one in a "
                                 "cell, or cells are cut",
                         .low = 1e-4,
                         .high = 1.0,
                         .unset = "twice the accuracy"});
    stage.options().add({.member = &gather,
                         .flags = "--gather",
                         .help = "indirect light by one more reflection at every point: closer, slower"});
    stage.options().add({.member = &probe_rays,
                         .flags = "--probe-rays",
                         .help = "per point and source; all alike = done",
                         .low = 4,
                         .high = 256,
                         .unset = "from the accuracy"});
    stage.options().add({.member = &shadow_rays,
                         .flags = "--shadow-rays",
                         .help = "per point and source in penumbra",
                         .low = 4,
                         .high = 4096,
                         .unset = "from the accuracy"});
    return stage.run(argc, argv, [&](cli::Stage&) {
        auto light = stage.step("read", [&] { return stages::read_light_case(stage.folder()); });
        stages::DisplayOptions display;
        display.cell_size =
            cell_size.value_or(light.scene.exported.cell_size.value_or(0.5 * light.tree.element_size));
        display.shadows.smallest_edge = shadow_cell.value_or(display.cell_size / 16.0);
        display.shadows.tolerance = shadow_tolerance.value_or(2.0 * light.scene.accuracy.target);
        display.direct = sample::direct_light_options_for(light.scene);
        display.direct.probe_rays = probe_rays.value_or(display.direct.probe_rays);
        display.direct.shadow_rays = shadow_rays.value_or(display.direct.shadow_rays);
        display.direct.seed = seed;
        if (gather) display.indirect = sample::IndirectLight::Gathered;
        const auto solution = stage.step("read solution", [&] { return stage.folder().read_solution(); });
        const auto exported = stage.step("frames", [&] {
            return stages::export_frames(light, solution,
                                         stages::exported_frames(light.scene, solution, range), display,
                                         stage.folder());
        });
        stage.step("meters", [&] { io::write_meters(stage.folder().file("meters.csv"), exported.meters); });

        stage.count("frames", exported.frames);
        stage.count("cells", exported.cells);
        stage.count("points", exported.points);
        stage.count("readings", exported.meters.size());
        stage.figure("cell size", display.cell_size, "m");
        stage.figure("smallest cell", display.shadows.smallest_edge, "m");
        stage.figure("area of shadow edges sharper than cells", exported.unresolved_area, "m2");
        return core::ExitCode::Ok;
    });
}
