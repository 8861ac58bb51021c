// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "model/surface_field.h"

namespace kinelux::test {

inline double area_of(const model::DisplayMesh& mesh, std::size_t t) {
    const model::Triangle& c = mesh.triangles[t];
    return 0.5 * glm::length(glm::cross(mesh.points[c[1]] - mesh.points[c[0]],
                                        mesh.points[c[2]] - mesh.points[c[0]]));
}

// A point of the mesh strictly inside an edge of one of its triangles is a T-junction.
inline std::size_t t_junctions(const model::DisplayMesh& mesh) {
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t e = 0; e < 3; ++e) {
            const std::uint32_t i = mesh.triangles[t][e], j = mesh.triangles[t][(e + 1) % 3];
            const Vec3 a = mesh.points[i], b = mesh.points[j], along = b - a;
            for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
                const double s = glm::dot(mesh.points[p] - a, along) / glm::dot(along, along);
                const double off = glm::distance(mesh.points[p], a + s * along);
                if (p != i && p != j && s > 1e-9 && s < 1.0 - 1e-9 && off < 1e-9) ++count;
            }
        }
    return count;
}

inline std::size_t open_edges(const model::DisplayMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const model::Triangle& t : mesh.triangles)
        for (std::size_t e = 0; e < 3; ++e) ++edges[std::minmax(t[e], t[(e + 1) % 3])];
    std::size_t open = 0;
    for (const auto& [edge, count] : edges) open += count == 1 ? 1 : 0;
    return open;
}

inline void expect_consistent(const model::DisplayMesh& mesh) {
    const std::size_t n = mesh.triangles.size();
    EXPECT_EQ(mesh.normals.size(), mesh.points.size());
    EXPECT_EQ(mesh.point_objects.size(), mesh.points.size());
    for (const std::size_t size : {mesh.elements.size(), mesh.objects.size(), mesh.materials.size(),
                                   mesh.patches.size(), mesh.clusters.size(), mesh.degrees.size()})
        EXPECT_EQ(size, n);
    EXPECT_TRUE(std::is_sorted(mesh.objects.begin(), mesh.objects.end()));
    for (std::size_t t = 0; t < n; ++t) {
        const model::Triangle& c = mesh.triangles[t];
        const Vec3 normal =
            glm::cross(mesh.points[c[1]] - mesh.points[c[0]], mesh.points[c[2]] - mesh.points[c[0]]);
        for (const std::uint32_t corner : c) EXPECT_GT(glm::dot(normal, mesh.normals[corner]), 0.0);
    }
}

} // namespace kinelux::test
