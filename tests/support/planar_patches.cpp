// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/planar_patches.h"

namespace kinelux::support {

namespace {

model::Patch patch_in_plane(const Vec3& origin, const Vec3& along, const Vec3& inside,
                            std::span<const Vec3> points, ObjectId object) {
    model::Patch patch;
    patch.object = object;
    patch.surface.origin = origin;
    patch.surface.axis_u = glm::normalize(along);
    patch.surface.axis_w = glm::normalize(glm::cross(along, inside));
    patch.surface.axis_v = glm::cross(patch.surface.axis_w, patch.surface.axis_u);
    for (const Vec3& point : points)
        patch.points.emplace_back(glm::dot(point - origin, patch.surface.axis_u),
                                  glm::dot(point - origin, patch.surface.axis_v));
    return patch;
}

} // namespace

model::Patch polygon_patch(std::span<const Vec3> corners, ObjectId object) {
    const Vec3 origin = corners[0];
    // Of all fans' triangles the area vector, so that no thin corner decides the plane.
    Vec3 area(0.0);
    for (std::size_t i = 2; i < corners.size(); ++i)
        area += glm::cross(corners[i - 1] - origin, corners[i] - origin);
    const Vec3 along = corners[1] - origin;
    model::Patch patch = patch_in_plane(origin, along, glm::cross(area, along), corners, object);
    patch.loops.emplace_back();
    for (std::uint32_t i = 0; i < corners.size(); ++i) patch.loops[0].push_back(i);
    for (std::uint32_t i = 2; i < corners.size(); ++i) patch.triangles.push_back({0, i - 1, i});
    return patch;
}

model::Patch frame_patch(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v, const Vec2& hole_low,
                         const Vec2& hole_high, ObjectId object) {
    const auto at = [&](double u, double v) { return corner + u * edge_u + v * edge_v; };
    const std::vector<Vec3> points{at(0, 0),
                                   at(1, 0),
                                   at(1, 1),
                                   at(0, 1),
                                   at(hole_low.x, hole_low.y),
                                   at(hole_high.x, hole_low.y),
                                   at(hole_high.x, hole_high.y),
                                   at(hole_low.x, hole_high.y)};
    model::Patch patch = patch_in_plane(corner, edge_u, edge_v, points, object);
    patch.loops = {{0, 1, 2, 3}, {4, 7, 6, 5}};
    for (std::uint32_t s = 0; s < 4; ++s) {
        const std::uint32_t next = (s + 1) % 4;
        patch.triangles.push_back({s, next, 4 + next});
        patch.triangles.push_back({s, 4 + next, 4 + s});
    }
    return patch;
}

model::ClusterTree whole_patch_elements(const model::PatchSet& set) {
    model::ClusterTree tree;
    for (std::size_t p = 0; p < set.patches.size(); ++p) {
        const model::Patch& patch = set.patches[p];
        model::Element element;
        element.patch = PatchId(p);
        element.object = patch.object;
        element.material = patch.material;
        element.first_triangle = static_cast<std::uint32_t>(tree.domain_triangles.size());
        element.triangle_count = static_cast<std::uint32_t>(patch.triangles.size());
        for (const model::Triangle& t : patch.triangles)
            tree.domain_triangles.push_back({patch.points[t[0]], patch.points[t[1]], patch.points[t[2]]});
        tree.elements.push_back(element);
    }
    return tree;
}

} // namespace kinelux::support
