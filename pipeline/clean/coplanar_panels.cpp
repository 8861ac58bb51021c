// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/coplanar_panels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "geometry/pose.h"

namespace kinelux::clean {

namespace {

constexpr double coplanar_share = 1e-5; ///< of the extent: nearer than this is in the plane
constexpr double lift_share =
    5e-6; ///< of the extent; below the offset of shadow rays and the contact tolerance of fit
constexpr double same_way = 0.9999; ///< cosine between normals that face the same way

struct Box {
    Vec3 low{std::numeric_limits<double>::infinity()};
    Vec3 high{-std::numeric_limits<double>::infinity()};

    void add(const Vec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    bool meets(const Box& other, double margin) const {
        return glm::all(glm::lessThanEqual(low - margin, other.high)) &&
               glm::all(glm::lessThanEqual(other.low - margin, high));
    }
};

struct Face {
    std::array<Vec3, 3> corners;
    Vec3 normal;
    Box box;
};

std::vector<Face> faces_of(const model::Object& object, const geometry::Pose& pose) {
    std::vector<Face> faces;
    for (std::size_t t = 0; t < object.mesh.triangles.size(); ++t) {
        Face face;
        for (std::size_t c = 0; c < 3; ++c) {
            face.corners[c] = pose.point(object.mesh.points[object.mesh.triangles[t][c]]);
            face.box.add(face.corners[c]);
        }
        face.normal = pose.direction(model::triangle_normal(object.mesh, t));
        faces.push_back(face);
    }
    return faces;
}

Box bounds(const std::vector<Face>& faces) {
    Box box;
    for (const Face& face : faces) {
        box.add(face.box.low);
        box.add(face.box.high);
    }
    return box;
}

bool in_plane_of(const Face& panel, const Face& resting, double margin) {
    if (glm::dot(panel.normal, resting.normal) < same_way || !panel.box.meets(resting.box, margin))
        return false;
    return std::all_of(panel.corners.begin(), panel.corners.end(), [&](const Vec3& corner) {
        return std::abs(glm::dot(corner - resting.corners[0], resting.normal)) <= margin;
    });
}

bool emits(const model::Scene& scene, const model::Object& object) {
    return std::any_of(object.mesh.materials.begin(), object.mesh.materials.end(),
                       [&](MaterialId material) { return scene.materials[material.value].emits(); });
}

// The poses at which a body is looked at: where its path bends.
std::vector<geometry::Pose> poses_of(const model::Scene& scene, const model::Object& object) {
    if (!object.motion) return {geometry::Pose{}};
    std::vector<geometry::Pose> poses;
    for (const double time_s : geometry::key_times(scene, *object.motion))
        poses.push_back(geometry::pose_at(scene, *object.motion, time_s));
    return poses;
}

// The normal, in the body's rest position, of a face that some pose puts into the plane of a face of the surroundings.
std::optional<Vec3> coplanar_normal(const model::Object& panel, const std::vector<geometry::Pose>& poses,
                                    const std::vector<Face>& surroundings, double margin) {
    for (const geometry::Pose& pose : poses) {
        const std::vector<Face> faces = faces_of(panel, pose);
        const Box box = bounds(faces);
        for (const Face& other : surroundings) {
            if (!box.meets(other.box, margin)) continue;
            for (const Face& face : faces)
                if (in_plane_of(face, other, margin)) return glm::conjugate(pose.rotation) * face.normal;
        }
    }
    return std::nullopt;
}

} // namespace

void lift_coplanar_panels(model::Scene& scene, std::vector<CleanReport>& reports) {
    std::vector<Face> surroundings;
    std::vector<std::size_t> panels;
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        if (scene.objects[o].motion || emits(scene, scene.objects[o])) {
            panels.push_back(o);
            continue;
        }
        const std::vector<Face> faces = faces_of(scene.objects[o], {});
        surroundings.insert(surroundings.end(), faces.begin(), faces.end());
    }
    if (surroundings.empty()) return;
    const Box all = bounds(surroundings);
    const Vec3 size = all.high - all.low;
    const double extent = std::max({size.x, size.y, size.z});
    for (const std::size_t o : panels) {
        model::Object& object = scene.objects[o];
        const auto normal =
            coplanar_normal(object, poses_of(scene, object), surroundings, coplanar_share * extent);
        if (!normal) continue;
        const double lift = lift_share * extent;
        for (Vec3& point : object.mesh.points) point += lift * *normal;
        reports[o].notes.push_back(fmt::format(
            "lies in the plane of a surface that faces the same way: lifted to its front by {:.3g} m", lift));
    }
}

} // namespace kinelux::clean
