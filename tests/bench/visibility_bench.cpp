// SPDX-License-Identifier: GPL-3.0-or-later
// Shadow rays, searches for blockers and exact visible parts per second, one thread. A furnished room is made by code;
// case folders named behind the benchmark's own options are measured too:
//   visibility_bench [--benchmark_filter=...] out/cornell.case out/cathedral.case
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include "core/error.h"
#include "core/sequence.h"
#include "io/case_folder.h"
#include "support/shapes.h"
#include "visibility/pair_blockers.h"

namespace kinelux {
namespace {

constexpr std::size_t pairs_measured = 4096;
constexpr std::size_t few = 8; // blockers that are worth an exact integral

/// Elements of a scene, what may stand between them, and pairs that face each other.
struct World {
    std::vector<geometry::ElementShape> elements;
    std::vector<visibility::Body> bodies;
    visibility::Occluders occluders;
    std::vector<visibility::ShaftEnd> ends;
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    std::vector<visibility::Segment> segments; ///< between centres of the pairs' facets
};

Vec3 centre_of(const geometry::Facet& facet) {
    return (facet.corners[0] + facet.corners[1] + facet.corners[2]) / 3.0;
}

World world_of(std::vector<geometry::ElementShape> elements, const std::vector<visibility::Body>& bodies) {
    World world{std::move(elements), bodies, visibility::Occluders(bodies), {}, {}, {}};
    for (const geometry::ElementShape& element : world.elements)
        world.ends.push_back(visibility::shaft_end(element));
    core::Random random(1);
    const auto count = static_cast<double>(world.elements.size());
    for (int tries = 0; tries < 1000000 && world.pairs.size() < pairs_measured; ++tries) {
        const auto i = static_cast<std::size_t>(random.next() * count);
        const auto j = static_cast<std::size_t>(random.next() * count);
        const geometry::Facet &a = world.elements[i].facets[0], &b = world.elements[j].facets[0];
        const Vec3 way = centre_of(b) - centre_of(a);
        if (!(glm::dot(a.normal, way) > 0.0) || !(glm::dot(b.normal, way) < 0.0)) continue;
        world.pairs.emplace_back(i, j);
        world.segments.push_back({centre_of(a), centre_of(b)});
    }
    return world;
}

World furnished_room() {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(6, 8, 3), support::Facing::Inwards);
    for (int i = 0; i < 12; ++i) {
        const int row = i / 3;
        const Vec3 low(0.4 + 1.8 * (i % 3), 0.5 + 1.9 * row, 0.0);
        for (const auto& patch :
             support::box(low, low + Vec3(0.8, 1.1, 0.7 + 0.1 * (i % 5)), support::Facing::Outwards))
            set.patches.push_back(patch);
    }
    return world_of(support::shapes_of(set, 4, 1), visibility::bodies_of(set, support::plain_scene(1)));
}

World case_world(const std::filesystem::path& folder) {
    const io::CaseFolder files(folder);
    const model::PatchSet patches = files.read_patches();
    return world_of(geometry::element_shapes(patches, files.read_clusters(), 1, 0),
                    visibility::bodies_of(patches, files.read_scene()));
}

void single_rays(benchmark::State& state, const World& world) {
    std::size_t k = 0, blocked = 0;
    for (auto _ : state) {
        const visibility::Segment& s = world.segments[k++ % world.segments.size()];
        blocked += world.occluders.occluded(s.from, s.to) ? 1 : 0;
    }
    state.SetItemsProcessed(state.iterations());
    state.counters["blocked"] = static_cast<double>(blocked) / static_cast<double>(state.iterations());
}

constexpr std::size_t rays_per_batch = 256;

// What the kernel asks: rays between nodes of two elements, many at a time.
std::vector<std::vector<visibility::Segment>> batches_of(const World& world) {
    std::vector<std::vector<visibility::Segment>> batches(256);
    for (std::size_t batch = 0; batch < batches.size(); ++batch) {
        const auto& [i, j] = world.pairs[batch % world.pairs.size()];
        core::Random random(batch);
        const auto point_of = [&](const geometry::Facet& facet) {
            const double s = std::sqrt(random.next()), t = random.next();
            return (1.0 - s) * facet.corners[0] + s * ((1.0 - t) * facet.corners[1] + t * facet.corners[2]);
        };
        for (std::size_t ray = 0; ray < rays_per_batch; ++ray)
            batches[batch].push_back(
                {point_of(world.elements[i].facets[0]), point_of(world.elements[j].facets[0])});
    }
    return batches;
}

void batches_of_rays(benchmark::State& state, const World& world) {
    const auto batches = batches_of(world);
    std::vector<std::uint8_t> blocked(rays_per_batch);
    std::size_t k = 0;
    for (auto _ : state) {
        world.occluders.occluded(batches[k++ % batches.size()], blocked);
        benchmark::DoNotOptimize(blocked.data());
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(rays_per_batch) * state.iterations());
}

/// The resting triangles in a bare Embree scene with the same flags, and the rays ready: the most that can be reached.
class BareEmbree {
public:
    explicit BareEmbree(const World& world) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
        for (const visibility::Body& body : world.bodies)
            if (!body.triangles.empty()) attach(body);
        rtcCommitScene(scene_);
        for (const visibility::Segment& s : world.segments) rays_.push_back(ray_of(s));
        for (const auto& batch : batches_of(world))
            for (const visibility::Segment& s : batch) batched_rays_.push_back(ray_of(s));
    }
    BareEmbree(const BareEmbree&) = delete;
    BareEmbree& operator=(const BareEmbree&) = delete;
    ~BareEmbree() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    void run_batches(benchmark::State& state) const {
        std::size_t k = 0;
        std::array<RTCRay, rays_per_batch> rays;
        for (auto _ : state) {
            std::copy_n(batched_rays_.begin() + static_cast<std::ptrdiff_t>(k), rays_per_batch, rays.begin());
            k = (k + rays_per_batch) % batched_rays_.size();
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
            rtcOccluded1M(scene_, &context, rays.data(), rays_per_batch, sizeof(RTCRay));
            benchmark::DoNotOptimize(rays.data());
        }
        state.SetItemsProcessed(static_cast<std::int64_t>(rays_per_batch) * state.iterations());
    }
    // The same rays through both in turn: how much of Embree's own speed is left, one by one and in batches.
    void compare(benchmark::State& state, const World& world) const {
        std::array<std::clock_t, 4> spent{};
        const auto timed = [&spent](std::size_t which, const auto& work) {
            const std::clock_t start = std::clock();
            work();
            spent[which] += std::clock() - start;
        };
        const auto batches = batches_of(world);
        std::vector<std::uint8_t> blocked(rays_per_batch);
        RTCIntersectContext context;
        for (auto _ : state) {
            timed(0, [&] {
                for (const visibility::Segment& s : world.segments)
                    benchmark::DoNotOptimize(world.occluders.occluded(s.from, s.to));
            });
            timed(1, [&] {
                for (RTCRay ray : rays_) {
                    rtcInitIntersectContext(&context);
                    rtcOccluded1(scene_, &context, &ray);
                    benchmark::DoNotOptimize(ray.tfar);
                }
            });
            timed(2, [&] {
                for (const auto& batch : batches) world.occluders.occluded(batch, blocked);
            });
            timed(3, [&] {
                std::vector<RTCRay> rays = batched_rays_;
                for (std::size_t k = 0; k < rays.size(); k += rays_per_batch) {
                    rtcInitIntersectContext(&context);
                    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
                    rtcOccluded1M(scene_, &context, &rays[k], rays_per_batch, sizeof(RTCRay));
                }
            });
        }
        const auto ratio = [&spent](std::size_t ours, std::size_t bare) {
            return static_cast<double>(spent[bare]) /
                   static_cast<double>(std::max<std::clock_t>(spent[ours], 1));
        };
        state.counters["one_by_one"] = ratio(0, 1);
        state.counters["batches"] = ratio(2, 3);
    }
    void run(benchmark::State& state) const {
        std::size_t k = 0;
        for (auto _ : state) {
            RTCRay ray = rays_[k++ % rays_.size()];
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            rtcOccluded1(scene_, &context, &ray);
            benchmark::DoNotOptimize(ray.tfar);
        }
        state.SetItemsProcessed(state.iterations());
    }

private:
    static RTCRay ray_of(const visibility::Segment& s) {
        const Vec3 from = s.from + 1e-4 * (s.to - s.from), way = 0.9998 * (s.to - s.from);
        RTCRay ray{};
        ray.org_x = static_cast<float>(from.x), ray.org_y = static_cast<float>(from.y);
        ray.org_z = static_cast<float>(from.z);
        ray.dir_x = static_cast<float>(way.x), ray.dir_y = static_cast<float>(way.y);
        ray.dir_z = static_cast<float>(way.z);
        ray.tfar = 1.0f;
        ray.mask = 0xffffffffu;
        return ray;
    }
    void attach(const visibility::Body& body) {
        RTCGeometry triangles = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
            triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), body.points.size()));
        auto* corners = static_cast<model::Triangle*>(
            rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    sizeof(model::Triangle), body.triangles.size()));
        for (std::size_t i = 0; i < body.points.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                points[3 * i + static_cast<std::size_t>(axis)] = static_cast<float>(body.points[i][axis]);
        std::copy(body.triangles.begin(), body.triangles.end(), corners);
        rtcSetGeometryMask(triangles, 0xffffffffu);
        rtcCommitGeometry(triangles);
        rtcAttachGeometry(scene_, triangles);
        rtcReleaseGeometry(triangles);
    }

    RTCDevice device_;
    RTCScene scene_;
    std::vector<RTCRay> rays_, batched_rays_;
};

