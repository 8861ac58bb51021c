// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/sequence.h"
#include "kernel/polygon_irradiance.h"
#include "sample/sampler.h"
#include "support/shapes.h"

namespace kinelux::sample {
namespace {

/// Material 0 is dark, 1 emits 5. Object 0 is the lamp.
model::Scene lamp_scene(std::size_t objects) {
    model::Scene scene = support::plain_scene(objects, 0.5, 0.0);
    scene.materials.push_back({"lamp", {0.1}, {5.0}, model::Sides::Front});
    return scene;
}

/// The unit lamp at height 1 about the z axis, facing down.
model::Patch lamp(ObjectId object = ObjectId(0)) {
    return support::rectangle({-0.5, -0.5, 1}, {0, 1, 0}, {1, 0, 0}, object, MaterialId(1));
}

std::array<Vec3, 4> lamp_corners(double from_x = -0.5) {
    return {Vec3(from_x, -0.5, 1), Vec3(from_x, 0.5, 1), Vec3(0.5, 0.5, 1), Vec3(0.5, -0.5, 1)};
}

double at(const DirectLight& light, const Receiver& receiver, std::uint64_t stream = 0) {
    std::array<double, 1> result{-1.0};
    light.irradiance(receiver, stream, result);
    return result[0];
}

/// A direct light with everything it looks at.
struct Lit {
    model::PatchSet set;
    model::Scene scene;
    std::vector<geometry::ElementShape> shapes;
    visibility::Occluders occluders;
    DirectLight light;

