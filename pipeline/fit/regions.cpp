// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/regions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "fit/triangulate.h"

namespace kinelux::fit {

namespace {

// A triangle thinner than this share of its longest edge is rounding on a straight boundary, not area.
constexpr double flat_share = 1e-14;

double twice_area(const std::vector<Vec2>& points, const model::Triangle& t) {
    const Vec2 ab = points[t[1]] - points[t[0]], ac = points[t[2]] - points[t[0]];
    return ab.x * ac.y - ab.y * ac.x;
}

double longest_edge(const std::vector<Vec2>& points, const model::Triangle& t) {
    return std::max({glm::distance(points[t[0]], points[t[1]]), glm::distance(points[t[1]], points[t[2]]),
                     glm::distance(points[t[2]], points[t[0]])});
}

// How often directed edges run around a point counter-clockwise.
int winding(std::span<const Vec2> points, std::span<const Edge> edges, const Vec2& p) {
    int turns = 0;
    for (const Edge& edge : edges) {
        const Vec2 &a = points[edge[0]], &b = points[edge[1]];
        if ((a.y <= p.y) == (b.y <= p.y)) continue;
        const double left = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        if (a.y <= p.y && left > 0.0) ++turns;
        if (a.y > p.y && left < 0.0) --turns;
    }
    return turns;
}

constexpr std::int32_t outside = -1;

// Parts of a triangulation that its kept edges separate: one number per triangle, `outside` where no domain is.
struct Parts {
    std::vector<std::int32_t> part_of;
    std::vector<double> areas;
};

Parts separate(const Triangulation& mesh, std::span<const Vec2> points, std::span<const Edge> boundary) {
    constexpr std::int32_t unseen = -2;
    Parts parts{std::vector<std::int32_t>(mesh.triangles.size(), unseen), {}};
    for (std::size_t seed = 0; seed < mesh.triangles.size(); ++seed) {
        if (parts.part_of[seed] != unseen) continue;
        const std::int32_t part = static_cast<std::int32_t>(parts.areas.size());
        std::vector<std::size_t> members{seed};
        parts.part_of[seed] = part;
        std::size_t largest = seed;
        double area = 0.0;
        for (std::size_t i = 0; i < members.size(); ++i) {
            const std::size_t t = members[i];
            area += 0.5 * twice_area(mesh.points, mesh.triangles[t]);
            if (twice_area(mesh.points, mesh.triangles[t]) > twice_area(mesh.points, mesh.triangles[largest]))
                largest = t;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t next = mesh.neighbours[t][k];
                if (next < 0 || mesh.kept[t][k] != 0 || parts.part_of[next] != unseen) continue;
                parts.part_of[next] = part;
                members.push_back(static_cast<std::size_t>(next));
            }
        }
        const model::Triangle& t = mesh.triangles[largest];
        const Vec2 centre = (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3.0;
        if (winding(points, boundary, centre) > 0) {
            parts.areas.push_back(area);
        } else {
            for (const std::size_t member : members) parts.part_of[member] = outside;
        }
    }
    return parts;
}

// Lengths of what parts share: by part and neighbour; the whole boundary of a part under its own number.
std::vector<std::map<std::int32_t, double>> shared_lengths(const Triangulation& mesh, const Parts& parts) {
    std::vector<std::map<std::int32_t, double>> shared(parts.areas.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::int32_t part = parts.part_of[t];
        if (part == outside) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t next = mesh.neighbours[t][k];
            const std::int32_t other = next < 0 ? outside : parts.part_of[next];
            if (other == part) continue;
            const double length =
                glm::distance(mesh.points[mesh.triangles[t][k]], mesh.points[mesh.triangles[t][(k + 1) % 3]]);
            shared[part][part] += length;
            if (other != outside) shared[part][other] += length;
        }
    }
    return shared;
}

// Joins specks to the neighbour with the longest common boundary, the smallest first.
void join_specks(const Triangulation& mesh, Parts& parts, const RegionOptions& options) {
    double whole = 0.0;
    for (const double area : parts.areas) whole += area;
    std::vector<std::uint8_t> settled(parts.areas.size(), 0);
    while (true) {
        const std::vector<std::map<std::int32_t, double>> shared = shared_lengths(mesh, parts);
        std::optional<std::int32_t> speck;
        for (std::size_t p = 0; p < parts.areas.size(); ++p) {
            const std::int32_t part = static_cast<std::int32_t>(p);
            if (shared[p].empty() || settled[p] != 0) continue;
            const double width = 2.0 * parts.areas[p] / shared[p].at(part);
            if (width >= options.least_width && parts.areas[p] >= options.least_share * whole) continue;
            if (!speck || parts.areas[p] < parts.areas[*speck]) speck = part;
        }
        if (!speck) return;
        settled[*speck] = 1;
        std::int32_t host = outside;
        double longest = 0.0;
        for (const auto& [other, length] : shared[*speck]) {
            if (other != *speck && length > longest) {
                longest = length;
                host = other;
            }
        }
        if (host == outside) continue;
        parts.areas[host] += parts.areas[*speck];
        std::replace(parts.part_of.begin(), parts.part_of.end(), *speck, host);
    }
}

// The triangles inside closed edges each of which has the domain on one side only.
std::vector<std::uint8_t> inner_triangles(const Triangulation& mesh) {
    constexpr std::uint8_t unseen = 2;
    std::vector<std::uint8_t> inner(mesh.triangles.size(), unseen);
    std::vector<std::size_t> open;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (mesh.neighbours[t][k] >= 0 || inner[t] != unseen) continue;
            inner[t] = mesh.kept[t][k];
            open.push_back(t);
        }
    }
    for (std::size_t i = 0; i < open.size(); ++i) {
        const std::size_t t = open[i];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t next = mesh.neighbours[t][k];
            if (next < 0 || inner[next] != unseen) continue;
            inner[next] = inner[t] ^ mesh.kept[t][k];
            open.push_back(static_cast<std::size_t>(next));
        }
    }
    return inner;
}

