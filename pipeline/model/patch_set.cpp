// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/patch_set.h"

#include <cmath>
#include <cstddef>
#include <string>

#include "core/error.h"

namespace kinelux::model {

namespace {

[[noreturn]] void fail(const std::string& where, const std::string& what) {
    throw core::GeometryError(where + ": " + what);
}

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool finite(const Vec2& v) { return std::isfinite(v.x) && std::isfinite(v.y); }

void check_ids(const std::string& where, ObjectId object, MaterialId material, const Scene& scene) {
    if (object.value >= scene.objects.size())
        fail(where,
             "names object " + std::to_string(object.value) + " of " + std::to_string(scene.objects.size()));
    if (material.value >= scene.materials.size())
        fail(where, "names material " + std::to_string(material.value) + " of " +
                        std::to_string(scene.materials.size()));
}

void check_patch(const std::string& where, const Patch& patch, const Scene& scene) {
    check_ids(where, patch.object, patch.material, scene);
    check(patch.surface, where);
    if (patch.triangles.empty()) fail(where, "has no triangles");
    for (const Vec2& p : patch.points) {
        if (!finite(p)) fail(where, "a parameter of its domain is not finite");
    }
    double twice_area = 0.0;
    for (const Triangle& t : patch.triangles) {
        for (const std::uint32_t corner : t) {
            if (corner >= patch.points.size())
                fail(where, "a triangle of its domain names point " + std::to_string(corner) + " of " +
                                std::to_string(patch.points.size()));
        }
        const Vec2 ab = patch.points[t[1]] - patch.points[t[0]], ac = patch.points[t[2]] - patch.points[t[0]];
        twice_area += ab.x * ac.y - ab.y * ac.x;
    }
    if (!(twice_area > 0.0)) fail(where, "its domain has no area or is clockwise");
    for (const std::vector<std::uint32_t>& loop : patch.loops) {
        if (loop.size() < 3) fail(where, "a loop of its boundary has fewer than three points");
        for (const std::uint32_t corner : loop) {
            if (corner >= patch.points.size())
                fail(where, "a loop of its boundary names a point out of range");
        }
    }
}

void check_small(const SmallTriangles& small, const Scene& scene) {
    const std::string where = "small triangles";
    if (small.objects.size() != small.triangles.size() || small.materials.size() != small.triangles.size()) {
        fail(where, "there is not one object and one material per triangle");
    }
    for (const Vec3& p : small.points) {
        if (!finite(p)) fail(where, "a coordinate is not finite");
    }
    for (std::size_t i = 0; i < small.triangles.size(); ++i) {
        const std::string name = "small triangle " + std::to_string(i);
        check_ids(name, small.objects[i], small.materials[i], scene);
        for (const std::uint32_t corner : small.triangles[i]) {
            if (corner >= small.points.size()) fail(name, "names a point out of range");
        }
    }
}

} // namespace

void check(const PatchSet& patches, const Scene& scene) {
    for (std::size_t i = 0; i < patches.patches.size(); ++i) {
        check_patch("patch " + std::to_string(i), patches.patches[i], scene);
    }
    check_small(patches.small, scene);
}

} // namespace kinelux::model
