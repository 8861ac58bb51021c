// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <unordered_map>
#include <utility>

#include "geometry/surface.h"
#include "visibility/occluders.h"

namespace kinelux::visibility {

namespace {

Vec3 point_of(const model::Surface& surface, const Vec2& uv) {
    if (surface.type == model::SurfaceType::Plane)
        return surface.origin + uv.x * surface.axis_u + uv.y * surface.axis_v;
    return geometry::evaluate(surface, uv).position;
}

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

void add_patch(Body& body, const model::Patch& patch) {
    const auto first = static_cast<std::uint32_t>(body.points.size());
    const auto first_triangle = static_cast<std::uint32_t>(body.triangles.size());
    for (const Vec2& uv : patch.points) body.points.push_back(point_of(patch.surface, uv));
    for (const model::Triangle& t : patch.triangles)
        add_triangle(body, {first + t[0], first + t[1], first + t[2]}, patch.surface);
    if (patch.surface.type == model::SurfaceType::Plane && !patch.loops.empty())
        add_outline(body, patch, first, first_triangle);
}

void add_element(Body& body, const model::Patch& patch, std::span<const model::DomainTriangle> triangles) {
    for (const model::DomainTriangle& triangle : triangles) {
        const auto first = static_cast<std::uint32_t>(body.points.size());
        for (const Vec2& uv : triangle) body.points.push_back(point_of(patch.surface, uv));
        add_triangle(body, {first, first + 1, first + 2}, patch.surface);
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
    for (const model::Patch& patch : patches.patches) add_patch(bodies[patch.object.value], patch);
    add_small(bodies, patches.small);
    return bodies;
}

std::vector<Body> bodies_of(const model::PatchSet& patches, const model::ClusterTree& tree,
                            const model::Scene& scene) {
    std::vector<Body> bodies = empty_bodies(scene);
    for (const model::Patch& patch : patches.patches)
        if (patch.surface.type == model::SurfaceType::Plane) add_patch(bodies[patch.object.value], patch);
    for (const model::Element& element : tree.elements) {
        if (!element.patch) continue;
        const model::Patch& patch = patches.patches[element.patch->value];
        if (patch.surface.type != model::SurfaceType::Plane)
            add_element(
                bodies[patch.object.value], patch,
                std::span(tree.domain_triangles).subspan(element.first_triangle, element.triangle_count));
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