void shafts(benchmark::State& state, const World& world) {
    std::size_t k = 0;
    for (auto _ : state) {
        const auto& [i, j] = world.pairs[k++ % world.pairs.size()];
        const visibility::Shaft shaft(world.ends[i], world.ends[j]);
        benchmark::DoNotOptimize(shaft.half_spaces().data());
    }
    state.SetItemsProcessed(state.iterations());
}

void box_tests(benchmark::State& state, const World& world) {
    const auto& [i, j] = world.pairs[0];
    const visibility::Shaft shaft(world.ends[i], world.ends[j]);
    std::size_t k = 0;
    for (auto _ : state) {
        const visibility::ShaftEnd& end = world.ends[k++ % world.ends.size()];
        benchmark::DoNotOptimize(shaft.misses(end.box_low, end.box_high));
    }
    state.SetItemsProcessed(state.iterations());
}

void candidates(benchmark::State& state, const World& world) {
    std::vector<std::uint32_t> found;
    std::size_t k = 0, sum = 0;
    for (auto _ : state) {
        const auto& [i, j] = world.pairs[k++ % world.pairs.size()];
        world.occluders.polygons().find(visibility::Shaft(world.ends[i], world.ends[j]),
                                        visibility::Among::All, few, found);
        sum += found.size();
    }
    state.SetItemsProcessed(state.iterations());
    state.counters["found"] = static_cast<double>(sum) / static_cast<double>(state.iterations());
}

