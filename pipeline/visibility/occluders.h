// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/vec.h"
#include "geometry/pose.h"
#include "model/mesh.h"
#include "model/patch_set.h"
#include "model/scene.h"

namespace kinelux::visibility {

class PolygonBlockers;

/// A planar polygon of a body, given by its boundary beside its triangles.
struct Outline {
    std::vector<std::vector<std::uint32_t>>
        loops;                        ///< into Body::points, around the same area as the triangles:
                                      ///< outer counter-clockwise from the front, holes clockwise
    std::uint32_t first_triangle = 0; ///< into Body::triangles
    std::uint32_t triangle_count = 0;
};

/// A rigid body's triangles at rest.
struct Body {
    std::vector<Vec3> points; ///< [m]
    std::vector<model::Triangle> triangles;
    std::vector<Outline> outlines; ///< of some of the triangles, in their order; rays do not need them
    bool moves = false;
};

struct Segment {
    Vec3 from, to;
};

/// Which bodies a query looks at.
enum class Among : std::uint8_t { All, Resting, Moving };

struct Hit {
    std::uint32_t body = 0;
    std::uint32_t triangle = 0; ///< of that body
    double distance = 0.0;      ///< in units of the direction's length
    Vec3 position{0.0};
    Vec3 normal{0.0}; ///< unit, geometric, to the triangle's front
};

/// Ray queries against all bodies of a scene. Both sides of a triangle block. Segment ends that lie on surfaces are
/// pulled in by end_offset(), so that the surfaces they lie on (and surfaces coplanar with them) do not block; a
/// segment shorter than twice that is free.
class Occluders {
public:
    explicit Occluders(std::vector<Body> bodies);
    ~Occluders();
    Occluders(Occluders&&) noexcept;
    Occluders& operator=(Occluders&&) noexcept;

    /// Moves the bodies. @param poses  one per body; those of resting bodies are ignored. Not while queries run.
    void set_poses(std::span<const geometry::Pose> poses);

    bool occluded(const Vec3& from, const Vec3& to, Among among = Among::All) const;
    /// Many segments at once, fastest when they are coherent. @param blocked  1 or 0 per segment
    void occluded(std::span<const Segment> segments, std::span<std::uint8_t> blocked,
                  Among among = Among::All) const;
    /// The first triangle along a ray that starts end_offset() ahead of `origin`.
    std::optional<Hit> first_hit(const Vec3& origin, const Vec3& direction) const;

    /// The same bodies at the same poses as planar polygons; made when first asked for.
    const PolygonBlockers& polygons() const;

    double end_offset() const; ///< [m], 2e-5 of the size of the scene
    bool empty() const;        ///< no triangles at all
    bool any_moving() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The occluding triangles of the fitted scene, one body per object of the scene, in order, with the outlines of planar
/// patches. Curved patches are tessellated; rays from their hollow side start at SurfaceNode::sight_point().
std::vector<Body> bodies_of(const model::PatchSet& patches, const model::Scene& scene);
/// The same of the scene's own meshes, unfitted.
std::vector<Body> bodies_of(const model::Scene& scene);

} // namespace kinelux::visibility
