// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "model/scene.h"
#include "model/solution.h"

namespace kinelux::test {

inline model::UnknownLayout layout_of(std::span<const geometry::ElementShape> shapes) {
    model::UnknownLayout layout;
    layout.offsets = {0};
    for (const geometry::ElementShape& shape : shapes)
        layout.offsets.push_back(layout.offsets.back() + static_cast<std::uint32_t>(shape.basis.size()));
    return layout;
}

/// A frame with the same direct and indirect irradiance everywhere, and the radiosity that follows.
inline model::FrameSolution uniform_frame(std::span<const geometry::ElementShape> shapes,
                                          const model::Scene& scene, double direct, double indirect) {
    const model::UnknownLayout layout = layout_of(shapes);
    const std::size_t channels = scene.channels.size();
    model::FrameSolution frame;
    for (auto* field : {&frame.radiosity, &frame.irradiance_direct, &frame.irradiance_indirect})
        field->assign(layout.unknowns() * channels, 0.0);
    for (std::size_t e = 0; e < shapes.size(); ++e)
        for (std::size_t c = 0; c < channels; ++c) {
            const model::Material& material = scene.materials[shapes[e].material.value];
            const std::size_t first = layout.offsets[e] * channels + c;
            const double root = std::sqrt(shapes[e].area);
            frame.radiosity[first] =
                root * (material.exitance[c] + material.reflectance[c] * (direct + indirect));
            frame.irradiance_direct[first] = root * direct;
            frame.irradiance_indirect[first] = root * indirect;
        }
    frame.element_error.assign(shapes.size(), 0.25f);
    return frame;
}

} // namespace kinelux::test
