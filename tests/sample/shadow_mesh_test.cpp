// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/parallel.h"
#include "kernel/polygon_irradiance.h"
#include "sample/mesh_checks.h"
#include "sample/sampler.h"
#include "sample/shadow_mesh.h"
#include "sample/shown_patches.h"
#include "support/shapes.h"

namespace kinelux::sample {
namespace {

constexpr double cell = 0.25;
constexpr std::array<Vec3, 4> lamp{Vec3(-0.1, -0.1, 2.0), Vec3(-0.1, 0.1, 2.0), Vec3(0.1, 0.1, 2.0),
                                   Vec3(0.1, -0.1, 2.0)};

/// A square ground below a lamp of 0.2 m, 2 m above it; with a screen across x > 0 half way, or without.
struct Ground : test::ShownPatches {
    explicit Ground(bool screen,
                    const model::Patch& ground = support::rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}))
        : ShownPatches(patches(screen, ground), lit_scene(), 2, 0, cell) {}

    static model::Scene lit_scene() {
        model::Scene scene = support::plain_scene(3);
        scene.materials.push_back({"lamp", {0.0}, {5.0}, model::Sides::Front});
        return scene;
    }
    static std::vector<model::Patch> patches(bool screen, const model::Patch& ground) {
        std::vector<model::Patch> result{
            ground,
            support::rectangle(lamp[0], lamp[1] - lamp[0], lamp[3] - lamp[0], ObjectId(1), MaterialId(1))};
        if (screen) result.push_back(support::rectangle({0, -2, 1}, {2, 0, 0}, {0, 4, 0}, ObjectId(2)));
        return result;
    }
    ShadowMesh shadows(double smallest_edge, double tolerance = 0.03) const {
        return shadow_mesh(mesh, set, shapes, scene, 0.0, poses, occluders, direct,
                           {.tolerance = tolerance, .smallest_edge = smallest_edge});
    }

    DirectLightOptions direct{.probe_rays = 64, .shadow_rays = 2048};
};

// The part of the lamp that a point of the ground sees past the screen's edge (x = 0 at half the height): x' < -x.
double truth(const Vec3& x) {
    const double end = std::clamp(-x.x, -0.1, 0.1);
    if (end <= -0.1) return 0.0;
    const std::array<Vec3, 4> seen{lamp[0], lamp[1], Vec3(end, 0.1, 2.0), Vec3(end, -0.1, 2.0)};
    return 5.0 * kernel::point_to_polygon(x, {0, 0, 1}, seen);
}

// The largest difference between the field and its linear interpolation between the corners, at triangles' middles.
double interpolation_error(const model::DisplayMesh& mesh) {
    double worst = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (mesh.objects[t] != ObjectId(0)) continue;
        Vec3 middle(0.0);
        double linear = 0.0;
        for (const std::uint32_t corner : mesh.triangles[t]) {
            middle += mesh.points[corner] / 3.0;
            linear += truth(mesh.points[corner]) / 3.0;
        }
        worst = std::max(worst, std::abs(truth(middle) - linear));
    }
    return worst;
}

TEST(ShadowMesh, interpolation_follows_a_penumbra_closely) {
    const Ground ground(true);
    const double bright = truth({-0.5, 0, 0});
    const auto fine = ground.shadows(0.01);
    EXPECT_LT(interpolation_error(fine.mesh), 0.03 * bright);
    EXPECT_LT(interpolation_error(fine.mesh), 0.2 * interpolation_error(ground.mesh));
    EXPECT_LT(fine.unresolved_area, 0.01);
    // The penumbra is 0.2 m wide: cells are small there and as they were elsewhere.
    std::size_t inside = 0, outside = 0, outside_at_rest = 0;
    const auto is_inside = [](const Vec3& x) { return std::abs(x.x) < 0.1 + cell; };
    for (std::size_t p = 0; p < fine.mesh.points.size(); ++p) {
        if (fine.mesh.point_objects[p] != 0) continue;
        (is_inside(fine.mesh.points[p]) ? inside : outside) += 1;
        if (p < ground.mesh.points.size() && !is_inside(ground.mesh.points[p])) ++outside_at_rest;
    }
    EXPECT_GT(inside, 5 * outside_at_rest);
    EXPECT_LT(outside, 2 * outside_at_rest);
}

