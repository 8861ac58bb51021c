// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/sequence.h"
#include "model/scene.h"

namespace kinelux::support {

/// Adds a parallelogram of columns x rows cells, two triangles each, facing edge_u x edge_v. Cells for which keep(column,
/// row) is false are left out. Corners of the cells are shared.
template <class Keep>
void add_sheet(model::Mesh& mesh, const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v, int columns,
               int rows, const Keep& keep) {
    const std::uint32_t first = static_cast<std::uint32_t>(mesh.points.size());
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            mesh.points.push_back(corner + (static_cast<double>(i) / columns) * edge_u +
                                  (static_cast<double>(j) / rows) * edge_v);
        }
    }
    const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(j * (columns + 1) + i); };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            if (!keep(i, j)) continue;
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
}

inline void add_sheet(model::Mesh& mesh, const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v,
                      int columns = 1, int rows = 1) {
    add_sheet(mesh, corner, edge_u, edge_v, columns, rows, [](int, int) { return true; });
}

/// Fills in material 0, one side and face numbers where the mesh has none yet.
inline model::Mesh finished(model::Mesh mesh, MaterialId material = {}, std::uint8_t two_sided = 0) {
    while (mesh.materials.size() < mesh.triangles.size()) mesh.materials.push_back(material);
    while (mesh.two_sided.size() < mesh.triangles.size()) mesh.two_sided.push_back(two_sided);
    while (mesh.source_faces.size() < mesh.triangles.size()) {
        mesh.source_faces.push_back(static_cast<std::uint32_t>(mesh.source_faces.size()));
    }
    return mesh;
}

/// A box of twelve triangles and eight points, facing outwards.
inline model::Mesh box_mesh(const Vec3& low, const Vec3& high) {
    model::Mesh mesh;
    for (std::uint32_t i = 0; i < 8; ++i) {
        mesh.points.push_back(
            {(i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z});
    }
    const std::vector<std::array<std::uint32_t, 4>> sides{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                                          {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& s : sides) {
        mesh.triangles.push_back({s[0], s[1], s[2]});
        mesh.triangles.push_back({s[0], s[2], s[3]});
    }
    return finished(mesh);
}

inline model::Mesh turned_inside_out(model::Mesh mesh) {
    for (model::Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

/// A prism of `sides` sides about the z axis, closed by fans of triangles, facing outwards.
inline model::Mesh prism_mesh(const Vec3& base, double radius, double height, std::uint32_t sides) {
    model::Mesh mesh;
    for (std::uint32_t i = 0; i < sides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / sides;
        const Vec3 foot = base + radius * Vec3{std::cos(angle), std::sin(angle), 0.0};
        mesh.points.push_back(foot);
        mesh.points.push_back(foot + Vec3{0.0, 0.0, height});
    }
    for (std::uint32_t i = 0; i < sides; ++i) {
        const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % sides);
        mesh.triangles.push_back({a, b, b + 1});
        mesh.triangles.push_back({a, b + 1, a + 1});
        if (i + 2 >= sides) continue;
        const std::uint32_t c = 2 * (i + 1), d = 2 * (i + 2);
        mesh.triangles.push_back({0, d, c});
        mesh.triangles.push_back({1, c + 1, d + 1});
    }
    return finished(mesh);
}

/// Materials: 0 grey, 1 a lamp; both Front.
inline model::Scene empty_scene(model::Sides sides = model::Sides::Front) {
    model::Scene scene;
    scene.title = "test";
    scene.channels = {"grey"};
    scene.materials = {{"grey", {0.5}, {0.0}, sides}, {"lamp", {0.0}, {1.0}, sides}};
    return scene;
}

inline model::Object& add_object(model::Scene& scene, std::string name, model::Mesh mesh) {
    model::Object object;
    object.name = std::move(name);
    object.mesh = finished(std::move(mesh));
    scene.objects.push_back(std::move(object));
    return scene.objects.back();
}

/// Gives an object a motion of its own.
inline void set_moving(model::Scene& scene, std::size_t object) {
    scene.motions.push_back(
        {"glide", model::Interpolation::Linear, Vec3{0.0}, {{0.0}, {1.0, Vec3{1.0, 0.0, 0.0}}}});
    scene.objects[object].motion = MotionId(scene.motions.size() - 1);
}

/// The same mesh with faces, and the corners within them, in another order.
inline model::Mesh shuffled(const model::Mesh& mesh, std::uint64_t seed) {
    core::Random random(seed);
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        order.insert(order.begin() + static_cast<std::ptrdiff_t>(random.next() * static_cast<double>(i + 1)),
                     i);
    }
    model::Mesh result = mesh;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const model::Triangle& t = mesh.triangles[order[i]];
        result.triangles[i] = i % 2 == 0 ? t : model::Triangle{t[1], t[2], t[0]};
        result.materials[i] = mesh.materials[order[i]];
        result.two_sided[i] = mesh.two_sided[order[i]];
        result.source_faces[i] = mesh.source_faces[order[i]];
    }
    return result;
}

} // namespace kinelux::support
