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

// Boundary edges of a part by the places they lead from and to, each with its number and the ends of one of them.
struct Boundary {
    int count = 0;
    HalfEdgeMesh::Point from, to;
};
using BoundaryEdges = std::map<std::array<std::uint32_t, 2>, Boundary>;

// A part is open along the boundary edges that lie on none that runs the opposite way.
void measure_gaps(const BoundaryEdges& boundary, Part& part) {
    part.closed = true;
    for (const auto& [ends, edge] : boundary) {
        const auto opposite = boundary.find({ends[1], ends[0]});
        const int closing = opposite != boundary.end() ? opposite->second.count : 0;
        if (closing != edge.count) part.closed = false;
        if (closing >= edge.count) continue;
        const double length = (edge.to - edge.from).length();
        part.gap_length += length * (edge.count - closing);
        if (length <= part.longest_gap) continue;
        part.longest_gap = length;
        const HalfEdgeMesh::Point middle = (edge.from + edge.to) * 0.5;
        part.gap_place = Vec3{middle[0], middle[1], middle[2]};
    }
}

Part collect(const Connected& connected, std::uint32_t seed, std::vector<std::uint8_t>& seen) {
    const HalfEdgeMesh& mesh = connected.mesh;
    Part part;
    BoundaryEdges boundary;
    part.faces.push_back(seed);
    seen[seed] = 1;
    for (std::size_t i = 0; i < part.faces.size(); ++i) {
        const HalfEdgeMesh::FaceHandle face = connected.faces[part.faces[i]];
        for (auto half_edge = mesh.cfh_ccwbegin(face); half_edge != mesh.cfh_ccwend(face); ++half_edge) {
            const HalfEdgeMesh::FaceHandle other = mesh.opposite_face_handle(*half_edge);
            if (!other.is_valid()) {
                ++part.boundary_edges;
                const auto from = mesh.from_vertex_handle(*half_edge), to = mesh.to_vertex_handle(*half_edge);
                Boundary& edge = boundary[{connected.origin[from.idx()], connected.origin[to.idx()]}];
                edge = {edge.count + 1, mesh.point(from), mesh.point(to)};
                continue;
            }
            const auto next = static_cast<std::uint32_t>(other.idx());
            if (seen[next] != 0) continue;
            seen[next] = 1;
            part.faces.push_back(next);
        }
    }
    std::sort(part.faces.begin(), part.faces.end());
    measure_gaps(boundary, part);
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
