// SPDX-License-Identifier: GPL-3.0-or-later
#include "cluster/patch_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/domain_cut.h"
#include "geometry/surface.h"

namespace kinelux::cluster {

namespace {

// A cell of which less than this share is left by trimming joins a neighbour: its basis would be as good as singular,
// and it would cost as much as a whole one.
constexpr double sliver_share = 0.05;

struct Bounds {
    Vec2 low, high;
};

Bounds parameter_bounds(const model::Patch& patch) {
    Bounds bounds{patch.points[patch.triangles.front()[0]], patch.points[patch.triangles.front()[0]]};
    for (const model::Triangle& triangle : patch.triangles) {
        for (const std::uint32_t corner : triangle) {
            bounds.low = glm::min(bounds.low, patch.points[corner]);
            bounds.high = glm::max(bounds.high, patch.points[corner]);
        }
    }
    return bounds;
}

// Metres on the surface per unit of u and of v, where they are most: 1 on planes, the equator on whole spheres, the
// outer circle on tori.
Vec2 metres_per_parameter(const model::Surface& surface, const Bounds& bounds) {
    if (surface.type == model::SurfaceType::Plane) return Vec2{1.0};
    constexpr int samples = 32;    // along u and along v
    constexpr double share = 1e-3; // of the extent: short enough for a tangent, long enough for rounding
    const Vec2 extent = bounds.high - bounds.low, step = share * extent;
    const auto at = [&](const Vec2& uv) { return geometry::position(surface, uv); };
    Vec2 most{0.0};
    for (int i = 0; i <= samples; ++i)
        for (int j = 0; j <= samples; ++j) {
            const Vec2 middle =
                bounds.low + 0.5 * step + (extent - step) * Vec2{i, j} / static_cast<double>(samples);
            const Vec2 half{0.5 * step};
            const Vec2 speed{glm::distance(at(middle - Vec2{half.x, 0.0}), at(middle + Vec2{half.x, 0.0})),
                             glm::distance(at(middle - Vec2{0.0, half.y}), at(middle + Vec2{0.0, half.y}))};
            most = glm::max(most, speed / step);
        }
    return most;
}

// Largest steps of u and v that keep an element from bending round: a quarter turn.
Vec2 largest_turn(const model::Surface& surface) {
    constexpr double quarter = 0.5 * std::numbers::pi;
    constexpr double any = std::numeric_limits<double>::infinity();
    switch (surface.type) {
    case model::SurfaceType::Cylinder:
    case model::SurfaceType::Cone: return {quarter, any};
    case model::SurfaceType::Sphere:
    case model::SurfaceType::Torus: return {quarter, quarter};
    default: return {any, any};
    }
}

double area(const Piece& piece) {
    double twice = 0.0;
    for (const model::DomainTriangle& t : piece) {
        twice += (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
    }
    return 0.5 * twice;
}

using EdgeKey = std::array<double, 4>; // both ends, the smaller first

EdgeKey edge_key(const Vec2& a, const Vec2& b) {
    if (std::make_pair(b.x, b.y) < std::make_pair(a.x, a.y)) return {b.x, b.y, a.x, a.y};
    return {a.x, a.y, b.x, b.y};
}

// Length of the common boundary of every two pieces that share any; pieces of a cut domain share edges to the last bit.
std::vector<std::map<std::size_t, double>> shared_lengths(const std::vector<Piece>& pieces) {
    std::map<EdgeKey, std::vector<std::size_t>> users;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        for (const model::DomainTriangle& t : pieces[i]) {
            for (std::size_t k = 0; k < 3; ++k) users[edge_key(t[k], t[(k + 1) % 3])].push_back(i);
        }
    }
    std::vector<std::map<std::size_t, double>> shared(pieces.size());
    for (const auto& [edge, faces] : users) {
        if (faces.size() != 2 || faces[0] == faces[1]) continue;
        const double length = std::hypot(edge[2] - edge[0], edge[3] - edge[1]);
        shared[faces[0]][faces[1]] += length;
        shared[faces[1]][faces[0]] += length;
    }
    return shared;
}

std::optional<std::size_t> longest_neighbour(const std::map<std::size_t, double>& neighbours) {
    std::optional<std::size_t> best;
    double best_length = 0.0;
    for (const auto& [other, length] : neighbours) {
        if (length > best_length) {
            best_length = length;
            best = other;
        }
    }
    return best;
}

// Joins pieces smaller than `smallest` to the neighbour with the longest common edge, the smallest piece first, until
// none is left that has a neighbour.
std::vector<Piece> join_slivers(std::vector<Piece> pieces, double smallest) {
    std::vector<double> areas;
    areas.reserve(pieces.size());
    for (const Piece& piece : pieces) areas.push_back(area(piece));
    std::vector<std::map<std::size_t, double>> shared = shared_lengths(pieces);
    while (true) {
        std::optional<std::size_t> sliver;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            if (pieces[i].empty() || areas[i] >= smallest || shared[i].empty()) continue;
            if (!sliver || areas[i] < areas[*sliver]) sliver = i;
        }
        if (!sliver) break;
        const std::optional<std::size_t> host = longest_neighbour(shared[*sliver]);
        if (!host) {
            shared[*sliver].clear();
            continue;
        }
        pieces[*host].insert(pieces[*host].end(), pieces[*sliver].begin(), pieces[*sliver].end());
        areas[*host] += areas[*sliver];
        pieces[*sliver].clear();
        for (const auto& [other, length] : shared[*sliver]) {
            shared[other].erase(*sliver);
            if (other == *host) continue;
            shared[other][*host] += length;
            shared[*host][other] += length;
        }
        shared[*sliver].clear();
    }
    std::erase_if(pieces, [](const Piece& piece) { return piece.empty(); });
    return pieces;
}

} // namespace

Vec2 extent_on_surface(const model::Patch& patch) {
    const Bounds bounds = parameter_bounds(patch);
    return (bounds.high - bounds.low) * metres_per_parameter(patch.surface, bounds);
}

std::vector<Piece> cut_patch(const model::Patch& patch, double largest_edge) {
    const Bounds bounds = parameter_bounds(patch);
    const Vec2 step = glm::min(Vec2{largest_edge} / metres_per_parameter(patch.surface, bounds),
                               largest_turn(patch.surface));
    Piece whole;
    for (const model::Triangle& t : patch.triangles) {
        whole.push_back({patch.points[t[0]], patch.points[t[1]], patch.points[t[2]]});
    }
    const std::vector<double> u_lines = geometry::grid_lines(bounds.low.x, bounds.high.x, step.x);
    const std::vector<double> v_lines = geometry::grid_lines(bounds.low.y, bounds.high.y, step.y);
    if (u_lines.size() == 2 && v_lines.size() == 2) return {whole};

    std::vector<Piece> pieces;
    for (geometry::DomainCell& cell : geometry::cut_domain(whole, u_lines, v_lines)) {
        pieces.push_back(std::move(cell.triangles));
    }
    const double full_cell = (u_lines[1] - u_lines[0]) * (v_lines[1] - v_lines[0]);
    return join_slivers(std::move(pieces), sliver_share * full_cell);
}

} // namespace kinelux::cluster
