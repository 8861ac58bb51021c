// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/world.h"

#include <cmath>

#include "geometry/pose.h"

namespace kinelux::reference {

namespace {

// A mesh that was never cleaned has no flags yet: then only a material that says so has a black back.
bool both_sides_of(const model::Mesh& mesh, std::size_t triangle, const model::Material& material) {
    if (!mesh.two_sided.empty()) return mesh.two_sided[triangle] != 0;
    return material.sides != model::Sides::Front;
}

} // namespace

Vec3 WorldTriangle::point(const Vec2& square) const {
    const double root = std::sqrt(square.x);
    return corner + root * (1.0 - square.y) * edge1 + root * square.y * edge2;
}

World::World(const model::Scene& scene, double time_s) {
    const std::vector<geometry::Pose> poses = geometry::object_poses(scene, time_s);
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        const model::Mesh& mesh = scene.objects[o].mesh;
        first_of_object.push_back(triangles.size());
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            WorldTriangle triangle;
            triangle.corner = poses[o].point(mesh.points[mesh.triangles[t][0]]);
            triangle.edge1 = poses[o].point(mesh.points[mesh.triangles[t][1]]) - triangle.corner;
            triangle.edge2 = poses[o].point(mesh.points[mesh.triangles[t][2]]) - triangle.corner;
            const Vec3 cross = glm::cross(triangle.edge1, triangle.edge2);
            triangle.area = 0.5 * glm::length(cross);
            if (triangle.area > 0.0) triangle.normal = cross / (2.0 * triangle.area);
            triangle.object = ObjectId(o);
            triangle.triangle = static_cast<std::uint32_t>(t);
            triangle.material = mesh.materials[t];
            triangle.both_sides = both_sides_of(mesh, t, scene.materials[triangle.material.value]);
            triangles.push_back(triangle);
        }
    }
}

} // namespace kinelux::reference
