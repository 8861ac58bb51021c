// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/triangulate.h"

#include <cstddef>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace kinelux::fit {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

// Number of a corner's point; a corner that CGAL made at a crossing has none yet.
struct PointNumber {
    std::int64_t value = -1;
};

using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<PointNumber, Kernel>;
using FaceInfo = CGAL::Triangulation_face_base_with_info_2<std::int32_t, Kernel>; // number of the triangle
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel, FaceInfo>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Delaunay = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;

Vec2 position(const Delaunay::Vertex_handle& vertex) { return {vertex->point().x(), vertex->point().y()}; }

} // namespace

Triangulation triangulate(std::span<const Vec2> points, std::span<const Edge> edges) {
    Triangulation result;
    result.points.assign(points.begin(), points.end());
    Delaunay delaunay;
    std::vector<Delaunay::Vertex_handle> vertices;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Delaunay::Vertex_handle hint = vertices.empty() ? Delaunay::Vertex_handle() : vertices.back();
        const Delaunay::Point point(points[i].x, points[i].y);
        vertices.push_back(vertices.empty() ? delaunay.insert(point) : delaunay.insert(point, hint->face()));
        if (vertices.back()->info().value < 0) vertices.back()->info().value = static_cast<std::int64_t>(i);
    }
    for (const Edge& edge : edges) {
        if (vertices[edge[0]] != vertices[edge[1]])
            delaunay.insert_constraint(vertices[edge[0]], vertices[edge[1]]);
    }
    if (delaunay.dimension() < 2) return result;

    for (const Delaunay::Vertex_handle vertex : delaunay.finite_vertex_handles()) {
        if (vertex->info().value >= 0) continue;
        vertex->info().value = static_cast<std::int64_t>(result.points.size());
        result.points.push_back(position(vertex));
    }
    for (const Delaunay::Face_handle face : delaunay.all_face_handles()) face->info() = -1;
    std::int32_t count = 0;
    for (const Delaunay::Face_handle face : delaunay.finite_face_handles()) face->info() = count++;
    for (const Delaunay::Face_handle face : delaunay.finite_face_handles()) {
        model::Triangle triangle;
        std::array<std::int32_t, 3> neighbours;
        std::array<std::uint8_t, 3> kept;
        for (int k = 0; k < 3; ++k) {
            triangle[k] = static_cast<std::uint32_t>(face->vertex(k)->info().value);
            // CGAL counts an edge by the corner opposite to it.
            neighbours[k] = face->neighbor((k + 2) % 3)->info();
            kept[k] = face->is_constrained((k + 2) % 3) ? 1 : 0;
        }
        result.triangles.push_back(triangle);
        result.neighbours.push_back(neighbours);
        result.kept.push_back(kept);
    }
    return result;
}

} // namespace kinelux::fit
