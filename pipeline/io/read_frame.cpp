// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/case_views.h"
#include "io/vtk_mesh.h"
#include "io/write_view.h"

namespace kinelux::io {

ExportedFrame read_frame(const std::filesystem::path& vtu, model::Quantity quantity) {
    const std::string irradiance = array_name("Irradiance", model::irradiance_unit(quantity));
    VtkContent content = read_vtk(vtu, {.cell_arrays = {"ObjectId"}, .point_arrays = {irradiance}});
    VtkValues<float>& values = content.point_arrays[0];
    return {.points = std::move(content.points),
            .triangles = std::move(content.triangles),
            .objects = std::move(content.cell_arrays[0].values),
            .irradiance = {.name = irradiance,
                           .components = values.components,
                           .component_names = std::move(values.component_names),
                           .values = std::move(values.values)}};
}

} // namespace kinelux::io
