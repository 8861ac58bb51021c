// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/outer_pieces.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kinelux::kernel {

Vec2 barycentric(const geometry::Facet& facet, const Vec3& point) {
    const Vec3 e1 = facet.corners[1] - facet.corners[0], e2 = facet.corners[2] - facet.corners[0];
    const Vec3 d = point - facet.corners[0];
    return {glm::dot(glm::cross(d, e2), facet.normal) / (2.0 * facet.area),
            glm::dot(glm::cross(e1, d), facet.normal) / (2.0 * facet.area)};
}

namespace {

constexpr double sliver = 1e-9; // of the outer element's size

Vec3 corner(const OuterPiece& piece, const Vec2& at) {
    const geometry::Facet& f = *piece.facet;
    return f.corners[0] + at.x * (f.corners[1] - f.corners[0]) + at.y * (f.corners[2] - f.corners[0]);
}

// Both parts of pieces that lie on both sides of a line. @param beyond  distance of a point from it, signed [m]
// @param wanted  whether a piece is to be cut at all
template <typename Beyond, typename Wanted>
std::vector<OuterPiece> cut(std::vector<OuterPiece> pieces, double size, const Beyond& beyond,
                            const Wanted& wanted) {
    visibility::LoopCutter<Vec2> cutter;
    std::vector<OuterPiece> result;
    for (OuterPiece& piece : pieces) {
        double left = 0.0, right = 0.0;
        for (const Vec2& at : piece.corners) {
            const double distance = beyond(corner(piece, at));
            left = std::min(left, distance);
            right = std::max(right, distance);
        }
        if (left > -sliver * size || right < sliver * size || !wanted(piece)) {
            result.push_back(std::move(piece));
            continue;
        }
        for (const double side : {-1.0, 1.0}) {
            cutter.begin(piece.corners);
            cutter.keep([&](const Vec2& at) { return side * beyond(corner(piece, at)); });
            if (cutter.loop().size() >= 3)
                result.push_back({piece.facet, {cutter.loop().begin(), cutter.loop().end()}});
        }
    }
    return result;
}

} // namespace

std::vector<OuterPiece> pieces_in_front(const geometry::ElementShape& a, const visibility::HalfSpace& front,
                                        double slack) {
    const bool whole =
        a.outline.size() == 1 && visibility::is_convex(a.outline.front(), a.facets.front().normal, 1e-12);
    std::vector<OuterPiece> pieces;
    visibility::LoopCutter<Vec3> cutter;
    const auto add = [&](std::span<const Vec3> loop, const geometry::Facet& facet) {
        cutter.begin(loop);
        cutter.keep([&](const Vec3& point) { return front.distance(point) - slack; });
        if (cutter.loop().size() < 3) return;
        pieces.push_back({&facet, {}});
        for (const Vec3& point : cutter.loop()) pieces.back().corners.push_back(barycentric(facet, point));
    };
    if (whole)
        add(a.outline.front(), a.facets.front());
    else
        for (const geometry::Facet& facet : a.facets) add(facet.corners, facet);
    return pieces;
}

std::vector<OuterPiece> cut_below_edges(std::vector<OuterPiece> pieces, const visibility::Loops3& loops,
                                        const visibility::HalfSpace& front, double size) {
    constexpr double narrow = 0.1;         // of the outer element's size
    constexpr std::size_t most_edges = 64; // of the inner polygon; more are left to the planning of cells
    if (loops.points.size() > most_edges) return pieces;
    const auto near = [&](const OuterPiece& piece) {
        return std::any_of(piece.corners.begin(), piece.corners.end(), [&](const Vec2& at) {
            return front.distance(corner(piece, at)) <= narrow * size;
        });
    };
    for (std::size_t l = 0; l < loops.size(); ++l)
        for (std::size_t i = 0, j = loops[l].size() - 1; i < loops[l].size(); j = i++) {
            const Vec3& from = loops[l][j];
            const Vec3 across = glm::cross(loops[l][i] - from, front.normal);
            const double length = glm::length(across);
            if (!(length > 0.0)) continue;
            pieces = cut(
                std::move(pieces), size,
                [&](const Vec3& point) { return glm::dot(point - from, across) / length; }, near);
        }
    return pieces;
}

std::vector<OuterPiece> cut_at_blockers(std::vector<OuterPiece> pieces,
                                        std::span<const visibility::PlanarBlocker> blockers,
                                        const visibility::HalfSpace& front, double size) {
    for (const visibility::PlanarBlocker& blocker : blockers) {
        double lowest = size, highest = -size;
        for (const Vec3& point : blocker.loops.points) {
            lowest = std::min(lowest, front.distance(point));
            highest = std::max(highest, front.distance(point));
        }
        if (lowest > sliver * size || highest < sliver * size) continue;
        pieces = cut(
            std::move(pieces), size, [&](const Vec3& point) { return blocker.plane.distance(point); },
            [](const OuterPiece&) { return true; });
    }
    return pieces;
}

double area_of(const OuterPiece& piece) {
    double twice = 0.0;
    for (std::size_t i = 2; i < piece.corners.size(); ++i) {
        const Vec2 e = piece.corners[i - 1] - piece.corners[0], f = piece.corners[i] - piece.corners[0];
        twice += e.x * f.y - e.y * f.x;
    }
    return std::abs(twice) * piece.facet->area;
}

geometry::SurfaceNode probe(const geometry::ElementShape& outer, const OuterPiece& piece,
                            std::size_t corner) {
    constexpr double outwards = 0.6;
    Vec2 centre(0.0);
    for (const Vec2& at : piece.corners) centre += at / static_cast<double>(piece.corners.size());
    const Vec2 at = glm::mix(centre, piece.corners[corner % piece.corners.size()], outwards);
    Vec2 parameter;
    return geometry::node_at(outer, *piece.facet, {1.0 - at.x - at.y, at.x, at.y}, parameter);
}

} // namespace kinelux::kernel
