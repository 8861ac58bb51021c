// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/domain_cut.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include <glm/geometric.hpp>

namespace kinelux::geometry {

namespace {

using Polygon = std::vector<Vec2>; // convex, counter-clockwise

// A corner nearer to a line than this share of the lines' distance counts as lying on it, so that no sliver is cut off.
constexpr double on_line_share = 1e-10;

// Pieces thinner than this share of their longest edge are rounding, not area.
constexpr double flat_share = 1e-14;

// A family of parallel lines: axis 0 are u = lines[i], axis 1 are v = lines[i].
struct LineFamily {
    std::span<const double> lines;
    int axis;
    double tolerance;
};

LineFamily family(std::span<const double> lines, int axis) {
    const double distance =
        lines.size() < 2 ? 0.0 : (lines.back() - lines.front()) / static_cast<double>(lines.size() - 1);
    return {lines, axis, on_line_share * distance};
}

int side(const LineFamily& cut, const Vec2& p, double line) {
    const double distance = p[cut.axis] - line;
    if (std::abs(distance) <= cut.tolerance) return 0;
    return distance < 0.0 ? -1 : 1;
}

// The edge is taken in a canonical direction, so that both faces at the edge compute the same bits.
Vec2 crossing(const LineFamily& cut, Vec2 a, Vec2 b, double line) {
    if (std::make_pair(b.x, b.y) < std::make_pair(a.x, a.y)) std::swap(a, b);
    const int along = cut.axis, across = 1 - cut.axis;
    const double t = (line - a[along]) / (b[along] - a[along]);
    Vec2 p;
    p[along] = line;
    p[across] = a[across] + t * (b[across] - a[across]);
    return p;
}

// Divides a polygon into what lies below and above one line; a part that only touches it is empty.
std::pair<Polygon, Polygon> split(const LineFamily& cut, const Polygon& polygon, double line) {
    bool below = false, above = false;
    for (const Vec2& p : polygon) {
        below = below || side(cut, p, line) < 0;
        above = above || side(cut, p, line) > 0;
    }
    if (!above) return {polygon, {}};
    if (!below) return {{}, polygon};
    std::pair<Polygon, Polygon> parts;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const int side_a = side(cut, a, line), side_b = side(cut, b, line);
        if (side_a <= 0) parts.first.push_back(a);
        if (side_a >= 0) parts.second.push_back(a);
        if (side_a * side_b < 0) {
            const Vec2 p = crossing(cut, a, b, line);
            parts.first.push_back(p);
            parts.second.push_back(p);
        }
    }
    return parts;
}

// Calls take(strip, piece) for the pieces of a polygon between the lines. Lines are always taken in ascending order,
// so that an edge is divided in the same steps from both of its sides.
template <class Take>
void cut_into_strips(const LineFamily& cut, Polygon polygon, const Take& take) {
    if (cut.lines.size() < 2) {
        take(0, polygon);
        return;
    }
    const std::size_t strips = cut.lines.size() - 1;
    // Lines below the whole polygon cut nothing.
    double lowest = polygon.front()[cut.axis];
    for (const Vec2& p : polygon) lowest = std::min(lowest, p[cut.axis]);
    const auto first = std::lower_bound(cut.lines.begin() + 1, cut.lines.end() - 1, lowest);
    const std::size_t first_strip = static_cast<std::size_t>(first - cut.lines.begin()) - 1;
    for (std::size_t strip = first_strip; strip + 1 < strips && polygon.size() > 2; ++strip) {
        auto [below, above] = split(cut, polygon, cut.lines[strip + 1]);
        if (below.size() > 2) take(strip, below);
        polygon = std::move(above);
    }
    if (polygon.size() > 2) take(strips - 1, polygon);
}

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// A fan whose smallest triangle is as large as any corner's fan allows.
void triangulate(const Polygon& polygon, std::vector<model::DomainTriangle>& triangles) {
    const std::size_t n = polygon.size();
    const auto corner = [&](std::size_t apex, std::size_t i) { return polygon[(apex + i) % n]; };
    std::size_t best_apex = 0;
    double best_smallest = -1.0;
    for (std::size_t apex = 0; apex < n; ++apex) {
        double smallest = twice_area(corner(apex, 0), corner(apex, 1), corner(apex, 2));
        for (std::size_t i = 2; i + 1 < n; ++i) {
            smallest = std::min(smallest, twice_area(corner(apex, 0), corner(apex, i), corner(apex, i + 1)));
        }
        if (smallest > best_smallest) {
            best_smallest = smallest;
            best_apex = apex;
        }
    }
    for (std::size_t i = 1; i + 1 < n; ++i) {
        const model::DomainTriangle piece{corner(best_apex, 0), corner(best_apex, i),
                                          corner(best_apex, i + 1)};
        const double longest = std::max({glm::distance(piece[0], piece[1]), glm::distance(piece[1], piece[2]),
                                         glm::distance(piece[2], piece[0])});
        if (twice_area(piece[0], piece[1], piece[2]) > flat_share * longest * longest)
            triangles.push_back(piece);
    }
}

} // namespace

std::vector<DomainCell> cut_domain(std::span<const model::DomainTriangle> domain,
                                   std::span<const double> u_lines, std::span<const double> v_lines) {
    const LineFamily u_cut = family(u_lines, 0), v_cut = family(v_lines, 1);
    std::map<std::pair<std::size_t, std::size_t>, std::vector<model::DomainTriangle>> cells; // by row, column
    for (const model::DomainTriangle& triangle : domain) {
        const Polygon whole(triangle.begin(), triangle.end());
        cut_into_strips(u_cut, whole, [&](std::size_t column, const Polygon& strip) {
            cut_into_strips(v_cut, strip, [&](std::size_t row, const Polygon& piece) {
                triangulate(piece, cells[{row, column}]);
            });
        });
    }
    std::vector<DomainCell> result;
    for (auto& [place, triangles] : cells) {
        if (triangles.empty()) continue;
        result.push_back({static_cast<std::uint32_t>(place.second), static_cast<std::uint32_t>(place.first),
                          std::move(triangles)});
    }
    return result;
}

std::vector<double> grid_lines(double low, double high, double step) {
    // A domain larger than a whole number of steps by rounding only gets no extra line.
    constexpr double rounding = 1e-9;
    const double parts = std::max(1.0, std::ceil((high - low) / step - rounding));
    const std::size_t count = static_cast<std::size_t>(parts);
    std::vector<double> lines(count + 1);
    for (std::size_t i = 0; i <= count; ++i) lines[i] = low + (high - low) * static_cast<double>(i) / parts;
    lines.back() = high;
    return lines;
}

} // namespace kinelux::geometry
