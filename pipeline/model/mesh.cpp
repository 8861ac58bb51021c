// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mesh.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "core/error.h"

namespace kinelux::model {

namespace {

bool is_finite(const Vec3& point) {
    return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
}

Vec3 doubled_area_vector(const Mesh& mesh, const Triangle& triangle) {
    const Vec3& origin = mesh.points[triangle[0]];
    return glm::cross(mesh.points[triangle[1]] - origin, mesh.points[triangle[2]] - origin);
}

} // namespace

double area(const Mesh& mesh) {
    double sum = 0.0;
    for (const Triangle& triangle : mesh.triangles)
        sum += 0.5 * glm::length(doubled_area_vector(mesh, triangle));
    return sum;
}

double signed_volume(const Mesh& mesh) {
    if (mesh.points.empty()) return 0.0;
    // Tetrahedra from a point of the mesh, not from the origin: no cancellation far away from it.
    const Vec3 apex = mesh.points.front();
    double sum = 0.0;
    for (const Triangle& triangle : mesh.triangles)
        sum += glm::dot(mesh.points[triangle[0]] - apex, doubled_area_vector(mesh, triangle)) / 6.0;
    return sum;
}

Vec3 triangle_normal(const Mesh& mesh, std::size_t triangle) {
    const Vec3 normal = doubled_area_vector(mesh, mesh.triangles[triangle]);
    const double length = glm::length(normal);
    return length > 0.0 ? normal / length : Vec3(0.0);
}

void check(const Mesh& mesh, const std::string& where) {
    const auto fail = [&](const std::string& what) { throw core::GeometryError(where + ": " + what); };
    const std::size_t count = mesh.triangles.size();
    const auto matches = [&](std::size_t size) { return size == 0 || size == count; };
    if (mesh.materials.size() != count)
        fail(std::to_string(count) + " triangles but " + std::to_string(mesh.materials.size()) +
             " materials");
    if (!matches(mesh.two_sided.size()) || !matches(mesh.source_faces.size()) ||
        mesh.surface_of.size() != (mesh.surfaces.empty() ? 0 : count))
        fail("the lists kept per triangle differ in length");
    for (std::size_t s = 0; s < mesh.surfaces.size(); ++s)
        check(mesh.surfaces[s], where + ": surface " + std::to_string(s));
    for (const std::uint32_t s : mesh.surface_of)
        if (s != no_surface && s >= mesh.surfaces.size())
            fail("a triangle names surface " + std::to_string(s) + " of " +
                 std::to_string(mesh.surfaces.size()));
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
        if (!is_finite(mesh.points[i]))
            fail("vertex " + std::to_string(i) + " has a coordinate that is not finite");
    for (std::size_t t = 0; t < count; ++t)
        for (const std::uint32_t corner : mesh.triangles[t])
            if (corner >= mesh.points.size())
                fail("triangle " + std::to_string(t) + " names vertex " + std::to_string(corner) + " of " +
                     std::to_string(mesh.points.size()));
}

} // namespace kinelux::model