    Lit(std::vector<model::Patch> patches, int n, const DirectLightOptions& options = {})
        : set{std::move(patches), {}},
          scene(lamp_scene(4)),
          shapes(support::shapes_of(set, n, 0)),
          occluders(support::occluders_of(set, scene)),
          light(shapes, scene, 0.0, occluders, options) {}
};

TEST(DirectLight, a_square_gives_its_closed_form_however_it_is_cut) {
    core::Random random(4);
    for (const int n : {1, 3, 8}) {
        const Lit lit({lamp()}, n);
        for (int i = 0; i < 200; ++i) {
            const Vec3 x = Vec3(4.0 * random.next_2d() - 2.0, 0.9 * random.next());
            const Vec3 normal = glm::normalize(Vec3(2.0 * random.next_2d() - 1.0, random.next()));
            const double truth = 5.0 * kernel::point_to_polygon(x, normal, lamp_corners());
            EXPECT_NEAR(at(lit.light, {x, normal}), truth, 1e-12);
        }
    }
}

TEST(DirectLight, distant_panels_keep_their_closed_form_within_a_thousandth) {
    const Lit lit({lamp()}, 2);
    for (const double distance : {15.0, 30.0, 60.0})
        for (const double sine : {0.0, 0.5, 0.8}) {
            const Vec3 x = Vec3(0, 0, 1) - distance * Vec3(sine, 0.0, std::sqrt(1.0 - sine * sine));
            const double truth = 5.0 * kernel::point_to_polygon(x, {0, 0, 1}, lamp_corners());
            EXPECT_NEAR(at(lit.light, {x, {0, 0, 1}}) / truth, 1.0, 1e-3);
        }
}

TEST(DirectLight, a_half_hidden_lamp_gives_the_closed_form_of_its_visible_half) {
    // The shutter covers x < 0 right below the lamp.
    const Lit lit({lamp(), support::rectangle({-3, -3, 0.999}, {3, 0, 0}, {0, 6, 0}, ObjectId(1))}, 4,
                  {.shadow_rays = 256});
    double sum = 0.0;
    for (std::uint64_t i = 0; i < 100; ++i) {
        const Vec2 s = core::sobol_2d(static_cast<std::uint32_t>(i), 3);
        const Vec3 x(s - 0.5, 0.0);
        // Seen from x, the shutter's edge hides the lamp up to a line slightly off its middle.
        const double truth =
            5.0 * kernel::point_to_polygon(x, {0, 0, 1}, lamp_corners(-x.x * (1.0 / 0.999 - 1.0)));
        const double value = at(lit.light, {x, {0, 0, 1}}, i);
        EXPECT_NEAR(value / truth, 1.0, 0.03);
        sum += std::abs(value / truth - 1.0) / 100.0;
    }
    EXPECT_LT(sum, 0.01);
}

TEST(DirectLight, a_wholly_hidden_lamp_gives_nothing) {
    const Lit lit({lamp(), support::rectangle({-9, -9, 0.9}, {18, 0, 0}, {0, 18, 0}, ObjectId(1))}, 2);
    EXPECT_EQ(at(lit.light, {{0.1, 0.2, 0.0}, {0, 0, 1}}), 0.0);
}

TEST(DirectLight, receivers_on_behind_and_beside_a_lamp_get_nothing) {
    const Lit lit({lamp()}, 3);
    EXPECT_EQ(at(lit.light, {{0.1, 0.2, 1.0}, {0, 0, -1}}), 0.0); // on it
    EXPECT_EQ(at(lit.light, {{0.1, 0.2, 1.0}, {0, 0, 1}}), 0.0);
    EXPECT_EQ(at(lit.light, {{2.1, 0.2, 1.0}, {0, 0, -1}}), 0.0); // in its plane
    EXPECT_EQ(at(lit.light, {{2.1, 0.2, 1.0}, {-1, 0, 0}}), 0.0);
    EXPECT_EQ(at(lit.light, {{0.1, 0.2, 1.5}, {0, 0, -1}}), 0.0); // behind it
    EXPECT_EQ(at(lit.light, {{0.1, 0.2, 0.5}, {0, 0, -1}}), 0.0); // turned away
}

TEST(DirectLight, lamps_add_up_and_channels_keep_their_share) {
    const model::Patch second =
        support::rectangle({2, -0.5, 0.2}, {0, 0, 1}, {0, 1, 0}, ObjectId(1), MaterialId(1));
    const Vec3 x(0.3, 0.1, 0.0), normal = glm::normalize(Vec3(0.3, 0.0, 1.0));
    const double both = at(Lit({lamp(), second}, 2).light, {x, normal});
    const double one = at(Lit({lamp()}, 2).light, {x, normal}),
                 other = at(Lit({second}, 2).light, {x, normal});
    EXPECT_GT(other, 0.0);
    EXPECT_NEAR(both, one + other, 1e-12);

    Lit colour({lamp()}, 2);
    colour.scene.channels = {"r", "g"};
    colour.scene.materials[1].exitance = {5.0, 1.0};
    const DirectLight light(colour.shapes, colour.scene, 0.0, colour.occluders, {});
    std::array<double, 2> result{};
    light.irradiance({x, normal}, 0, result);
    EXPECT_NEAR(result[0], 5.0 * result[1], 1e-12);
}

TEST(DirectLight, a_dimmed_lamp_shines_with_its_factor_at_the_time_and_not_at_all_when_off) {
    Lit lit({lamp()}, 2);
    lit.scene.dimmings = {{"evening", model::Interpolation::Linear, {{0.0, 1.0}, {4.0, 0.0}}}};
    lit.scene.materials[1].dimming = DimmingId(0);
    const Receiver receiver{{0.1, 0.2, 0.0}, {0, 0, 1}};
    const double full = 5.0 * kernel::point_to_polygon(receiver.position, receiver.normal, lamp_corners());
    for (const double t : {0.0, 1.0, 3.0, 4.0}) {
        const DirectLight light(lit.shapes, lit.scene, t, lit.occluders, {});
        EXPECT_NEAR(at(light, receiver), (1.0 - t / 4.0) * full, 1e-12);
    }
}

TEST(DirectLight, penumbra_error_falls_with_the_number_of_rays) {
    const std::vector<model::Patch> patches{
        lamp(), support::rectangle({-3, -3, 0.5}, {3.1, 0, 0}, {0, 6, 0.2}, ObjectId(1))};
    const auto rms = [&](int rays) {
        const Lit lit(patches, 2, {.probe_rays = 64, .shadow_rays = rays});
        const Lit exact(patches, 2, {.probe_rays = 256, .shadow_rays = 4096, .seed = 99});
        double sum = 0.0;
        for (std::uint64_t i = 0; i < 200; ++i) {
            const Receiver receiver{Vec3(core::sobol_2d(static_cast<std::uint32_t>(i), 3) - 0.5, 0.0),
                                    {0, 0, 1}};
            const double d = at(lit.light, receiver, i) - at(exact.light, receiver, i);
            sum += d * d / 200.0;
        }
        return std::sqrt(sum);
    };
    const double few = rms(64), many = rms(1024);
    EXPECT_LT(many, 0.25 * few); // plain Monte Carlo would give 0.25
    EXPECT_LT(many, 0.01);
}

TEST(LightPanels, coplanar_facets_of_many_elements_make_one_panel_with_four_edges) {
    const std::vector<geometry::ElementShape> shapes = support::shapes_of({{lamp()}, {}}, 5, 0);
    std::vector<const geometry::ElementShape*> elements;
    elements.reserve(shapes.size());
    for (const geometry::ElementShape& shape : shapes) elements.push_back(&shape);
    const std::vector<LightPanel> panels = light_panels(elements);
    ASSERT_EQ(panels.size(), 1u);
    EXPECT_EQ(panels[0].facets.size(), 50u);
    EXPECT_EQ(panels[0].outline.size(), 4u);
    EXPECT_NEAR(panels[0].area(), 1.0, 1e-14);
    EXPECT_NEAR(panels[0].radius, std::sqrt(0.5), 1e-14);
}

} // namespace
} // namespace kinelux::sample
