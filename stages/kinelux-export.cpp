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
    std::optional<double> cell_size;
    std::optional<int> probe_rays, shadow_rays;
    stage.options().add({.member = &cell_size,
                         .flags = "--cell-size",
                         .help = "largest edge of a displayed cell",
                         .unit = "m",
                         .low = 1e-9,
                         .high = 1e9,
                         .unset = "what the scene says, else a quarter of an element"});
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
        auto direct = sample::direct_light_options_for(light.scene);
        direct.probe_rays = probe_rays.value_or(direct.probe_rays);
        direct.shadow_rays = shadow_rays.value_or(direct.shadow_rays);
        direct.seed = seed;
        const auto solution = stage.step("read solution", [&] { return stage.folder().read_solution(); });
        const double size =
            cell_size.value_or(light.scene.exported.cell_size.value_or(0.25 * light.tree.element_size));
        const auto mesh = stage.step(
            "mesh", [&] { return sample::display_mesh(light.elements, light.patches, light.tree, size); });
        const auto readings = stage.step("frames", [&] {
            return stages::export_frames(light, solution, mesh,
                                         stages::exported_frames(light.scene, solution, range), direct,
                                         stage.folder());
        });
        stage.step("meters", [&] { io::write_meters(stage.folder().file("meters.csv"), readings.meters); });

        stage.count("frames", readings.frames);
        stage.count("cells", mesh.triangles.size());
        stage.count("points", mesh.points.size());
        stage.count("readings", readings.meters.size());
        stage.figure("cell size", size, "m");
        return core::ExitCode::Ok;
    });
}
