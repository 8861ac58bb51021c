// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/stitch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace kinelux::clean {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>; // smaller number first

Edge edge_of(const model::Triangle& t, std::size_t k) { return std::minmax(t[k], t[(k + 1) % 3]); }

struct Border {
    std::size_t triangle;
    std::size_t side; ///< from corner `side` to the next
};

// Edges of one triangle only, in the order of triangles.
std::vector<Border> borders_of(std::span<const model::Triangle> triangles) {
    std::vector<std::pair<Edge, Border>> edges;
    edges.reserve(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) edges.push_back({edge_of(triangles[t], k), {t, k}});
    std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) {
        return std::tie(a.first, a.second.triangle, a.second.side) <
               std::tie(b.first, b.second.triangle, b.second.side);
    });
    std::vector<Border> borders;
    for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
        while (j < edges.size() && edges[j].first == edges[i].first) ++j;
        if (j == i + 1) borders.push_back(edges[i].second);
    }
    std::sort(borders.begin(), borders.end(), [](const Border& a, const Border& b) {
        return std::pair(a.triangle, a.side) < std::pair(b.triangle, b.side);
    });
    return borders;
}

std::vector<std::uint32_t> ends_of(std::span<const model::Triangle> triangles,
                                   std::span<const Border> borders) {
    std::vector<std::uint32_t> ends;
    for (const Border& border : borders) {
        ends.push_back(triangles[border.triangle][border.side]);
        ends.push_back(triangles[border.triangle][(border.side + 1) % 3]);
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    return ends;
}

/// Points by the cell of a grid they lie in.
class PointGrid {
public:
    PointGrid(std::span<const Vec3> points, std::span<const std::uint32_t> numbers, double reach)
        : points_(points), reach_(reach) {
        Vec3 high(points[numbers.front()]);
        low_ = high;
        for (const std::uint32_t n : numbers) {
            low_ = glm::min(low_, points[n]);
            high = glm::max(high, points[n]);
        }
        const Vec3 extent = high - low_;
        const double longest = std::max({extent.x, extent.y, extent.z});
        // About as many cells along the longest side as points would have on it, spread over a surface.
        cell_ = std::max(longest / std::sqrt(static_cast<double>(numbers.size())), 4.0 * reach);
        for (const std::uint32_t n : numbers) cells_[key(cell_of(points[n]))].push_back(n);
    }

    double cell() const { return cell_; }

    /// Calls visit(number) for all points within a box and a bit around it, some perhaps twice.
    template <typename Visit>
    void around(const Vec3& low, const Vec3& high, const Visit& visit) const {
        const std::array<std::int64_t, 3> from = cell_of(low - reach_), to = cell_of(high + reach_);
        for (std::int64_t i = from[0]; i <= to[0]; ++i)
            for (std::int64_t j = from[1]; j <= to[1]; ++j)
                for (std::int64_t k = from[2]; k <= to[2]; ++k) {
                    const auto cell = cells_.find(key({i, j, k}));
                    if (cell == cells_.end()) continue;
                    for (const std::uint32_t n : cell->second) visit(n);
                }
    }

private:
    std::array<std::int64_t, 3> cell_of(const Vec3& x) const {
        const Vec3 at = (x - low_) / cell_;
        return {static_cast<std::int64_t>(std::floor(at.x)), static_cast<std::int64_t>(std::floor(at.y)),
                static_cast<std::int64_t>(std::floor(at.z))};
    }
    static std::uint64_t key(const std::array<std::int64_t, 3>& c) {
        constexpr std::int64_t bias = std::int64_t{1} << 20;
        return (static_cast<std::uint64_t>(c[0] + bias) << 42) |
               (static_cast<std::uint64_t>(c[1] + bias) << 21) | static_cast<std::uint64_t>(c[2] + bias);
    }

    std::span<const Vec3> points_;
    double reach_, cell_ = 1.0;
    Vec3 low_{0.0};
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

// Border points that are near each other become the earliest of them.
void join_points(std::span<const Vec3> points, double tolerance, Stitched& work) {
    const std::vector<Border> borders = borders_of(work.triangles);
    if (borders.empty()) return;
    const std::vector<std::uint32_t> ends = ends_of(work.triangles, borders);
    std::vector<Edge> joined_by_edge;
    for (const model::Triangle& t : work.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            if (glm::distance(points[t[k]], points[t[(k + 1) % 3]]) <= tolerance)
                joined_by_edge.push_back(edge_of(t, k));
    std::sort(joined_by_edge.begin(), joined_by_edge.end());
    const PointGrid grid(points, ends, tolerance);
    std::map<std::uint32_t, std::uint32_t> becomes;
    for (const std::uint32_t n : ends) {
        std::optional<std::uint32_t> earliest;
        grid.around(points[n], points[n], [&](std::uint32_t other) {
            if (other >= n || becomes.contains(other) || (earliest && *earliest <= other)) return;
            if (glm::distance(points[n], points[other]) > tolerance) return;
            if (!std::binary_search(joined_by_edge.begin(), joined_by_edge.end(), Edge(other, n)))
                earliest = other;
        });
        if (!earliest) continue;
        becomes[n] = *earliest;
        work.largest_move = std::max(work.largest_move, glm::distance(points[n], points[*earliest]));
    }
    work.joined_points = becomes.size();
    if (becomes.empty()) return;
    Stitched kept = std::move(work);
    work = {.joined_points = kept.joined_points, .largest_move = kept.largest_move};
    for (std::size_t t = 0; t < kept.triangles.size(); ++t) {
        model::Triangle triangle = kept.triangles[t];
        for (std::uint32_t& corner : triangle)
            if (const auto found = becomes.find(corner); found != becomes.end()) corner = found->second;
        if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
            ++work.dropped;
            continue;
        }
        work.triangles.push_back(triangle);
        work.source.push_back(kept.source[t]);
    }
}

struct OnEdge {
    double along; ///< 0..1
    std::uint32_t point;
};

// Border points beside the inside of an edge of a triangle, in order along it.
std::vector<OnEdge> points_beside(std::span<const Vec3> points, std::uint32_t from, std::uint32_t to,
                                  std::uint32_t apex, const PointGrid& grid, double tolerance,
                                  double& largest_move) {
    std::vector<OnEdge> found;
    const Vec3 a = points[from], d = points[to] - a;
    const double length = glm::length(d);
    if (!(length > 2.0 * tolerance)) return found;
    const auto pieces = static_cast<std::size_t>(std::ceil(length / grid.cell()));
    for (std::size_t p = 0; p < pieces; ++p) {
        const Vec3 x = a + static_cast<double>(p) / static_cast<double>(pieces) * d;
        const Vec3 y = a + static_cast<double>(p + 1) / static_cast<double>(pieces) * d;
        grid.around(glm::min(x, y), glm::max(x, y), [&](std::uint32_t n) {
            if (n == from || n == to || n == apex) return;
            const double along = glm::dot(points[n] - a, d) / (length * length);
            if (along * length <= tolerance || (1.0 - along) * length <= tolerance) return;
            const double off = glm::distance(points[n], a + along * d);
            if (off > tolerance) return;
            if (std::none_of(found.begin(), found.end(), [&](const OnEdge& o) { return o.point == n; }))
                found.push_back({along, n});
            largest_move = std::max(largest_move, off);
        });
    }
    std::sort(found.begin(), found.end(), [](const OnEdge& l, const OnEdge& r) {
        return std::pair(l.along, l.point) < std::pair(r.along, r.point);
    });
    return found;
}

// Divides border edges at border points beside them, one edge of a triangle at a time. @return  whether any was
bool divide_edges(std::span<const Vec3> points, double tolerance, Stitched& work) {
    const std::vector<Border> borders = borders_of(work.triangles);
    if (borders.empty()) return false;
    const PointGrid grid(points, ends_of(work.triangles, borders), tolerance);
    std::vector<std::uint8_t> divided(work.triangles.size(), 0);
    const std::size_t before = work.divided_edges;
    for (const Border& border : borders) {
        if (divided[border.triangle] != 0) continue;
        const model::Triangle t = work.triangles[border.triangle];
        const std::uint32_t from = t[border.side], to = t[(border.side + 1) % 3],
                            apex = t[(border.side + 2) % 3];
        const std::vector<OnEdge> beside =
            points_beside(points, from, to, apex, grid, tolerance, work.largest_move);
        if (beside.empty()) continue;
        divided[border.triangle] = 1;
        work.divided_edges += beside.size();
        std::uint32_t last = from;
        for (std::size_t k = 0; k <= beside.size(); ++k) {
            const std::uint32_t next = k < beside.size() ? beside[k].point : to;
            if (k == 0)
                work.triangles[border.triangle] = {last, next, apex};
            else {
                work.triangles.push_back({last, next, apex});
                work.source.push_back(work.source[border.triangle]);
            }
            last = next;
        }
    }
    return work.divided_edges > before;
}

} // namespace

Stitched stitch_borders(std::span<const Vec3> points, std::span<const model::Triangle> triangles,
                        double tolerance) {
    Stitched work{.triangles = {triangles.begin(), triangles.end()}};
    work.source.resize(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) work.source[t] = t;
    if (!(tolerance > 0.0) || triangles.empty()) return work;
    join_points(points, tolerance, work);
    constexpr int most_rounds = 8; // a triangle may have three borders, and their parts borders again
    for (int round = 0; round < most_rounds && divide_edges(points, tolerance, work); ++round) {
    }
    return work;
}

} // namespace kinelux::clean
