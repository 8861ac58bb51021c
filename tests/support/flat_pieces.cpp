// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/flat_pieces.h"

#include <algorithm>
#include <cmath>

namespace kinelux::support {

namespace {

constexpr double height_rounding = 1e-14; ///< of the coordinates' size: below it a height is rounding
constexpr double cut_rounding = 1e-13;    ///< of the polygon's size: a line as close to its side does not cut

Plane plane_of(const geometry::Facet& facet) {
    Plane plane;
    const auto& [p0, p1, p2] = facet.corners;
    plane.origin = p0;
    plane.normal = facet.normal;
    plane.axis_u = glm::normalize(p1 - p0);
    plane.axis_v = glm::normalize(glm::cross(plane.normal, plane.axis_u));
    // Parameters are linear: solve for their slopes along the two sides that meet in the origin.
    const Vec2 e1 = plane.local(p1), e2 = plane.local(p2);
    const Vec2 d1 = facet.parameters[1] - facet.parameters[0], d2 = facet.parameters[2] - facet.parameters[0];
    const double determinant = cross(e1, e2);
    plane.parameter0 = facet.parameters[0];
    plane.parameter_du = (d1 * e2.y - d2 * e1.y) / determinant;
    plane.parameter_dv = (d2 * e1.x - d1 * e2.x) / determinant;
    return plane;
}

bool shares_side(const geometry::Facet& facet, const Vec3& from, const Vec3& to) {
    for (std::size_t c = 0; c < 3; ++c)
        if (facet.corners[c] == to && facet.corners[(c + 1) % 3] == from) return true;
    return false;
}

FlatPiece piece_of(std::span<const geometry::Facet> facets) {
    const auto largest =
        std::max_element(facets.begin(), facets.end(), [](auto& a, auto& b) { return a.area < b.area; });
    FlatPiece piece{plane_of(*largest), {}, {}};
    for (const geometry::Facet& facet : facets) {
        Polygon polygon;
        for (const Vec3& corner : facet.corners) polygon.push_back(piece.plane.local(corner));
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3 &from = facet.corners[c], &to = facet.corners[(c + 1) % 3];
            if (std::none_of(facets.begin(), facets.end(),
                             [&](const auto& other) { return shares_side(other, from, to); }))
                piece.outline.push_back({polygon[c], polygon[(c + 1) % 3]});
        }
        piece.parts.push_back(std::move(polygon));
    }
    return piece;
}

// The height over another plane as a linear function of the coordinates in this one.
struct HeightFunction {
    double constant;
    Vec2 slope;
    double rounding;

    HeightFunction(const FlatPiece& piece, const Plane& other)
        : constant(other.height(piece.plane.origin)),
          slope(glm::dot(piece.plane.axis_u, other.normal), glm::dot(piece.plane.axis_v, other.normal)),
          rounding(0.0) {
        double size = std::max(glm::length(piece.plane.origin), glm::length(other.origin));
        for (const Polygon& part : piece.parts) size = std::max(size, diameter(part));
        rounding = height_rounding * size;
    }
    double operator()(const Vec2& p) const {
        const double height = constant + glm::dot(slope, p);
        return std::abs(height) < rounding ? 0.0 : height;
    }
};

template <class Height>
Polygon clipped(const Polygon& polygon, const Height& height) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double hp = height(p), hq = height(q);
        if (hp >= 0.0) kept.push_back(p);
        if (hp * hq < 0.0) kept.push_back(p + (q - p) * (hp / (hp - hq)));
    }
    const bool any_above =
        std::any_of(kept.begin(), kept.end(), [&](const Vec2& p) { return height(p) > 0.0; });
    return any_above && kept.size() >= 3 ? kept : Polygon();
}

} // namespace

double diameter(std::span<const Vec2> polygon) {
    double result = 0.0;
    for (const Vec2& p : polygon)
        for (const Vec2& q : polygon) result = std::max(result, glm::distance(p, q));
    return result;
}

std::vector<FlatPiece> flat_pieces(const geometry::ElementShape& shape) {
    if (shape.planar) return {piece_of(shape.facets)};
    std::vector<FlatPiece> pieces;
    for (const geometry::Facet& facet : shape.facets) pieces.push_back(piece_of(std::span(&facet, 1)));
    return pieces;
}

FlatPiece in_front(const FlatPiece& piece, const Plane& plane) {
    const HeightFunction height(piece, plane);
    FlatPiece front{piece.plane, {}, {}};
    for (const Polygon& part : piece.parts)
        if (Polygon kept = clipped(part, height); !kept.empty()) front.parts.push_back(std::move(kept));
    for (const Line& side : piece.outline) {
        const double h0 = height(side.from), h1 = height(side.to);
        if (std::max(h0, h1) < 0.0) continue;
        const Vec2 crossing =
            h0 * h1 < 0.0 ? side.from + (side.to - side.from) * (h0 / (h0 - h1)) : side.from;
        front.outline.push_back({h0 < 0.0 ? crossing : side.from, h1 < 0.0 ? crossing : side.to});
    }
    return front;
}

std::vector<Polygon> cut(const Polygon& polygon, const Line& line) {
    const Vec2 direction = glm::normalize(line.to - line.from);
    const double rounding = cut_rounding * diameter(polygon);
    const auto left = [&](const Vec2& p) {
        const double distance = cross(direction, p - line.from);
        return std::abs(distance) < rounding ? 0.0 : distance;
    };
    std::vector<Polygon> parts;
    for (const double side : {1.0, -1.0})
        if (Polygon part = clipped(polygon, [&](const Vec2& p) { return side * left(p); }); !part.empty())
            parts.push_back(std::move(part));
    return parts;
}

} // namespace kinelux::support
