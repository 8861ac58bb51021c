// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "geometry/surface.h"
#include "geometry/tessellation.h"
#include "visibility/occluders.h"

namespace kinelux::visibility {

namespace {

void add_triangle(Body& body, model::Triangle corners, const model::Surface& surface) {
    if (surface.orientation < 0.0) std::swap(corners[1], corners[2]);
    body.triangles.push_back(corners);
}

void add_outline(Body& body, const model::Patch& patch, std::uint32_t first_point,
                 std::uint32_t first_triangle) {
    Outline& outline = body.outlines.emplace_back();
    outline.first_triangle = first_triangle;
    outline.triangle_count = static_cast<std::uint32_t>(patch.triangles.size());
    outline.loops = patch.loops;
    for (std::vector<std::uint32_t>& loop : outline.loops) {
        for (std::uint32_t& point : loop) point += first_point;
        if (patch.surface.orientation < 0.0) std::reverse(loop.begin(), loop.end());
    }
}

void add_planar(Body& body, const model::Patch& patch) {
    const auto first = static_cast<std::uint32_t>(body.points.size());
    const auto first_triangle = static_cast<std::uint32_t>(body.triangles.size());
    for (const Vec2& uv : patch.points) body.points.push_back(geometry::position(patch.surface, uv));
    for (const model::Triangle& t : patch.triangles)
        add_triangle(body, {first + t[0], first + t[1], first + t[2]}, patch.surface);
    if (!patch.loops.empty()) add_outline(body, patch, first, first_triangle);
}

void add_curved(Body& body, const model::Patch& patch) {
    std::map<std::pair<double, double>, std::uint32_t> numbers; // equal corners are one point
    for (const model::DomainTriangle& triangle :
         geometry::tessellated(patch.surface, geometry::domain_of(patch))) {
        model::Triangle corners{};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto [entry, added] = numbers.try_emplace({triangle[c].x, triangle[c].y},
                                                            static_cast<std::uint32_t>(body.points.size()));
            if (added) body.points.push_back(geometry::position(patch.surface, triangle[c]));
            corners[c] = entry->second;
        }
        add_triangle(body, corners, patch.surface);
    }
}

void add_small(std::vector<Body>& bodies, const model::SmallTriangles& small) {
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
}

std::vector<Body> empty_bodies(const model::Scene& scene) {
    std::vector<Body> bodies(scene.objects.size());
    for (std::size_t o = 0; o < bodies.size(); ++o) bodies[o].moves = scene.objects[o].motion.has_value();
    return bodies;
}

} // namespace

std::vector<Body> bodies_of(const model::PatchSet& patches, const model::Scene& scene) {
    std::vector<Body> bodies = empty_bodies(scene);
    for (const model::Patch& patch : patches.patches) {
        Body& body = bodies[patch.object.value];
        if (patch.surface.type == model::SurfaceType::Plane)
            add_planar(body, patch);
        else
            add_curved(body, patch);
    }
    add_small(bodies, patches.small);
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
