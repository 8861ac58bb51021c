// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/element_shape.h"
#include "model/cluster_tree.h"
#include "model/patch_set.h"
#include "model/scene.h"
#include "visibility/occluders.h"

namespace kinelux::support {

/// A parallelogram patch at `corner`, facing edge_u x edge_v (perpendicular edges), of object and material 0.
inline model::Patch rectangle(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v,
                              ObjectId object = {}, MaterialId material = {}) {
    model::Patch patch;
    patch.object = object;
    patch.material = material;
    patch.surface.origin = corner;
    patch.surface.axis_u = glm::normalize(edge_u);
    patch.surface.axis_w = glm::normalize(glm::cross(edge_u, edge_v));
    patch.surface.axis_v = glm::cross(patch.surface.axis_w, patch.surface.axis_u);
    const auto domain = [&](const Vec3& edge) {
        return Vec2(glm::dot(edge, patch.surface.axis_u), glm::dot(edge, patch.surface.axis_v));
    };
    const Vec2 u = domain(edge_u), v = domain(edge_v);
    patch.points = {Vec2(0.0), u, u + v, v};
    patch.triangles = {{0, 1, 2}, {0, 2, 3}};
    patch.loops = {{0, 1, 2, 3}};
    return patch;
}

/// Six patches of a box with normals inwards (a room), or outwards.
enum class Facing { Inwards, Outwards };
inline std::vector<model::Patch> box(const Vec3& low, const Vec3& high, Facing facing) {
    const Vec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
    std::vector<model::Patch> patches{rectangle(low, x, y), rectangle(low + z, y, x),
                                      rectangle(low, y, z), rectangle(low + x, z, y),
                                      rectangle(low, z, x), rectangle(low + y, x, z)};
    if (facing == Facing::Outwards)
        patches = {rectangle(low, y, x),     rectangle(low + z, x, y), rectangle(low, z, y),
                   rectangle(low + x, y, z), rectangle(low, x, z),     rectangle(low + y, z, x)};
    return patches;
}

/// Each patch cut into n x n equal elements.
inline model::ClusterTree uniform_elements(const model::PatchSet& set, int n) {
    model::ClusterTree tree;
    for (std::size_t p = 0; p < set.patches.size(); ++p) {
        const model::Patch& patch = set.patches[p];
        const Vec2 origin = patch.points[0];
        const Vec2 u = (patch.points[1] - origin) / static_cast<double>(n);
        const Vec2 v = (patch.points[3] - origin) / static_cast<double>(n);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const Vec2 c = origin + static_cast<double>(i) * u + static_cast<double>(j) * v;
                model::Element element;
                element.patch = PatchId(p);
                element.object = patch.object;
                element.material = patch.material;
                element.first_triangle = static_cast<std::uint32_t>(tree.domain_triangles.size());
                element.triangle_count = 2;
                tree.domain_triangles.push_back({c, c + u, c + u + v});
                tree.domain_triangles.push_back({c, c + u + v, c + v});
                tree.elements.push_back(element);
            }
    }
    return tree;
}

inline std::vector<geometry::ElementShape> shapes_of(const model::PatchSet& set, int n, int degree) {
    return geometry::element_shapes(set, uniform_elements(set, n), degree, 0);
}

/// A scene with one object per number used in the patches, no motions, one channel, one grey material.
inline model::Scene plain_scene(std::size_t objects, double reflectance = 0.5, double exitance = 0.0) {
    model::Scene scene;
    scene.title = "test";
    scene.channels = {"grey"};
    scene.materials = {{"grey", {reflectance}, {exitance}, model::Sides::Front}};
    scene.objects.resize(objects);
    for (std::size_t o = 0; o < objects; ++o) scene.objects[o].name = "object" + std::to_string(o);
    return scene;
}

inline visibility::Occluders occluders_of(const model::PatchSet& set, const model::Scene& scene) {
    return visibility::Occluders(visibility::bodies_of(set, scene));
}

} // namespace kinelux::support
