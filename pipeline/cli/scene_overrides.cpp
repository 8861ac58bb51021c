// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/scene_overrides.h"

namespace kinelux::cli {

SceneOverrides::SceneOverrides(OptionTable& table, const AccuracyRow& accuracy_row) {
    table.add({.member = &output,
               .flags = "-o,--output",
               .help = "folder of the case",
               .unset = "name of the scene with .case, in the current folder",
               .decides = Decides::Manners});
    table.add({.member = &accuracy,
               .flags = "--accuracy",
               .help = accuracy_row.help,
               .low = accuracy_row.low,
               .high = accuracy_row.high,
               .unset = accuracy_row.unset});
    table.add({.member = &degree,
               .flags = "--degree",
               .help = "of the polynomial bases",
               .low = 0,
               .high = 3,
               .unset = "from the accuracy"});
    table.add({.member = &element_size,
               .flags = "--element-size",
               .help = "largest edge of an element",
               .unit = "m",
               .low = 1e-9,
               .high = 1e9,
               .unset = "from the accuracy"});
    table.add({.member = &allow_outside,
               .flags = "--allow-outside",
               .help = "meshes may lie outside the scene file's folder tree",
               .decides = Decides::Manners});
}

std::filesystem::path SceneOverrides::case_path(const std::filesystem::path& scene) const {
    return output.empty() ? std::filesystem::path(scene.stem().string() + ".case") : output;
}

void SceneOverrides::apply_to(model::Scene& scene) const {
    if (accuracy) scene.accuracy.target = accuracy->value;
    if (degree) scene.accuracy.degree = degree;
    if (element_size) scene.accuracy.element_size = element_size;
}

} // namespace kinelux::cli
