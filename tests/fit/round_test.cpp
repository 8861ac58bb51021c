// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "fit/fit.h"
#include "fit/scene_meshes.h"
#include "geometry/surface.h"

namespace kinelux::fit {
namespace {

using model::SurfaceType;
using std::numbers::pi;
using support::add_object;
using support::empty_scene;

// A tilted frame, so that nothing is aligned with the coordinates.
Vec3 tilted(const Vec3& x) {
    const Vec3 w = glm::normalize(Vec3{0.3, -0.2, 1.0}),
               u = glm::normalize(glm::cross(Vec3{0.0, 1.0, 0.0}, w));
    return Vec3{0.7, 11.0, -3.0} + x.x * u + x.y * glm::cross(w, u) + x.z * w;
}

/// A grid of columns x rows cells over (s, t) in the unit square. @param point  of (s, t); equal points are one
model::Mesh grid_mesh(int columns, int rows, const std::function<Vec3(double, double)>& point) {
    model::Mesh mesh;
    const auto number = [&](int i, int j) {
        const Vec3 x = point(static_cast<double>(i) / columns, static_cast<double>(j) / rows);
        for (std::uint32_t p = 0; p < mesh.points.size(); ++p)
            if (glm::distance(mesh.points[p], x) < 1e-9) return p;
        mesh.points.push_back(x);
        return static_cast<std::uint32_t>(mesh.points.size() - 1);
    };
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            for (const model::Triangle& t :
                 {model::Triangle{number(i, j), number(i + 1, j), number(i + 1, j + 1)},
                  model::Triangle{number(i, j), number(i + 1, j + 1), number(i, j + 1)}})
                if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
    return mesh;
}

/// Part of a torus, of a sphere at ring 0: angles u about the axis and v about the tube.
model::Mesh ring_mesh(double ring, double tube, Vec2 u, Vec2 v, int columns, int rows) {
    return grid_mesh(columns, rows, [&](double s, double t) {
        const double a = u.x + s * (u.y - u.x), b = v.x + t * (v.y - v.x);
        const double r = ring + tube * std::cos(b);
        return tilted({r * std::cos(a), r * std::sin(a), tube * std::sin(b)});
    });
}

/// The side of a cone, of a cylinder where both radii are one; as far as `turn` about the axis.
model::Mesh side_mesh(double low_radius, double high_radius, double height, double turn, int columns,
                      int rows = 1) {
    return grid_mesh(columns, rows, [&](double s, double t) {
        const double r = low_radius + t * (high_radius - low_radius);
        return tilted({r * std::cos(turn * s), r * std::sin(turn * s), t * height});
    });
}

/// An icosahedron whose faces are halved `times` times; its poles lie anywhere.
model::Mesh ball_mesh(int times) {
    const double g = 0.5 * (1.0 + std::sqrt(5.0));
    model::Mesh mesh;
    mesh.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int time = 0; time < times; ++time) {
        model::Mesh finer;
        finer.points = mesh.points;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const Vec3 x = mesh.points[a] + mesh.points[b];
            const auto found = std::find(finer.points.begin(), finer.points.end(), x);
            if (found != finer.points.end()) return static_cast<std::uint32_t>(found - finer.points.begin());
            finer.points.push_back(x);
            return static_cast<std::uint32_t>(finer.points.size() - 1);
        };
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.triangles.insert(finer.triangles.end(),
                                   {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh = finer;
    }
    for (Vec3& x : mesh.points) x = tilted(glm::normalize(x));
    return mesh;
}

FitResult fitted(const model::Mesh& mesh, const FitOptions& options = {}) {
    model::Scene scene = empty_scene();
    add_object(scene, "part", mesh);
    FitResult result = fit_patches(scene, options);
    model::check(result.patches, scene);
    return result;
}

// The one patch that a mesh becomes; its area, and its front on the side of the mesh's.
void expect_one(const model::Mesh& mesh, SurfaceType type, double area, const std::string& what,
                double tolerance) {
    const FitResult result = fitted(mesh);
    ASSERT_EQ(result.patches.patches.size(), 1U) << what;
    EXPECT_EQ(result.round_patches, 1U) << what;
    EXPECT_TRUE(result.patches.small.triangles.empty()) << what;
    const model::Patch& patch = result.patches.patches[0];
    EXPECT_EQ(patch.surface.type, type) << what;
    EXPECT_NEAR(geometry::area(patch) / area, 1.0, tolerance) << what;
    EXPECT_LT(patch.deviation_max, 1e-7) << what;
    const model::Triangle& face = mesh.triangles[mesh.triangles.size() / 2];
    const Vec3 a = mesh.points[face[0]];
    const Vec3 front = glm::cross(mesh.points[face[1]] - a, mesh.points[face[2]] - a);
    const Vec3 middle = (mesh.points[face[0]] + mesh.points[face[1]] + mesh.points[face[2]]) / 3.0;
    double nearest = 1e300, along = 0.0;
    for (const model::Triangle& t : patch.triangles)
        for (int i = 1; i < 40; ++i)
            for (int j = 1; i + j < 40; ++j) {
                const Vec2 uv = (static_cast<double>(i) * patch.points[t[0]] +
                                 static_cast<double>(j) * patch.points[t[1]] +
                                 static_cast<double>(40 - i - j) * patch.points[t[2]]) /
                                40.0;
                const geometry::SurfaceJet jet = geometry::evaluate(patch.surface, uv);
                if (glm::distance(jet.position, middle) >= nearest) continue;
                nearest = glm::distance(jet.position, middle);
                along = glm::dot(jet.normal, glm::normalize(front));
            }
    EXPECT_GT(along, 0.9) << what;
}

TEST(RoundPatches, meshes_of_one_surface_become_one_patch_of_it) {
    for (const bool hollow : {false, true}) {
        const auto expect = [&](const model::Mesh& mesh, SurfaceType type, double area,
                                const std::string& what, double tolerance = 1e-7) {
            expect_one(hollow ? support::turned_inside_out(mesh) : mesh, type, area,
                       what + (hollow ? ", hollow" : ""), tolerance);
        };
        expect(side_mesh(0.5, 0.5, 2.0, 2.0 * pi, 24), SurfaceType::Cylinder, 2.0 * pi, "cylinder");
        expect(side_mesh(0.5, 0.5, 2.0, 1.2, 12, 3), SurfaceType::Cylinder, 1.2, "part of a cylinder");
        expect(side_mesh(1.0, 0.5, 2.0, 2.0 * pi, 20, 2), SurfaceType::Cone, pi * 1.5 * std::sqrt(4.25),
               "cone");
        expect(side_mesh(1.0, 0.0, 2.0, 2.0 * pi, 20, 4), SurfaceType::Cone, pi * std::sqrt(5.0),
               "cone with its tip");
        expect(ring_mesh(0.0, 0.7, {0, 2 * pi}, {-pi / 2, pi / 2}, 24, 12), SurfaceType::Sphere,
               4.0 * pi * 0.49, "sphere of rings");
        expect(ring_mesh(0.0, 0.7, {0, 2 * pi}, {0, pi / 2}, 24, 6), SurfaceType::Sphere, 2.0 * pi * 0.49,
               "dome");
        expect(ring_mesh(0.0, 0.7, {0.3, 2.0}, {-0.5, 1.0}, 10, 10), SurfaceType::Sphere,
               0.49 * 1.7 * (std::sin(1.0) + std::sin(0.5)), "window of a sphere, whose axis is anywhere",
               2e-3);
        expect(ball_mesh(2), SurfaceType::Sphere, 4.0 * pi, "sphere of an icosahedron");
        expect(ring_mesh(2.0, 0.5, {0, 2 * pi}, {0, 2 * pi}, 40, 20), SurfaceType::Torus, 4.0 * pi * pi,
               "torus");
        expect(ring_mesh(2.0, 0.5, {0, pi / 2}, {0, 2 * pi}, 12, 20), SurfaceType::Torus, pi * pi, "elbow");
        expect(ring_mesh(2.0, 0.5, {0, 2 * pi}, {0.4, 1.9}, 30, 8), SurfaceType::Torus,
               2.0 * pi * 0.5 * (2.0 * 1.5 + 0.5 * (std::sin(1.9) - std::sin(0.4))), "moulding");
    }
}

TEST(RoundPatches, chords_are_reported_and_the_area_grows_by_what_they_cut_off) {
    const FitResult result = fitted(side_mesh(0.5, 0.5, 2.0, 2.0 * pi, 24));
    // The centroid of half a strip lies a third of the way from the middle of the chord to its end.
    const double half = pi / 24.0, foot = std::hypot(std::cos(half), std::sin(half) / 3.0);
    EXPECT_NEAR(result.chord_max, 0.5 * (1.0 - foot), 1e-9);
    EXPECT_NEAR(result.area_in, 24.0 * std::sin(half) * 2.0, 1e-9);
    EXPECT_NEAR(result.area_out, 2.0 * pi, 1e-7);
}

TEST(RoundPatches, coarse_prisms_and_what_is_no_such_surface_stay_small_triangles) {
    EXPECT_EQ(fitted(side_mesh(0.5, 0.5, 2.0, 2.0 * pi, 14)).round_patches,
              0U); // 25.7 degrees from face to face
    EXPECT_EQ(fitted(side_mesh(0.5, 0.5, 2.0, 2.0 * pi, 16)).round_patches, 1U);
    EXPECT_EQ(fitted(side_mesh(0.5, 0.5, 2.0, 2.0 * pi, 16), {.round_face_turn_deg = 0.0}).round_patches, 0U);
    const model::Mesh egg = grid_mesh(24, 24, [](double s, double t) {
        const double a = 2.0 * pi * s, b = pi * (t - 0.5);
        return tilted({std::cos(b) * std::cos(a), 1.3 * std::cos(b) * std::sin(a), 2.0 * std::sin(b)});
    });
    EXPECT_EQ(fitted(egg, {.distance_tolerance = 1e-5}).round_patches, 0U);
}

TEST(RoundPatches, surfaces_that_continue_each_other_smoothly_are_told_apart) {
    // A pipe that runs straight, through a quarter of a bend, and straight on.
    const double bend = 1.5, tube = 0.4, straight = 2.0, arc = 0.5 * pi * bend, whole = 2.0 * straight + arc;
    constexpr int rows = 30;
    const model::Mesh pipe = grid_mesh(24, rows, [&](double s, double t) {
        const double a = 2.0 * pi * s, piece = 3.0 * t,
                     along = piece <= 1.0   ? piece * straight
                             : piece <= 2.0 ? straight + (piece - 1.0) * arc
                                            : whole - (3.0 - piece) * straight;
        Vec3 centre, out;
        if (along <= straight) {
            centre = {bend, 0.0, along - straight};
            out = {1.0, 0.0, 0.0};
        } else if (along <= straight + arc) {
            const double b = (along - straight) / bend;
            out = {std::cos(b), 0.0, std::sin(b)};
            centre = bend * out;
        } else {
            centre = {-(along - straight - arc), 0.0, bend};
            out = {0.0, 0.0, 1.0};
        }
        return tilted(centre + tube * (std::cos(a) * out + std::sin(a) * Vec3{0.0, 1.0, 0.0}));
    });
    const FitResult result = fitted(pipe);
    std::vector<SurfaceType> types;
    double area = geometry::area(result.patches.small);
    for (const model::Patch& patch : result.patches.patches) {
        types.push_back(patch.surface.type);
        area += geometry::area(patch);
    }
    EXPECT_EQ(std::count(types.begin(), types.end(), SurfaceType::Cylinder), 2);
    EXPECT_EQ(std::count(types.begin(), types.end(), SurfaceType::Torus), 1);
    EXPECT_NEAR(area / (2.0 * pi * tube * whole), 1.0, 1e-6);
}

TEST(RoundPatches, windows_are_holes_in_the_domain) {
    model::Mesh drum = side_mesh(1.0, 1.0, 2.0, 2.0 * pi, 32, 8);
    // A window over the seam of the mesh, and one elsewhere: 2 x 2 cells each.
    const auto cell = [](std::size_t triangle) { return std::pair(triangle / 2 % 32, triangle / 64); };
    std::vector<model::Triangle> kept;
    for (std::size_t t = 0; t < drum.triangles.size(); ++t) {
        const auto [column, row] = cell(t);
        const bool high = row == 3 || row == 4;
        if (high && (column == 31 || column == 0 || column == 10 || column == 11)) continue;
        kept.push_back(drum.triangles[t]);
    }
    drum.triangles = kept;
    const FitResult result = fitted(drum);
    ASSERT_EQ(result.patches.patches.size(), 1U);
    EXPECT_NEAR(geometry::area(result.patches.patches[0]), 4.0 * pi - 8.0 * (pi / 16.0) * 0.25, 1e-7);
    EXPECT_GE(result.patches.patches[0].loops.size(), 2U);
}

TEST(RoundPatches, a_two_sided_shell_is_two_patches_back_to_back) {
    model::Mesh shell = support::finished(side_mesh(0.5, 0.5, 2.0, 1.5, 12), {}, 1);
    const FitResult result = fitted(shell);
    ASSERT_EQ(result.patches.patches.size(), 2U);
    EXPECT_EQ(result.patches.patches[0].surface.orientation, -result.patches.patches[1].surface.orientation);
    EXPECT_NEAR(geometry::area(result.patches.patches[1]), 1.5, 1e-7);
}

TEST(RoundPatches, order_of_faces_does_not_matter) {
    const model::Mesh mesh = support::finished(ring_mesh(2.0, 0.5, {0, 2 * pi}, {0, 2 * pi}, 40, 20));
    const FitResult straight = fitted(mesh), mixed = fitted(support::shuffled(mesh, 3));
    ASSERT_EQ(mixed.patches.patches.size(), 1U);
    EXPECT_NEAR(mixed.area_out, straight.area_out, 1e-9 * straight.area_out);
    EXPECT_NEAR(mixed.patches.patches[0].surface.radius, straight.patches.patches[0].surface.radius, 1e-9);
}

TEST(RoundPatches, thousand_times_smaller_and_far_away_is_the_same) {
    for (const double scale : {1e-3, 1e3}) {
        model::Mesh mesh = side_mesh(0.5, 0.5, 2.0, 2.0 * pi, 24);
        for (Vec3& x : mesh.points) x = scale * (x + Vec3{1e3, -2e3, 5e2});
        const FitResult result = fitted(mesh);
        ASSERT_EQ(result.round_patches, 1U) << scale;
        EXPECT_NEAR(result.area_out / (scale * scale * 2.0 * pi), 1.0, 1e-6) << scale;
    }
}

} // namespace
} // namespace kinelux::fit
