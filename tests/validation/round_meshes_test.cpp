// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes of round things on the whole way: fitted, divided, seen through their own chords, beside closed forms.
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cluster/cluster.h"
#include "coefficients/coefficients.h"
#include "fit/fit.h"
#include "support/closed_forms.h"
#include "visibility/occluders.h"

namespace kinelux::validation {
namespace {

using std::numbers::pi;

/// A profile of (distance from the axis, height) turned about the z axis, facing away from the axis where it runs upwards.
model::Mesh turned(const std::vector<Vec2>& profile, std::uint32_t around) {
    model::Mesh mesh;
    const auto rows = static_cast<std::uint32_t>(profile.size());
    for (const Vec2& p : profile)
        for (std::uint32_t i = 0; i < around; ++i) {
            const double angle = 2.0 * pi * i / around;
            mesh.points.push_back({p.x * std::cos(angle), p.x * std::sin(angle), p.y});
        }
    for (std::uint32_t k = 0; k + 1 < rows; ++k)
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t a = k * around + i, b = k * around + (i + 1) % around;
            if (profile[k].x > 0.0) mesh.triangles.push_back({a, b, b + around});
            if (profile[k + 1].x > 0.0) mesh.triangles.push_back({a, b + around, a + around});
        }
    mesh.materials.resize(mesh.triangles.size());
    mesh.two_sided.resize(mesh.triangles.size(), 0);
    mesh.source_faces.resize(mesh.triangles.size(), 0);
    return mesh;
}

std::vector<Vec2> arc(double radius, double distance, double from, double to, int steps) {
    std::vector<Vec2> profile;
    for (int k = 0; k <= steps; ++k) {
        const double angle = from + (to - from) * k / steps;
        const double out = distance + radius * std::cos(angle);
        profile.push_back({std::abs(out) < 1e-12 ? 0.0 : out, radius * std::sin(angle)});
    }
    return profile;
}

model::Mesh hollow(model::Mesh mesh) {
    for (model::Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

/// Form factors between objects, row by row; every face must have become a round or planar patch.
std::vector<double> factors(const std::vector<model::Mesh>& meshes, double element_size) {
    model::Scene scene;
    scene.channels = {"grey"};
    scene.materials = {{"grey", {0.5}, {0.0}, model::Sides::Front}};
    for (const model::Mesh& mesh : meshes) {
        scene.objects.emplace_back();
        scene.objects.back().name = std::to_string(scene.objects.size());
        scene.objects.back().mesh = mesh;
    }
    const fit::FitResult fitted = fit::fit_patches(scene, {});
    EXPECT_TRUE(fitted.patches.small.triangles.empty());
    const model::ClusterTree tree =
        cluster::build_clusters(fitted.patches, {.element_size = element_size, .cluster_size = element_size});
    const auto elements = geometry::element_shapes(fitted.patches, tree, 0, 0);
    const visibility::Occluders occluders(visibility::bodies_of(fitted.patches, scene));
    const auto coefficients = coefficients::compute_coefficients(
        elements, scene, {.degree = 0}, occluders, {.tolerance = 1e-3, .sight_tolerance = 1e-2}, 1e6);
    std::vector<std::uint32_t> groups;
    for (const geometry::ElementShape& element : elements) groups.push_back(element.object.value);
    const auto count = static_cast<std::uint32_t>(meshes.size());
    std::vector<double> result(meshes.size() * meshes.size(), 0.0);
    for (const auto& factor : coefficients::form_factors(coefficients, elements, groups, count))
        result[factor.from * count + factor.to] = factor.value;
    return result;
}

TEST(RoundMeshes, ball_in_a_hollow_ball) {
    const double inner = 0.5;
    for (const std::uint32_t around : {24U, 64U}) {
        const int rings = static_cast<int>(around) / 2;
        const std::vector<double> f = factors({turned(arc(inner, 0.0, -pi / 2, pi / 2, rings), around),
                                               hollow(turned(arc(1.0, 0.0, -pi / 2, pi / 2, rings), around))},
                                              0.5);
        EXPECT_NEAR(f[0], 0.0, 1e-9) << around;
        EXPECT_NEAR(f[1], 1.0, 3e-3) << around;
        EXPECT_NEAR(f[2], support::outer_sphere_to_inner(inner, 1.0), 1e-3) << around;
        EXPECT_NEAR(f[3], support::outer_sphere_to_itself(inner, 1.0), 1e-2)
            << around; // past the inner one, by rays
    }
}

TEST(RoundMeshes, inside_of_a_cylinder_with_its_ends_open) {
    const double height = 2.0;
    const std::vector<double> f = factors({hollow(turned({{1.0, 0.0}, {1.0, height}}, 48))}, 0.5);
    EXPECT_NEAR(f[0], support::cylinder_to_itself(1.0, height), 2e-3);
}

TEST(RoundMeshes, a_closed_hollow_torus_keeps_its_light) {
    const std::vector<double> f = factors({hollow(turned(arc(0.5, 1.5, 0.0, 2.0 * pi, 24), 48))}, 0.6);
    EXPECT_NEAR(f[0], 1.0, 1e-2);
}

TEST(RoundMeshes, a_bowl_sees_itself_and_its_opening) {
    // The opening of a half ball is half as large as its inside and takes as much of its light: 1/2 stays.
    const std::vector<double> f = factors({hollow(turned(arc(1.0, 0.0, -pi / 2, 0.0, 16), 64))}, 0.4);
    EXPECT_NEAR(f[0], 0.5, 1e-3);
}

} // namespace
} // namespace kinelux::validation