// A region from the edges around it, triangulated afresh so that nothing of dropped cuts is left inside.
Region make_region(const std::vector<Vec2>& points, std::vector<Edge> edges) {
    Region region;
    std::map<std::uint32_t, std::uint32_t> number;
    for (Edge& edge : edges) {
        for (std::uint32_t& end : edge) {
            const auto [at, fresh] = number.try_emplace(end, static_cast<std::uint32_t>(number.size()));
            if (fresh) region.points.push_back(points[end]);
            end = at->second;
        }
    }
    const Triangulation mesh = triangulate(region.points, edges);
    const std::vector<std::uint8_t> inner = inner_triangles(mesh);
    region.points = mesh.points;
    double largest = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const model::Triangle& triangle = mesh.triangles[t];
        const double longest = longest_edge(mesh.points, triangle);
        const double twice = twice_area(mesh.points, triangle);
        if (inner[t] != 1 || twice <= flat_share * longest * longest) continue;
        region.triangles.push_back(triangle);
        region.area += 0.5 * twice;
        if (twice > largest) {
            largest = twice;
            region.inner =
                (mesh.points[triangle[0]] + mesh.points[triangle[1]] + mesh.points[triangle[2]]) / 3.0;
        }
    }
    region.loops = chain_loops(region.points, edges);
    return region;
}

double loop_area(std::span<const Vec2> points, const std::vector<std::uint32_t>& loop) {
    double twice = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec2 a = points[loop[i]] - points[loop[0]],
                   b = points[loop[(i + 1) % loop.size()]] - points[loop[0]];
        twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * twice;
}

} // namespace

std::vector<std::vector<std::uint32_t>> chain_loops(std::span<const Vec2> points,
                                                    std::span<const Edge> edges) {
    std::vector<std::vector<std::size_t>> leaving(points.size());
    for (std::size_t e = 0; e < edges.size(); ++e) leaving[edges[e][0]].push_back(e);
    std::vector<std::uint8_t> used(edges.size(), 0);
    const auto angle = [&](std::uint32_t from, std::uint32_t to) {
        return std::atan2(points[to].y - points[from].y, points[to].x - points[from].x);
    };
    // The edge that bounds the wedge on the left of the edge we came by: the first one clockwise from it.
    const auto next_edge = [&](const Edge& came) -> std::optional<std::size_t> {
        std::optional<std::size_t> best;
        double least = std::numeric_limits<double>::infinity();
        for (const std::size_t e : leaving[came[1]]) {
            if (used[e] != 0) continue;
            double turn = angle(came[1], came[0]) - angle(came[1], edges[e][1]);
            if (turn <= 0.0) turn += 2.0 * std::numbers::pi;
            if (turn < least) {
                least = turn;
                best = e;
            }
        }
        return best;
    };
    std::vector<std::vector<std::uint32_t>> loops;
    for (std::size_t start = 0; start < edges.size(); ++start) {
        if (used[start] != 0) continue;
        std::vector<std::uint32_t> loop;
        std::optional<std::size_t> e = start;
        while (e) {
            used[*e] = 1;
            loop.push_back(edges[*e][0]);
            if (edges[*e][1] == edges[start][0]) break;
            e = next_edge(edges[*e]);
        }
        if (e && loop.size() > 2) loops.push_back(std::move(loop));
    }
    std::stable_sort(loops.begin(), loops.end(), [&](const auto& a, const auto& b) {
        return loop_area(points, a) > loop_area(points, b);
    });
    return loops;
}

std::vector<Region> divide_domain(std::span<const Vec2> points, std::span<const Edge> boundary,
                                  std::span<const Edge> cuts, const RegionOptions& options) {
    std::vector<Edge> edges(boundary.begin(), boundary.end());
    edges.insert(edges.end(), cuts.begin(), cuts.end());
    const Triangulation mesh = triangulate(points, edges);
    Parts parts = separate(mesh, points, boundary);
    join_specks(mesh, parts, options);

    std::map<std::int32_t, std::vector<Edge>> around;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::int32_t part = parts.part_of[t];
        if (part == outside) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t next = mesh.neighbours[t][k];
            if (next >= 0 && parts.part_of[next] == part) continue;
            around[part].push_back({mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]});
        }
    }
    std::vector<Region> regions;
    for (auto& [part, around_part] : around) {
        Region region = make_region(mesh.points, std::move(around_part));
        if (!region.triangles.empty()) regions.push_back(std::move(region));
    }
    return regions;
}

} // namespace kinelux::fit
