// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/facet_loops.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

namespace kinelux::geometry {

namespace {

using Vertex = std::uint32_t;

// Triangles whose corners are numbers: equal points, equal numbers.
struct WeldedTriangles {
    std::vector<std::array<Vertex, 3>> triangles;
    std::size_t vertices = 0;
};

WeldedTriangles weld(std::span<const std::array<Vec3, 3>> triangles) {
    std::map<std::tuple<double, double, double>, Vertex> numbers;
    WeldedTriangles welded;
    for (const std::array<Vec3, 3>& corners : triangles) {
        std::array<Vertex, 3>& own = welded.triangles.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            const auto key = std::make_tuple(corners[c].x, corners[c].y, corners[c].z);
            own[c] = numbers.try_emplace(key, static_cast<Vertex>(numbers.size())).first->second;
        }
    }
    welded.vertices = numbers.size();
    return welded;
}

// A directed edge that is not cancelled, from a triangle's corner to the next.
struct Edge {
    Vertex from, to;
    TriangleCorner start;
    bool used = false;
};

std::vector<Edge> boundary_edges(const WeldedTriangles& welded) {
    std::map<std::pair<Vertex, Vertex>, std::vector<TriangleCorner>> open;
    for (std::uint32_t t = 0; t < welded.triangles.size(); ++t) {
        const std::array<Vertex, 3>& v = welded.triangles[t];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const auto opposite = open.find({v[(c + 1) % 3], v[c]});
            if (opposite == open.end())
                open[{v[c], v[(c + 1) % 3]}].push_back({t, c});
            else if (opposite->second.pop_back(); opposite->second.empty())
                open.erase(opposite);
        }
    }
    std::vector<Edge> edges;
    for (const auto& [ends, starts] : open)
        for (const TriangleCorner& start : starts) edges.push_back({ends.first, ends.second, start});
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.start.triangle, a.start.corner) < std::tie(b.start.triangle, b.start.corner);
    });
    return edges;
}

} // namespace

std::vector<std::vector<TriangleCorner>> boundary_loops(std::span<const std::array<Vec3, 3>> triangles) {
    const WeldedTriangles welded = weld(triangles);
    std::vector<Edge> edges = boundary_edges(welded);
    std::vector<std::vector<std::size_t>> leaving(welded.vertices);
    for (std::size_t e = edges.size(); e-- > 0;) leaving[edges[e].from].push_back(e);

    // As many edges arrive at a vertex as leave it, so a walk over unused edges can only end where it began.
    std::vector<std::vector<TriangleCorner>> loops;
    const auto close = [&](std::span<const std::size_t> walk) {
        if (walk.size() < 3) return;
        std::vector<TriangleCorner>& loop = loops.emplace_back();
        for (const std::size_t e : walk) loop.push_back(edges[e].start);
    };
    for (std::size_t first = 0; first < edges.size(); ++first) {
        if (edges[first].used) continue;
        std::vector<std::size_t> walk;
        for (Vertex at = edges[first].from; walk.empty() || at != edges[first].from;) {
            while (edges[leaving[at].back()].used) leaving[at].pop_back();
            const std::size_t next = walk.empty() ? first : leaving[at].back();
            edges[next].used = true;
            walk.push_back(next);
            at = edges[next].to;
            const auto met =
                std::find_if(walk.begin(), walk.end(), [&](std::size_t e) { return edges[e].from == at; });
            if (met == walk.end()) continue;
            close(std::span(met, walk.end()));
            walk.erase(met, walk.end());
            if (walk.empty()) break;
        }
    }
    return loops;
}

std::vector<std::size_t> turning_points(std::span<const Vec3> loop, double tolerance) {
    const auto turns = [&](std::size_t before, std::size_t at, std::size_t after) {
        const Vec3 in = loop[at] - loop[before], out = loop[after] - loop[at];
        return glm::length(glm::cross(in, out)) > tolerance * glm::length(in) * glm::length(out) ||
               !(glm::dot(in, out) > 0.0);
    };
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::size_t before = kept.empty() ? loop.size() - 1 : kept.back();
        if (turns(before, i, (i + 1) % loop.size())) kept.push_back(i);
    }
    return kept;
}

} // namespace kinelux::geometry
