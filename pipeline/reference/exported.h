// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/vec.h"
#include "model/mesh.h"
#include "reference/reference.h"

namespace kinelux::reference {

/// A field on triangles as the user sees it: values at points, linear inside each triangle. World position.
struct ExportedField {
    std::span<const Vec3> points; ///< [m]
    std::span<const model::Triangle> triangles;
    std::span<const std::uint32_t> objects; ///< one per triangle
    std::span<const float> values;          ///< of point i, component c at [i * components + c]
    std::size_t components = 1;
};

struct MatchOptions {
    double tolerance =
        0.01; ///< farthest distance from a sensor to its triangle, of the field's extent [1], 0..1
    double min_cosine = 0.5; ///< of the angle between the sensor's and the triangle's normal [1], -1..1
};

/// The field at sensor points: interpolated in the nearest triangle of the same object that faces the same way, at the
/// point of it nearest to the sensor; nothing where there is none within the tolerance.
/// @throws GeometryError  sizes that do not fit
std::vector<std::optional<std::vector<double>>>
values_at(const ExportedField& field, std::span<const SensorPoint> sensors, const MatchOptions& options);

} // namespace kinelux::reference