void sights(benchmark::State& state, const World& world) {
    visibility::PairBlockers pair;
    std::array<std::size_t, 4> seen{};
    std::size_t k = 0;
    for (auto _ : state) {
        const auto& [i, j] = world.pairs[k++ % world.pairs.size()];
        ++seen[static_cast<std::size_t>(pair.between(world.ends[i], world.ends[j], world.occluders.polygons(),
                                                     visibility::Among::All, few))];
    }
    state.SetItemsProcessed(state.iterations());
    const auto share = [&](visibility::Sight sight) {
        return static_cast<double>(seen[static_cast<std::size_t>(sight)]) /
               static_cast<double>(state.iterations());
    };
    state.counters["clear"] = share(visibility::Sight::Clear);
    state.counters["hidden"] = share(visibility::Sight::Hidden);
    state.counters["few"] = share(visibility::Sight::Few);
    state.counters["many"] = share(visibility::Sight::Many);
}

// Squares that hide parts of a square, with some overlap.
void visible_part(benchmark::State& state) {
    const auto square = [](double half, const Vec3& centre) {
        visibility::Loops3 loops;
        for (const Vec2& p : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)})
            loops.points.push_back(centre + Vec3(half * p, 0.0));
        loops.ends = {4};
        return loops;
    };
    std::vector<visibility::PlanarBlocker> blockers(static_cast<std::size_t>(state.range(0)));
    core::Random random(4);
    for (visibility::PlanarBlocker& blocker : blockers) {
        blocker.loops = square(0.15, {random.next() - 0.5, random.next() - 0.5, 0.5 + random.next()});
        blocker.plane = {{0.0, 0.0, 1.0}, blocker.loops.points[0].z};
    }
    const visibility::Loops3 target = square(1.0, Vec3(0.0));
    visibility::VisiblePolygon visible;
    std::size_t sides = 0;
    for (auto _ : state) {
        const Vec3 x(0.5 * random.next(), 0.5 * random.next(), 2.0);
        sides += visible.from(x, target, {0.0, 0.0, 1.0}, blockers).points.size();
    }
    state.SetItemsProcessed(state.iterations());
    state.counters["sides"] = static_cast<double>(sides) / static_cast<double>(state.iterations());
}
BENCHMARK(visible_part)->Arg(1)->Arg(2)->Arg(5)->Arg(10);

void register_world(const std::string& name, World&& made) {
    static std::deque<std::pair<World, std::unique_ptr<BareEmbree>>> worlds; // live as long as the benchmarks
    auto& [world, embree] = worlds.emplace_back(std::move(made), nullptr);
    embree = std::make_unique<BareEmbree>(world);
    const BareEmbree& bare = *embree;
    const auto add = [&name, &world = world](const char* what,
                                             void (*function)(benchmark::State&, const World&)) {
        benchmark::RegisterBenchmark((name + "/" + what).c_str(),
                                     [function, &world](benchmark::State& state) { function(state, world); });
    };
    add("single_rays", single_rays);
    benchmark::RegisterBenchmark((name + "/single_rays_bare_embree").c_str(),
                                 [&bare](benchmark::State& state) { bare.run(state); });
    add("batches_of_rays", batches_of_rays);
    benchmark::RegisterBenchmark((name + "/batches_of_rays_bare_embree").c_str(),
                                 [&bare](benchmark::State& state) { bare.run_batches(state); });
    benchmark::RegisterBenchmark((name + "/share_of_bare_embree").c_str(), [&bare, &world = world](
                                                                               benchmark::State& state) {
        bare.compare(state, world);
    })->Unit(benchmark::kMillisecond);
    add("shafts", shafts);
    add("box_tests", box_tests);
    add("candidates", candidates);
    add("sights", sights);
}

} // namespace
} // namespace kinelux

int main(int argc, char** argv) try {
    benchmark::Initialize(&argc, argv);
    kinelux::register_world("room", kinelux::furnished_room());
    for (int i = 1; i < argc; ++i)
        kinelux::register_world(std::filesystem::path(argv[i]).stem().string(), kinelux::case_world(argv[i]));
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
} catch (const kinelux::core::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
}
