// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "geometry/surface.h"
#include "model/scene.h"
#include "support/shapes.h"

namespace kinelux::test {

/// A scene under construction: one object per call, with the meshes of rectangular patches.
struct SceneBuilder {
    model::Scene scene;

    explicit SceneBuilder(std::vector<std::string> channels = {"grey"}) {
        scene.channels = std::move(channels);
    }

    MaterialId material(std::vector<double> reflectance, std::vector<double> exitance,
                        model::Sides sides = model::Sides::Front) {
        scene.materials.push_back({"m" + std::to_string(scene.materials.size()), std::move(reflectance),
                                   std::move(exitance), sides});
        return MaterialId(scene.materials.size() - 1);
    }
    ObjectId object(const std::vector<model::Patch>& patches, MaterialId material) {
        model::Object object;
        object.name = "object" + std::to_string(scene.objects.size());
        model::Mesh& mesh = object.mesh;
        for (const model::Patch& patch : patches) {
            const auto first = static_cast<std::uint32_t>(mesh.points.size());
            for (const Vec2& uv : patch.points)
                mesh.points.push_back(geometry::evaluate(patch.surface, uv).position);
            for (const model::Triangle& t : patch.triangles) {
                mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
                mesh.materials.push_back(material);
                mesh.two_sided.push_back(scene.materials[material.value].sides == model::Sides::Both ? 1 : 0);
            }
        }
        scene.objects.push_back(std::move(object));
        return ObjectId(scene.objects.size() - 1);
    }
};

/// The square of a given side at height z about the z axis, facing up or down.
inline model::Patch level_square(double side, double z, bool up) {
    const Vec3 corner(-0.5 * side, -0.5 * side, z), x(side, 0, 0), y(0, side, 0);
    return up ? support::rectangle(corner, x, y) : support::rectangle(corner, y, x);
}

} // namespace kinelux::test
