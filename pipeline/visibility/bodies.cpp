// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "geometry/surface.h"
#include "visibility/occluders.h"

namespace kinelux::visibility {

namespace {

// Chords of a curved patch stay this close to its surface, relative to the size of the scene: half the length by which
// segments are pulled in, so that a hollow surface does not shadow the points on itself.
constexpr double relative_sag = 1e-5;
constexpr std::uint32_t max_parts = 16; ///< of a domain triangle's edge

Vec3 point_of(const model::Surface& surface, const Vec2& uv) {
    if (surface.type == model::SurfaceType::Plane)
        return surface.origin + uv.x * surface.axis_u + uv.y * surface.axis_v;
    return geometry::evaluate(surface, uv).position;
}

double extent_of(const model::PatchSet& patches) {
    Vec3 low(std::numeric_limits<double>::infinity()), high(-low);
    const auto add = [&](const Vec3& x) {
        low = glm::min(low, x);
        high = glm::max(high, x);
    };
    for (const model::Patch& patch : patches.patches)
        for (const Vec2& uv : patch.points) add(point_of(patch.surface, uv));
    for (const Vec3& x : patches.small.points) add(x);
    return low.x <= high.x ? glm::length(high - low) : 0.0;
}

// Into how many parts each edge of the patch's triangles is cut so that all chords are within `sag` of the surface.
std::uint32_t parts_of(const model::Patch& patch, double sag) {
    if (patch.surface.type == model::SurfaceType::Plane || !(sag > 0.0)) return 1;
    double largest = 0.0;
    for (const model::Triangle& triangle : patch.triangles)
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec2 a = patch.points[triangle[c]], b = patch.points[triangle[(c + 1) % 3]];
            const Vec3 chord = 0.5 * (point_of(patch.surface, a) + point_of(patch.surface, b));
            largest = std::max(largest, glm::distance(chord, point_of(patch.surface, 0.5 * (a + b))));
        }
    // The sag of a chord falls with the square of its length.
    const double parts = std::ceil(std::sqrt(largest / sag));
    return static_cast<std::uint32_t>(std::clamp(parts, 1.0, static_cast<double>(max_parts)));
}

void add_patch(Body& body, const model::Patch& patch, double sag) {
    const std::uint32_t parts = parts_of(patch, sag);
    const bool flipped = patch.surface.orientation < 0.0;
    const auto add_triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        body.triangles.push_back(flipped ? model::Triangle{a, c, b} : model::Triangle{a, b, c});
    };
    if (parts == 1) {
        const auto first = static_cast<std::uint32_t>(body.points.size());
        for (const Vec2& uv : patch.points) body.points.push_back(point_of(patch.surface, uv));
        for (const model::Triangle& t : patch.triangles)
            add_triangle(first + t[0], first + t[1], first + t[2]);
        return;
    }
    for (const model::Triangle& t : patch.triangles) {
        const Vec2 a = patch.points[t[0]], b = patch.points[t[1]], c = patch.points[t[2]];
        // Row r holds r + 1 points; its first one is number r (r + 1) / 2.
        const auto first = static_cast<std::uint32_t>(body.points.size());
        const auto at = [&](std::uint32_t row, std::uint32_t i) { return first + row * (row + 1) / 2 + i; };
        for (std::uint32_t row = 0; row <= parts; ++row)
            for (std::uint32_t i = 0; i <= row; ++i) {
                const double wb = static_cast<double>(row - i) / parts, wc = static_cast<double>(i) / parts;
                body.points.push_back(point_of(patch.surface, a + wb * (b - a) + wc * (c - a)));
            }
        for (std::uint32_t row = 0; row < parts; ++row)
            for (std::uint32_t i = 0; i <= row; ++i) {
                add_triangle(at(row, i), at(row + 1, i), at(row + 1, i + 1));
                if (i < row) add_triangle(at(row, i), at(row + 1, i + 1), at(row, i + 1));
            }
    }
}

std::vector<Body> empty_bodies(const model::Scene& scene) {
    std::vector<Body> bodies(scene.objects.size());
    for (std::size_t o = 0; o < bodies.size(); ++o) bodies[o].moves = scene.objects[o].motion.has_value();
    return bodies;
}

} // namespace

std::vector<Body> bodies_of(const model::PatchSet& patches, const model::Scene& scene) {
    std::vector<Body> bodies = empty_bodies(scene);
    const double sag = relative_sag * extent_of(patches);
    for (const model::Patch& patch : patches.patches) add_patch(bodies[patch.object.value], patch, sag);

    const model::SmallTriangles& small = patches.small;
    std::vector<std::unordered_map<std::uint32_t, std::uint32_t>> renumbered(bodies.size());
    for (std::size_t t = 0; t < small.triangles.size(); ++t) {
        const std::uint32_t object = small.objects[t].value;
        model::Triangle own{};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto [entry, added] = renumbered[object].try_emplace(
                small.triangles[t][c], static_cast<std::uint32_t>(bodies[object].points.size()));
            if (added) bodies[object].points.push_back(small.points[small.triangles[t][c]]);
            own[c] = entry->second;
        }
        bodies[object].triangles.push_back(own);
    }
    return bodies;
}

std::vector<Body> bodies_of(const model::Scene& scene) {
    std::vector<Body> bodies = empty_bodies(scene);
    for (std::size_t o = 0; o < bodies.size(); ++o) {
        bodies[o].points = scene.objects[o].mesh.points;
        bodies[o].triangles = scene.objects[o].mesh.triangles;
    }
    return bodies;
}

} // namespace kinelux::visibility
