// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/sequence.h"
#include "reference/reference.h"
#include "reference/scenes.h"
#include "sample/sampler.h"

namespace kinelux::sample {
namespace {

/// A black room with two lamps and eight boxes on and over its floor.
struct ClutteredRoom {
    test::SceneBuilder builder;
    model::PatchSet set;

    ClutteredRoom() {
        const MaterialId black = builder.material({0.0}, {0.0}), lamp = builder.material({0.0}, {5.0});
        add(support::box({-3, -2, 0}, {3, 2, 2.8}, support::Facing::Inwards), black);
        for (const double x : {-2.0, 1.0})
            add({support::rectangle({x, -0.3, 2.7}, {0, 0.6, 0}, {1, 0, 0})}, lamp);
        core::Random random(3);
        for (int i = 0; i < 8; ++i) {
            const Vec3 corner(4.0 * random.next() - 2.2, 3.0 * random.next() - 1.7, i % 2);
            add(support::box(corner, corner + Vec3(0.5, 0.5, 0.8), support::Facing::Outwards), black);
        }
    }
    void add(std::vector<model::Patch> patches, MaterialId material) {
        const ObjectId object = builder.object(patches, material);
        for (model::Patch& patch : patches) {
            patch.object = object;
            patch.material = material;
            set.patches.push_back(patch);
        }
    }
};

TEST(DirectLight, agrees_with_path_tracing_in_a_cluttered_room) {
    const ClutteredRoom room;
    const model::Scene& scene = room.builder.scene;
    const auto sensors = reference::sensor_points(scene, 0.0, 500, 5);
    const auto readings = reference::trace_irradiance(scene, 0.0, sensors, {.paths = 4096, .seed = 2});
    const auto shapes = support::shapes_of(room.set, 3, 0);
    const auto occluders = support::occluders_of(room.set, scene);
    const DirectLight light(shapes, scene, 0.0, occluders, {.shadow_rays = 256});
    std::vector<std::vector<double>> values;
    for (std::size_t i = 0; i < sensors.size(); ++i) {
        values.emplace_back(1);
        light.irradiance({sensors[i].position, sensors[i].normal}, i, values.back());
    }
    const reference::Comparison result = reference::compare(readings, values);
    RecordProperty("relative_rms", std::to_string(result.relative_rms));
    EXPECT_LT(result.relative_rms, 0.006);
    EXPECT_LT(result.reference_noise, 0.004);
    EXPECT_LT(std::abs(result.bias), 0.001);
}

} // namespace
} // namespace kinelux::sample
