// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/occluders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>
#include <utility>

#include <embree3/rtcore.h>

#include "core/error.h"
#include "visibility/polygon_blockers.h"

// Embree computes in float. All it sees is in unit coordinates, (x - centre) / extent, where the rounding of a float is
// about 6e-8 wherever the scene lies and however large it is; end_offset is 300 times that.

namespace kinelux::visibility {

namespace {

constexpr double relative_end_offset = 2e-5; ///< of the scene's extent
constexpr std::size_t rays_at_once = 256;    ///< of a batch: 16 kB of rays stay in the first-level cache

struct Float3 {
    float x, y, z;
};

Float3 to_float(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// Owns an Embree scene.
struct SceneDeleter {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct DeviceDeleter {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
using ScenePointer = std::unique_ptr<RTCSceneTy, SceneDeleter>;
using DevicePointer = std::unique_ptr<RTCDeviceTy, DeviceDeleter>;

struct Box {
    Vec3 low{std::numeric_limits<double>::infinity()};
    Vec3 high{-std::numeric_limits<double>::infinity()};
    void add(const Vec3& x) {
        low = glm::min(low, x);
        high = glm::max(high, x);
    }
    bool empty() const { return !(low.x <= high.x); }
    Vec3 centre() const { return 0.5 * (low + high); }
};

Box bounds_of(const Body& body) {
    Box box;
    for (const model::Triangle& triangle : body.triangles)
        for (const std::uint32_t corner : triangle) box.add(body.points[corner]);
    return box;
}

void require_valid(const Body& body, std::size_t index) {
    for (const model::Triangle& triangle : body.triangles)
        for (const std::uint32_t corner : triangle)
            if (corner >= body.points.size())
                throw core::GeometryError("body " + std::to_string(index) + " has a triangle with corner " +
                                          std::to_string(corner) + " but only " +
                                          std::to_string(body.points.size()) +
                                          " points; run kinelux-clean first");
            else if (!std::isfinite(glm::dot(body.points[corner], Vec3(1.0))))
                throw core::GeometryError("body " + std::to_string(index) +
                                          " has a coordinate that is not finite; run kinelux-clean first");
}

RTCRay ray_of(const Float3& origin, const Float3& direction, float far) {
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.tnear = 0.0f;
    ray.tfar = far;
    ray.mask = 0xffffffffu; // masks are compiled into Debian's Embree: 0 would see nothing
    return ray;
}

} // namespace

struct Occluders::Impl {
    std::vector<Body> bodies;
    std::vector<geometry::Pose> poses;
    DevicePointer device;
    ScenePointer resting; ///< null: no resting triangle
    ScenePointer moving;  ///< instances of body_scenes; null: no moving triangle
    std::vector<ScenePointer>
        body_scenes; ///< one per moving body with triangles, in coordinates about its centre
    std::vector<std::uint32_t> resting_bodies, moving_bodies; ///< geometry number -> body
    std::vector<Vec3> body_centres;                           ///< of moving_bodies, at rest
    Vec3 centre{0.0};
    double extent = 1.0;
    std::once_flag polygons_made;
    std::optional<PolygonBlockers> polygons;

    Vec3 unit(const Vec3& x) const { return (x - centre) / extent; }
    ScenePointer new_scene() const {
        ScenePointer scene(rtcNewScene(device.get()));
        rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
        return scene;
    }

    void measure();
    void attach_triangles(RTCScene scene, const Body& body, const Vec3& origin) const;
    void build_resting();
    void build_moving();
    void place_moving();
    std::optional<RTCRay> ray_between(const Vec3& from, const Vec3& to) const;
    bool any(Among among) const;
    Hit hit_of(const RTCRayHit& ray, std::uint32_t body) const;
};

void Occluders::Impl::measure() {
    Box box;
    for (const Body& body : bodies) {
        const Box own = bounds_of(body);
        if (own.empty()) continue;
        box.add(own.low);
        box.add(own.high);
    }
    if (box.empty()) return;
    centre = box.centre();
    const double size = glm::length(box.high - box.low);
    if (size > 0.0) extent = size;
}

void Occluders::Impl::attach_triangles(RTCScene scene, const Body& body, const Vec3& origin) const {
    RTCGeometry triangles = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<Float3*>(rtcSetNewGeometryBuffer(
        triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Float3), body.points.size()));
    auto* corners = static_cast<model::Triangle*>(
        rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(model::Triangle), body.triangles.size()));
    if (points == nullptr || corners == nullptr) {
        rtcReleaseGeometry(triangles);
        throw core::ResourceError("no memory for the triangles that cast shadows");
    }
    for (std::size_t i = 0; i < body.points.size(); ++i)
        points[i] = to_float((body.points[i] - origin) / extent);
    std::copy(body.triangles.begin(), body.triangles.end(), corners);
    rtcSetGeometryMask(triangles, 0xffffffffu);
    rtcCommitGeometry(triangles);
    rtcAttachGeometry(scene, triangles);
    rtcReleaseGeometry(triangles);
}

void Occluders::Impl::build_resting() {
    for (std::size_t b = 0; b < bodies.size(); ++b)
        if (!bodies[b].moves && !bodies[b].triangles.empty())
            resting_bodies.push_back(static_cast<std::uint32_t>(b));
    if (resting_bodies.empty()) return;
    resting = new_scene();
    for (const std::uint32_t b : resting_bodies) attach_triangles(resting.get(), bodies[b], centre);
    rtcCommitScene(resting.get());
}

void Occluders::Impl::build_moving() {
    for (std::size_t b = 0; b < bodies.size(); ++b)
        if (bodies[b].moves && !bodies[b].triangles.empty())
            moving_bodies.push_back(static_cast<std::uint32_t>(b));
    if (moving_bodies.empty()) return;
    moving = new_scene();
    for (const std::uint32_t b : moving_bodies) {
        body_centres.push_back(bounds_of(bodies[b]).centre());
        body_scenes.push_back(new_scene());
        attach_triangles(body_scenes.back().get(), bodies[b], body_centres.back());
        rtcCommitScene(body_scenes.back().get());
        RTCGeometry instance = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(instance, body_scenes.back().get());
        rtcSetGeometryMask(instance, 0xffffffffu);
        rtcCommitGeometry(instance);
        rtcAttachGeometry(moving.get(), instance);
        rtcReleaseGeometry(instance);
    }
    place_moving();
}

void Occluders::Impl::place_moving() {
    for (std::size_t m = 0; m < moving_bodies.size(); ++m) {
        const geometry::Pose& pose = poses[moving_bodies[m]];
        const Vec3 translation = unit(pose.point(body_centres[m]));
        std::array<float, 12> transform{}; // column-major 3 x 4
        for (int column = 0; column < 3; ++column) {
            Vec3 axis(0.0);
            axis[column] = 1.0;
            const Vec3 image = pose.direction(axis);
            for (int row = 0; row < 3; ++row)
                transform[3 * static_cast<std::size_t>(column) + static_cast<std::size_t>(row)] =
                    static_cast<float>(image[row]);
        }
        for (int row = 0; row < 3; ++row)
            transform[9 + static_cast<std::size_t>(row)] = static_cast<float>(translation[row]);
        RTCGeometry instance = rtcGetGeometry(moving.get(), static_cast<unsigned>(m));
        rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
        rtcCommitGeometry(instance);
    }
    rtcCommitScene(moving.get());
}

bool Occluders::Impl::any(Among among) const {
    return (among != Among::Moving && resting) || (among != Among::Resting && moving);
}

// Nothing for a segment too short to hold anything between its pulled-in ends.
std::optional<RTCRay> Occluders::Impl::ray_between(const Vec3& from, const Vec3& to) const {
    const Vec3 whole = (to - from) / extent;
    const double length = glm::length(whole);
    if (!(length > 2.0 * relative_end_offset)) return std::nullopt;
    const double cut = relative_end_offset / length;
    return ray_of(to_float(unit(from) + cut * whole), to_float((1.0 - 2.0 * cut) * whole), 1.0f);
}

Hit Occluders::Impl::hit_of(const RTCRayHit& ray, std::uint32_t body) const {
    const model::Triangle& triangle = bodies[body].triangles[ray.hit.primID];
    const std::vector<Vec3>& points = bodies[body].points;
    const Vec3 p0 = points[triangle[0]], e1 = points[triangle[1]] - p0, e2 = points[triangle[2]] - p0;
    Hit hit;
    hit.body = body;
    hit.triangle = ray.hit.primID;
    hit.position = p0 + static_cast<double>(ray.hit.u) * e1 + static_cast<double>(ray.hit.v) * e2;
    const Vec3 cross = glm::cross(e1, e2);
    const double length = glm::length(cross);
    hit.normal = length > 0.0 ? cross / length : Vec3(0.0);
    if (bodies[body].moves) {
        hit.position = poses[body].point(hit.position);
        hit.normal = poses[body].direction(hit.normal);
    }
    return hit;
}

Occluders::Occluders(std::vector<Body> bodies) : impl_(std::make_unique<Impl>()) {
    for (std::size_t b = 0; b < bodies.size(); ++b) require_valid(bodies[b], b);
    impl_->bodies = std::move(bodies);
    impl_->poses.resize(impl_->bodies.size());
    impl_->measure();
    impl_->device.reset(rtcNewDevice(nullptr));
    if (!impl_->device)
        throw core::ResourceError("Embree did not start: error " +
                                  std::to_string(static_cast<int>(rtcGetDeviceError(nullptr))));
    impl_->build_resting();
    impl_->build_moving();
    if (rtcGetDeviceError(impl_->device.get()) != RTC_ERROR_NONE)
        throw core::ResourceError(
            "Embree could not build its tree over the triangles; most likely too little memory");
}

// The scenes go before the device: members are destroyed in reverse order of declaration.
Occluders::~Occluders() = default;
Occluders::Occluders(Occluders&&) noexcept = default;
Occluders& Occluders::operator=(Occluders&&) noexcept = default;

void Occluders::set_poses(std::span<const geometry::Pose> poses) {
    if (poses.size() != impl_->bodies.size())
        throw core::GeometryError(std::to_string(poses.size()) + " poses were given for " +
                                  std::to_string(impl_->bodies.size()) + " bodies");
    for (const std::uint32_t b : impl_->moving_bodies) impl_->poses[b] = poses[b];
    if (impl_->moving) impl_->place_moving();
    if (impl_->polygons) impl_->polygons->set_poses(impl_->poses);
}

const PolygonBlockers& Occluders::polygons() const {
    std::call_once(impl_->polygons_made, [this] {
        impl_->polygons.emplace(impl_->bodies);
        impl_->polygons->set_poses(impl_->poses);
    });
    return *impl_->polygons;
}

bool Occluders::occluded(const Vec3& from, const Vec3& to, Among among) const {
    if (!impl_->any(among)) return false;
    std::optional<RTCRay> ray = impl_->ray_between(from, to);
    if (!ray) return false;
    for (const auto& [scene, asked] : {std::pair(impl_->resting.get(), among != Among::Moving),
                                       std::pair(impl_->moving.get(), among != Among::Resting)}) {
        if (scene == nullptr || !asked) continue;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(scene, &context, &*ray);
        if (ray->tfar < 0.0f) return true;
    }
    return false;
}

void Occluders::occluded(std::span<const Segment> segments, std::span<std::uint8_t> blocked,
                         Among among) const {
    std::fill(blocked.begin(), blocked.end(), std::uint8_t{0});
    if (!impl_->any(among)) return;
    std::array<RTCRay, rays_at_once> rays;
    std::array<std::size_t, rays_at_once> owners;
    for (std::size_t next = 0; next < segments.size();) {
        unsigned count = 0;
        for (; next < segments.size() && count < rays_at_once; ++next)
            if (const auto ray = impl_->ray_between(segments[next].from, segments[next].to)) {
                rays[count] = *ray;
                owners[count++] = next;
            }
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        if (impl_->resting && among != Among::Moving)
            rtcOccluded1M(impl_->resting.get(), &context, rays.data(), count, sizeof(RTCRay));
        if (impl_->moving && among != Among::Resting) {
            // Rays blocked already leave first. Embree 3.13's coherent streams never return from some scenes of
            // instances, so these rays go as they come.
            context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
            for (unsigned i = 0; i < count;)
                if (rays[i].tfar < 0.0f) {
                    blocked[owners[i]] = 1;
                    rays[i] = rays[--count];
                    owners[i] = owners[count];
                } else {
                    ++i;
                }
            rtcOccluded1M(impl_->moving.get(), &context, rays.data(), count, sizeof(RTCRay));
        }
        for (unsigned i = 0; i < count; ++i) blocked[owners[i]] = rays[i].tfar < 0.0f ? 1 : 0;
    }
}

std::optional<Hit> Occluders::first_hit(const Vec3& origin, const Vec3& direction) const {
    const double length = glm::length(direction);
    if (!impl_->any(Among::All) || !(length > 0.0)) return std::nullopt;
    const Vec3 unit_direction = direction / length;
    RTCRayHit ray{};
    ray.ray = ray_of(to_float(impl_->unit(origin) + relative_end_offset * unit_direction),
                     to_float(unit_direction), std::numeric_limits<float>::infinity());
    std::optional<std::uint32_t> body;
    for (RTCScene scene : {impl_->resting.get(), impl_->moving.get()}) {
        if (scene == nullptr) continue;
        RTCHit before = ray.hit;
        ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene, &context, &ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID)
            ray.hit = before;
        else
            body = scene == impl_->resting.get() ? impl_->resting_bodies[ray.hit.geomID]
                                                 : impl_->moving_bodies[ray.hit.instID[0]];
    }
    if (!body) return std::nullopt;
    Hit hit = impl_->hit_of(ray, *body);
    hit.distance = glm::dot(hit.position - origin, unit_direction) / length;
    return hit;
}

double Occluders::end_offset() const { return relative_end_offset * impl_->extent; }

bool Occluders::empty() const { return !impl_->resting && !impl_->moving; }

bool Occluders::any_moving() const { return impl_->moving != nullptr; }

} // namespace kinelux::visibility
