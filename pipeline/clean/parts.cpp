// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/parts.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

namespace kinelux::clean {

namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

// The triangles as half-edges, with the number of each face. A triangle that OpenMesh cannot attach comes with corners
// of its own: it is a part by itself then.
struct Connected {
    HalfEdgeMesh mesh;
    std::vector<std::uint32_t> origin; // of each vertex
    std::vector<HalfEdgeMesh::FaceHandle> faces;
};

Connected connect(std::span<const Vec3> points, std::span<const model::Triangle> triangles,
                  std::span<const std::uint32_t> origin) {
    Connected result;
    const auto add_vertex = [&](std::size_t p) {
        result.origin.push_back(origin[p]);
        return result.mesh.add_vertex(HalfEdgeMesh::Point(points[p].x, points[p].y, points[p].z));
    };
    std::vector<HalfEdgeMesh::VertexHandle> vertices;
    for (std::size_t p = 0; p < points.size(); ++p) vertices.push_back(add_vertex(p));
    omerr().disable();
    for (const model::Triangle& t : triangles) {
        HalfEdgeMesh::FaceHandle face = result.mesh.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
        if (!face.is_valid())
            face = result.mesh.add_face(add_vertex(t[0]), add_vertex(t[1]), add_vertex(t[2]));
        result.faces.push_back(face);
    }
    omerr().enable();
    return result;
}

// Whether every boundary edge of a part lies on one that runs the opposite way.
bool is_closed(const std::map<std::array<std::uint32_t, 2>, int>& boundary) {
    return std::all_of(boundary.begin(), boundary.end(), [&](const auto& edge) {
        const auto opposite = boundary.find({edge.first[1], edge.first[0]});
        return opposite != boundary.end() && opposite->second == edge.second;
    });
}

Part collect(const Connected& connected, std::uint32_t seed, std::vector<std::uint8_t>& seen) {
    const HalfEdgeMesh& mesh = connected.mesh;
    Part part;
    std::map<std::array<std::uint32_t, 2>, int> boundary;
    part.faces.push_back(seed);
    seen[seed] = 1;
    for (std::size_t i = 0; i < part.faces.size(); ++i) {
        const HalfEdgeMesh::FaceHandle face = connected.faces[part.faces[i]];
        for (auto half_edge = mesh.cfh_ccwbegin(face); half_edge != mesh.cfh_ccwend(face); ++half_edge) {
            const HalfEdgeMesh::FaceHandle other = mesh.opposite_face_handle(*half_edge);
            if (!other.is_valid()) {
                ++part.boundary_edges;
                const int from = mesh.from_vertex_handle(*half_edge).idx(),
                          to = mesh.to_vertex_handle(*half_edge).idx();
                ++boundary[{connected.origin[from], connected.origin[to]}];
                continue;
            }
            const auto next = static_cast<std::uint32_t>(other.idx());
            if (seen[next] != 0) continue;
            seen[next] = 1;
            part.faces.push_back(next);
        }
    }
    std::sort(part.faces.begin(), part.faces.end());
    part.closed = is_closed(boundary);
    return part;
}

} // namespace

std::vector<Part> find_parts(std::span<const Vec3> points, std::span<const model::Triangle> triangles,
                             std::span<const std::uint32_t> origin) {
    const Connected connected = connect(points, triangles, origin);
    std::vector<std::uint8_t> seen(triangles.size(), 0);
    std::vector<Part> parts;
    for (std::uint32_t f = 0; f < triangles.size(); ++f) {
        if (seen[f] == 0) parts.push_back(collect(connected, f, seen));
    }
    return parts;
}

} // namespace kinelux::clean
