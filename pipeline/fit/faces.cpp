// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/faces.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <glm/geometric.hpp>

namespace kinelux::fit {

namespace {

// Makes equal points one; returns the new number of each old point.
std::vector<std::uint32_t> weld(const std::vector<Vec3>& points, std::vector<Vec3>& welded) {
    const auto place = [&](std::uint32_t i) { return std::tuple(points[i].x, points[i].y, points[i].z); };
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
    std::vector<std::uint32_t> number(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || place(order[i - 1]) != place(order[i])) welded.push_back(points[order[i]]);
        number[order[i]] = static_cast<std::uint32_t>(welded.size() - 1);
    }
    return number;
}

Face make_face(const std::vector<Vec3>& points, const model::Triangle& corners) {
    Face face;
    face.corners = corners;
    const Vec3 &a = points[corners[0]], &b = points[corners[1]], &c = points[corners[2]];
    const Vec3 across = glm::cross(b - a, c - a);
    const double twice_area = glm::length(across);
    const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    face.area = 0.5 * twice_area;
    if (twice_area > 0.0) {
        face.normal = across / twice_area;
        face.height = twice_area / longest;
    }
    return face;
}

struct DirectedEdge {
    std::uint32_t from, to, face;
};

void find_neighbours(Body& body) {
    std::vector<DirectedEdge> edges;
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
        const model::Triangle& corners = body.faces[f].corners;
        for (std::size_t k = 0; k < 3; ++k) {
            edges.push_back({corners[k], corners[(k + 1) % 3], static_cast<std::uint32_t>(f)});
        }
    }
    std::vector<DirectedEdge> sorted = edges;
    std::sort(sorted.begin(), sorted.end(), [](const DirectedEdge& a, const DirectedEdge& b) {
        return std::tie(a.from, a.to, a.face) < std::tie(b.from, b.to, b.face);
    });
    body.across_first.push_back(0);
    for (const DirectedEdge& edge : edges) {
        auto at = std::lower_bound(sorted.begin(), sorted.end(), edge,
                                   [](const DirectedEdge& a, const DirectedEdge& b) {
                                       return std::tie(a.from, a.to) < std::tie(b.to, b.from);
                                   });
        for (; at != sorted.end() && at->from == edge.to && at->to == edge.from; ++at) {
            body.across_faces.push_back(at->face);
        }
        body.across_first.push_back(static_cast<std::uint32_t>(body.across_faces.size()));
    }
}

} // namespace

std::span<const std::uint32_t> Body::across(std::size_t face, std::size_t k) const {
    const std::size_t edge = 3 * face + k;
    return std::span(across_faces).subspan(across_first[edge], across_first[edge + 1] - across_first[edge]);
}

Body make_body(const model::Object& object, ObjectId id) {
    Body body;
    body.object = id;
    const model::Mesh& mesh = object.mesh;
    const std::vector<std::uint32_t> number = weld(mesh.points, body.points);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const model::Triangle& old = mesh.triangles[t];
        Face face = make_face(body.points, {number[old[0]], number[old[1]], number[old[2]]});
        face.material = mesh.materials[t];
        face.two_sided = !mesh.two_sided.empty() && mesh.two_sided[t] != 0;
        if (face.area > 0.0) body.faces.push_back(face);
    }
    find_neighbours(body);
    return body;
}

} // namespace kinelux::fit
