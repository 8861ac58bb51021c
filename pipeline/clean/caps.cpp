// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/caps.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

namespace kinelux::clean {

namespace {

// Dividing at one cap may leave another one behind it; chains longer than this are given up.
constexpr int most_rounds = 16;

double height(std::span<const Vec3> points, const model::Triangle& t) {
    const Vec3 &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    return longest > 0.0 ? glm::length(glm::cross(b - a, c - a)) / longest : 0.0;
}

bool has_equal_corners(const model::Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

// Corner from which the longest edge starts.
std::size_t longest_edge(std::span<const Vec3> points, const model::Triangle& t) {
    std::size_t best = 0;
    double longest = -1.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double length = glm::distance(points[t[k]], points[t[(k + 1) % 3]]);
        if (length > longest) {
            longest = length;
            best = k;
        }
    }
    return best;
}

using EdgeKey = std::array<std::uint32_t, 2>;

EdgeKey edge_key(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

struct Faces {
    std::vector<model::Triangle> triangles;
    std::vector<std::uint32_t> source;
    std::vector<std::uint8_t> gone;
};

// The other face at an edge, if there is exactly one.
std::optional<std::uint32_t> other_face(const Faces& faces,
                                        const std::map<EdgeKey, std::vector<std::uint32_t>>& users,
                                        const EdgeKey& edge, std::uint32_t self) {
    std::optional<std::uint32_t> other;
    for (const std::uint32_t f : users.at(edge)) {
        if (f == self || faces.gone[f] != 0) continue;
        if (other) return std::nullopt;
        other = f;
    }
    return other;
}

// Divides a face at the cap's middle corner: the face takes one half, the cap becomes the other.
void divide(Faces& faces, std::uint32_t cap, std::uint32_t face, std::uint32_t middle, const EdgeKey& edge) {
    model::Triangle& t = faces.triangles[face];
    while (edge_key(t[0], t[1]) != edge) t = {t[1], t[2], t[0]};
    faces.triangles[cap] = {middle, t[1], t[2]};
    faces.source[cap] = faces.source[face];
    t[1] = middle;
}

// One pass over all caps. A face is divided at most once a pass, for its edges are looked up in a table made before.
bool divide_round(std::span<const Vec3> points, double least_height, Faces& faces) {
    std::map<EdgeKey, std::vector<std::uint32_t>> users;
    std::vector<std::uint32_t> caps;
    for (std::uint32_t f = 0; f < faces.triangles.size(); ++f) {
        if (faces.gone[f] != 0) continue;
        const model::Triangle& t = faces.triangles[f];
        for (std::size_t k = 0; k < 3; ++k) users[edge_key(t[k], t[(k + 1) % 3])].push_back(f);
        if (height(points, t) <= least_height) caps.push_back(f);
    }
    std::vector<std::uint8_t> touched(faces.triangles.size(), 0);
    for (const std::uint32_t cap : caps) {
        if (touched[cap] != 0) continue;
        const model::Triangle& t = faces.triangles[cap];
        const std::size_t k = longest_edge(points, t);
        const EdgeKey edge = edge_key(t[k], t[(k + 1) % 3]);
        const std::uint32_t middle = t[(k + 2) % 3];
        const std::optional<std::uint32_t> other = other_face(faces, users, edge, cap);
        if (other && touched[*other] != 0) continue;
        const bool useless =
            !other || std::count(faces.triangles[*other].begin(), faces.triangles[*other].end(), middle) > 0;
        if (useless) {
            faces.gone[cap] = 1;
            continue;
        }
        divide(faces, cap, *other, middle, edge);
        touched[cap] = touched[*other] = 1;
    }
    return !caps.empty();
}

} // namespace

DividedCaps divide_at_caps(std::span<const Vec3> points, const std::vector<model::Triangle>& triangles,
                           double least_height) {
    Faces faces;
    DividedCaps result;
    for (std::size_t f = 0; f < triangles.size(); ++f) {
        if (height(points, triangles[f]) <= least_height) ++result.dropped;
        faces.triangles.push_back(triangles[f]);
        faces.source.push_back(static_cast<std::uint32_t>(f));
        faces.gone.push_back(has_equal_corners(triangles[f]) ? 1 : 0);
    }
    for (int round = 0; round < most_rounds && divide_round(points, least_height, faces); ++round) {
    }
    for (std::size_t f = 0; f < faces.triangles.size(); ++f) {
        if (faces.gone[f] != 0 || height(points, faces.triangles[f]) <= least_height) continue;
        result.triangles.push_back(faces.triangles[f]);
        result.source.push_back(faces.source[f]);
    }
    return result;
}

} // namespace kinelux::clean
