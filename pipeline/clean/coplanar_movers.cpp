// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/coplanar_movers.h"

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
constexpr double lift_share = 1e-5;     ///< of the extent; below the offset at which shadow rays start
constexpr double same_way = 0.9999;     ///< cosine between normals that face the same way

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

bool in_plane_of(const Face& mover, const Face& resting, double margin) {
    if (glm::dot(mover.normal, resting.normal) < same_way || !mover.box.meets(resting.box, margin)) return false;
    return std::all_of(mover.corners.begin(), mover.corners.end(), [&](const Vec3& corner) {
        return std::abs(glm::dot(corner - resting.corners[0], resting.normal)) <= margin;
    });
}

// The normal, in the mover's rest position, of a face that some keyframe puts into the plane of a resting face.
std::optional<Vec3> coplanar_normal(const model::Object& mover, const model::Motion& motion,
                                    const std::vector<std::vector<Face>>& resting, double margin) {
    for (const model::Keyframe& key : motion.keyframes) {
        const geometry::Pose pose = geometry::pose_at(motion, key.time_s);
        const std::vector<Face> faces = faces_of(mover, pose);
        const Box box = bounds(faces);
        for (const std::vector<Face>& others : resting)
            for (const Face& other : others) {
                if (!box.meets(other.box, margin)) continue;
                for (const Face& face : faces)
                    if (in_plane_of(face, other, margin)) return glm::conjugate(pose.rotation) * face.normal;
            }
    }
    return std::nullopt;
}

} // namespace

void lift_coplanar_movers(model::Scene& scene, std::vector<CleanReport>& reports) {
    std::vector<std::vector<Face>> resting;
    Box all;
    for (const model::Object& object : scene.objects) {
        if (object.motion) continue;
        resting.push_back(faces_of(object, {}));
        const Box box = bounds(resting.back());
        all.add(box.low);
        all.add(box.high);
    }
    if (resting.empty()) return;
    const Vec3 size = all.high - all.low;
    const double extent = std::max({size.x, size.y, size.z});
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        model::Object& object = scene.objects[o];
        if (!object.motion) continue;
        const auto normal =
            coplanar_normal(object, scene.motions[object.motion->value], resting, coplanar_share * extent);
        if (!normal) continue;
        const double lift = lift_share * extent;
        for (Vec3& point : object.mesh.points) point += lift * *normal;
        reports[o].notes.push_back(
            fmt::format("moves within the plane of a resting surface: lifted to its front by {:.3g} m", lift));
    }
}

} // namespace kinelux::clean