TEST(ShadowMesh, cells_that_may_not_be_cut_are_counted_where_shadows_are_sharper) {
    const Ground ground(true);
    const auto as_it_was = ground.shadows(10.0);
    EXPECT_EQ(as_it_was.mesh.triangles, ground.mesh.triangles);
    EXPECT_EQ(as_it_was.mesh.points, ground.mesh.points);
    EXPECT_GT(as_it_was.unresolved_area, 0.3); // 0.2 m of 2 m and a cell on each side
    EXPECT_LT(as_it_was.unresolved_area, 2.0);
}

TEST(ShadowMesh, light_that_is_linear_in_every_cell_cuts_none) {
    const Ground ground(false);
    EXPECT_EQ(ground.shadows(0.01, 0.5).mesh.triangles, ground.mesh.triangles);
    // Without shadow the middle below the lamp is brighter than between corners: gradients count more strictly.
    EXPECT_GT(ground.shadows(0.01, 0.003).mesh.triangles.size(), ground.mesh.triangles.size());
}

TEST(ShadowMesh, cut_triangles_fit_together_and_points_keep_their_numbers) {
    const Ground ground(true);
    const model::DisplayMesh mesh = ground.shadows(0.03).mesh;
    test::expect_consistent(mesh);
    EXPECT_EQ(mesh.parameters.size(), mesh.points.size());
    EXPECT_EQ(test::t_junctions(mesh), 0u);
    for (std::size_t p = 0; p < ground.mesh.points.size(); ++p)
        EXPECT_EQ(mesh.points[p], ground.mesh.points[p]);
    double area = 0.0, before = 0.0, thinnest = 1.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        area += test::area_of(mesh, t);
        double longest = 0.0;
        for (std::size_t e = 0; e < 3; ++e)
            longest = std::max(longest, glm::distance(mesh.points[mesh.triangles[t][e]],
                                                      mesh.points[mesh.triangles[t][(e + 1) % 3]]));
        thinnest = std::min(thinnest, 4.0 * test::area_of(mesh, t) / (longest * longest));
    }
    for (std::size_t t = 0; t < ground.mesh.triangles.size(); ++t) before += test::area_of(ground.mesh, t);
    EXPECT_NEAR(area, before, 1e-12);
    EXPECT_GT(thinnest, 0.2); // right-angled ones with equal legs have 1
}

TEST(ShadowMesh, new_points_of_a_round_patch_lie_on_it) {
    model::Patch tube;
    tube.surface.type = model::SurfaceType::Cylinder;
    tube.surface.radius = 0.5;
    tube.surface.origin = {0, 0, 0};
    tube.points = {{0.0, 0.0}, {std::numbers::pi, 0.0}, {std::numbers::pi, 0.9}, {0.0, 0.9}};
    tube.triangles = {{0, 1, 2}, {0, 2, 3}};
    const Ground ground(true, tube);
    const model::DisplayMesh mesh = ground.shadows(0.02).mesh;
    ASSERT_GT(mesh.points.size(), ground.mesh.points.size());
    for (std::size_t p = 0; p < mesh.points.size(); ++p)
        if (mesh.point_objects[p] == 0) {
            const Vec3 x = mesh.points[p];
            EXPECT_NEAR(std::hypot(x.x, x.y), 0.5, 1e-12);
            EXPECT_NEAR(std::abs(glm::dot(mesh.normals[p], Vec3(x.x, x.y, 0.0))), 0.5, 1e-12);
        }
}

TEST(ShadowMesh, the_same_at_any_number_of_threads) {
    const Ground ground(true);
    core::set_thread_count(1);
    const auto one = ground.shadows(0.02);
    core::set_thread_count(2);
    const auto two = ground.shadows(0.02);
    core::set_thread_count(0);
    EXPECT_EQ(one.mesh.points, two.mesh.points);
    EXPECT_EQ(one.mesh.triangles, two.mesh.triangles);
    EXPECT_EQ(one.unresolved_area, two.unresolved_area);
}

} // namespace
} // namespace kinelux::sample
