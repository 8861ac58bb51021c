// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/error.h"
#include "fit/scene_meshes.h"

namespace kinelux::fit {
namespace {

using support::add_object;
using support::add_sheet;
using support::box_mesh;
using support::empty_scene;

double area(const model::Patch& patch) {
    double twice = 0.0;
    for (const model::Triangle& t : patch.triangles) {
        const Vec2 ab = patch.points[t[1]] - patch.points[t[0]], ac = patch.points[t[2]] - patch.points[t[0]];
        twice += ab.x * ac.y - ab.y * ac.x;
    }
    return 0.5 * twice;
}

// Areas of the patches of one object, ascending.
std::vector<double> areas_of(const FitResult& result, std::size_t object) {
    std::vector<double> areas;
    for (const model::Patch& patch : result.patches.patches) {
        if (patch.object == ObjectId(object)) areas.push_back(area(patch));
    }
    std::sort(areas.begin(), areas.end());
    return areas;
}

FitResult fitted(const model::Scene& scene, const FitOptions& options = {}) {
    FitResult result = fit_patches(scene, options);
    model::check(result.patches, scene);
    return result;
}

TEST(Fit, closed_box_becomes_six_patches) {
    model::Scene scene = empty_scene();
    add_object(scene, "box", box_mesh(Vec3{0.0}, Vec3{1.0, 2.0, 3.0}));
    const FitResult result = fitted(scene);
    ASSERT_EQ(result.patches.patches.size(), 6U);
    EXPECT_TRUE(result.patches.small.triangles.empty());
    EXPECT_EQ(result.faces_in_patches, 12U);
    const std::vector<double> areas = areas_of(result, 0);
    const std::vector<double> expected{2.0, 2.0, 3.0, 3.0, 6.0, 6.0};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(areas[i], expected[i], 1e-14);
    for (const model::Patch& patch : result.patches.patches) {
        EXPECT_EQ(patch.loops.size(), 1U);
        EXPECT_EQ(patch.triangles.size(), 2U);
        // Outwards: away from the box's middle.
        EXPECT_GT(glm::dot(patch.surface.axis_w, patch.surface.origin - Vec3{0.5, 1.0, 1.5}), 0.0);
        EXPECT_NEAR(glm::dot(glm::cross(patch.surface.axis_u, patch.surface.axis_v), patch.surface.axis_w),
                    1.0, 1e-14);
    }
}

TEST(Fit, wall_with_a_window_is_one_patch_with_two_loops) {
    model::Scene scene = empty_scene();
    model::Mesh wall;
    const auto outside_window = [](int i, int j) { return i < 10 || i >= 20 || j < 10 || j >= 20; };
    add_sheet(wall, Vec3{1.0}, Vec3{3.0, 0.0, 0.0}, Vec3{0.0, 0.0, 3.0}, 30, 30, outside_window);
    add_object(scene, "wall", wall);
    const FitResult result = fitted(scene);
    ASSERT_EQ(result.patches.patches.size(), 1U);
    const model::Patch& patch = result.patches.patches[0];
    EXPECT_EQ(patch.loops.size(), 2U);
    EXPECT_EQ(patch.loops[0].size(), 120U); // boundary points on straight lines are kept
    EXPECT_EQ(patch.loops[1].size(), 40U);
    EXPECT_NEAR(area(patch), 8.0, 8.0e-12);
    EXPECT_LT(patch.triangles.size(), 200U); // of 1600 faces
    EXPECT_LT(patch.deviation_max, 1e-14);
}

TEST(Fit, tilted_wall_has_its_grid_along_its_edges) {
    model::Scene scene = empty_scene();
    model::Mesh wall;
    add_sheet(wall, Vec3{5.0, 7.0, 1.0}, Vec3{4.0, 3.0, 0.0}, Vec3{0.0, 0.0, 2.0}, 4, 3);
    add_object(scene, "wall", wall);
    const FitResult result = fitted(scene);
    ASSERT_EQ(result.patches.patches.size(), 1U);
    EXPECT_NEAR(std::abs(result.patches.patches[0].surface.axis_u.x), 0.8, 1e-12);
    EXPECT_NEAR(std::abs(result.patches.patches[0].surface.axis_u.y), 0.6, 1e-12);
}

TEST(Fit, box_on_a_floor_divides_it_into_open_and_covered_part) {
    model::Scene scene = empty_scene();
    model::Mesh floor;
    add_sheet(floor, Vec3{0.0}, Vec3{4.0, 0.0, 0.0}, Vec3{0.0, 4.0, 0.0}, 3, 3);
    add_object(scene, "floor", floor);
    add_object(scene, "box", box_mesh(Vec3{1.0, 1.5, 0.0}, Vec3{2.0, 2.5, 1.0}));
    const FitResult result = fitted(scene);
    EXPECT_EQ(result.contact_cuts, 1U);
    const std::vector<double> areas = areas_of(result, 0);
    ASSERT_EQ(areas.size(), 2U);
    EXPECT_NEAR(areas[0], 1.0, 1e-12);
    EXPECT_NEAR(areas[1], 15.0, 15e-12);
    EXPECT_EQ(areas_of(result, 1).size(), 6U);
    EXPECT_NEAR(result.area_out, result.area_in, 1e-12 * result.area_in);
}

TEST(Fit, box_without_bottom_sunk_into_a_floor_divides_both) {
    model::Scene scene = empty_scene();
    model::Mesh floor;
    add_sheet(floor, Vec3{0.0}, Vec3{4.0, 0.0, 0.0}, Vec3{0.0, 4.0, 0.0});
    add_object(scene, "floor", floor);
    add_object(scene, "box", box_mesh(Vec3{1.0, 1.5, -0.5}, Vec3{2.0, 2.5, 1.0}));
    const FitResult result = fitted(scene);
    EXPECT_EQ(areas_of(result, 0).size(), 2U);
    EXPECT_EQ(areas_of(result, 1).size(), 10U); // four sides cut in two
    EXPECT_NEAR(result.area_out, result.area_in, 1e-12 * result.area_in);
}

TEST(Fit, sheet_that_separates_nothing_cuts_nothing) {
    model::Scene scene = empty_scene();
    model::Mesh floor, screen;
    add_sheet(floor, Vec3{0.0}, Vec3{4.0, 0.0, 0.0}, Vec3{0.0, 4.0, 0.0});
    add_sheet(screen, Vec3{1.0, 1.0, 0.0}, Vec3{2.0, 0.5, 0.0}, Vec3{0.0, 0.0, 1.0});
    add_object(scene, "floor", floor);
    add_object(scene, "screen", screen);
    const FitResult result = fitted(scene);
    EXPECT_EQ(result.contact_cuts, 0U);
    ASSERT_EQ(result.patches.patches.size(), 2U);
    EXPECT_EQ(result.patches.patches[0].triangles.size(), 2U);
}

TEST(Fit, moving_box_does_not_cut_the_floor_it_rests_on) {
    model::Scene scene = empty_scene();
    model::Mesh floor;
    add_sheet(floor, Vec3{0.0}, Vec3{4.0, 0.0, 0.0}, Vec3{0.0, 4.0, 0.0});
    add_object(scene, "floor", floor);
    add_object(scene, "box", box_mesh(Vec3{1.0, 1.5, 0.0}, Vec3{2.0, 2.5, 1.0}));
    support::set_moving(scene, 1);
    EXPECT_EQ(fitted(scene).contact_cuts, 0U);
}

// A ceiling with a lamp's panel in its plane, both facing down.
model::Scene ceiling_with_lamp() {
    model::Scene scene = empty_scene();
    model::Mesh ceiling, lamp;
    add_sheet(ceiling, Vec3{0.0}, Vec3{0.0, 4.0, 0.0}, Vec3{4.0, 0.0, 0.0}, 2, 2);
    add_sheet(lamp, Vec3{1.0, 1.0, 0.0}, Vec3{0.0, 1.0, 0.0}, Vec3{1.5, 0.0, 0.0});
    add_object(scene, "ceiling", ceiling);
    add_object(scene, "lamp", support::finished(lamp, MaterialId(1)));
    return scene;
}

TEST(Fit, ceiling_ends_where_a_lamp_lies_in_its_plane) {
    const FitResult result = fitted(ceiling_with_lamp());
    EXPECT_EQ(result.covered_patches, 1U);
    EXPECT_NEAR(result.covered_area, 1.5, 1e-12);
    const std::vector<double> ceiling = areas_of(result, 0);
    ASSERT_EQ(ceiling.size(), 1U);
    EXPECT_NEAR(ceiling[0], 14.5, 1e-12);
    EXPECT_NEAR(result.area_in - result.covered_area, result.area_out, 1e-12 * result.area_in);
}

TEST(Fit, moving_lamp_leaves_the_ceiling_whole) {
    model::Scene scene = ceiling_with_lamp();
    support::set_moving(scene, 1);
    const FitResult result = fitted(scene);
    EXPECT_EQ(result.covered_patches, 0U);
    EXPECT_EQ(result.patches.patches.size(), 2U);
}

TEST(Fit, of_a_two_sided_ceiling_only_the_lamps_side_ends) {
    model::Scene scene = ceiling_with_lamp();
    scene.objects[0].mesh.two_sided.assign(scene.objects[0].mesh.triangles.size(), 1);
    const FitResult result = fitted(scene);
    EXPECT_EQ(result.covered_patches, 1U);
    EXPECT_EQ(areas_of(result, 0).size(), 3U); // open part twice, the part above the lamp once
}

TEST(Fit, slightly_bent_wall_is_one_patch_with_its_deviation) {
    model::Scene scene = empty_scene();
    model::Mesh wall;
    wall.points = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 1.0, 4e-3}, {0.0, 1.0, 0.0}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    add_object(scene, "wall", wall);
    const FitResult result = fitted(scene, {.distance_tolerance = 1e-3});
    ASSERT_EQ(result.patches.patches.size(), 1U);
    // The best plane of a warped quadrilateral passes its corners at a quarter of the warp, two above and two below,
    // up to the share that the halves' different shapes take.
    EXPECT_NEAR(result.deviation_max, 1e-3, 4e-4);
    EXPECT_NEAR(result.area_out, result.area_in, 1e-4);
    EXPECT_EQ(result.patches.patches[0].loops[0].size(), 4U);
}

TEST(Fit, warped_wall_of_the_cornell_box_is_two_exact_patches_or_one_within_tolerance) {
    // Published corners; the fourth lies 3.2 mm off the plane of the others.
    model::Scene scene = empty_scene();
    model::Mesh wall, floor;
    wall.points = {{0.5528, 0.0, 0.0}, {0.5496, 0.0, 0.5592}, {0.556, 0.5488, 0.5592}, {0.556, 0.5488, 0.0}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    floor.points = {{0.5528, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.5592}, {0.5496, 0.0, 0.5592}};
    floor.triangles = {{0, 1, 2}, {0, 2, 3}};
    add_object(scene, "wall", wall);
    add_object(scene, "floor", floor);
    model::Mesh ceiling;
    add_sheet(ceiling, Vec3{0.0, 0.5488, 0.0}, Vec3{0.556, 0.0, 0.0}, Vec3{0.0, 0.0, 0.5592});
    add_object(scene, "ceiling", ceiling);
    const FitResult exact = fitted(scene);
    EXPECT_EQ(exact.patches.patches.size(), 4U);
    EXPECT_LT(exact.deviation_max, 1e-12);
    EXPECT_NEAR(exact.area_out, exact.area_in, 1e-12 * exact.area_in);

    const FitResult coarse = fitted(scene, {.distance_tolerance = 1e-3});
    EXPECT_EQ(coarse.patches.patches.size(), 3U);
    EXPECT_EQ(coarse.contact_cuts, 0U);
    EXPECT_NEAR(coarse.deviation_max, 0.8e-3, 0.1e-3);
    EXPECT_NEAR(coarse.area_out, coarse.area_in, 1e-4 * coarse.area_in);
}

// A column of radius 0.4 m and height 3 m.
model::Scene column_over_a_floor(std::uint32_t sides) {
    model::Scene scene = empty_scene();
    model::Mesh floor;
    add_sheet(floor, Vec3{-5.0, -5.0, -1.0}, Vec3{10.0, 0.0, 0.0}, Vec3{0.0, 10.0, 0.0});
    add_object(scene, "floor", floor);
    add_object(scene, "column", support::prism_mesh(Vec3{0.0}, 0.4, 3.0, sides));
    return scene;
}

TEST(Fit, coarse_round_column_becomes_small_triangles) {
    for (const std::uint32_t sides : {13U, 14U}) {
        const FitResult result = fitted(column_over_a_floor(sides));
        EXPECT_EQ(result.patches.patches.size(), 3U) << sides; // the floor and the column's flat ends
        EXPECT_EQ(result.faces_left_small, 2 * sides);
        EXPECT_NEAR(result.area_out, result.area_in, 1e-12 * result.area_in);
    }
}

TEST(Fit, fine_round_column_becomes_one_patch_and_flat_ends) {
    for (const std::uint32_t sides : {16U, 48U}) {
        const FitResult result = fitted(column_over_a_floor(sides));
        EXPECT_EQ(result.patches.patches.size(), 4U) << sides;
        EXPECT_EQ(result.round_patches, 1U);
        EXPECT_EQ(result.faces_left_small, 0U);
        const double chords = 2.0 * sides * 0.4 * std::sin(std::numbers::pi / sides) * 3.0;
        EXPECT_NEAR(result.area_out, result.area_in - chords + 2.0 * std::numbers::pi * 0.4 * 3.0, 1e-9);
    }
}

TEST(Fit, lone_cylinder_becomes_one_patch_and_flat_ends) {
    model::Scene scene = empty_scene();
    add_object(scene, "cylinder", support::prism_mesh(Vec3{0.0}, 1.0, 2.0, 40));
    const FitResult result = fitted(scene);
    EXPECT_EQ(result.patches.patches.size(), 3U);
    EXPECT_EQ(result.faces_left_small, 0U);
}

TEST(Fit, octagonal_room_keeps_its_walls) {
    model::Scene scene = empty_scene();
    add_object(scene, "room", support::turned_inside_out(support::prism_mesh(Vec3{0.0}, 5.0, 3.0, 8)));
    const FitResult result = fitted(scene);
    EXPECT_EQ(result.patches.patches.size(), 10U);
    EXPECT_TRUE(result.patches.small.triangles.empty());
}

TEST(Fit, flat_sides_of_a_rounded_box_stay_patches) {
    // A square column whose edges are rounded by quarter circles in steps of 15 degrees.
    model::Scene scene = empty_scene();
    model::Mesh mesh;
    std::vector<Vec2> outline;
    for (int quarter = 0; quarter < 4; ++quarter) {
        const double turn = 0.5 * std::numbers::pi * quarter;
        for (int step = 0; step <= 6; ++step) {
            const double angle = turn + std::numbers::pi / 12.0 * step;
            const Vec2 centre =
                Vec2{std::cos(turn + std::numbers::pi / 4.0), std::sin(turn + std::numbers::pi / 4.0)};
            outline.push_back(centre + 0.05 * Vec2{std::cos(angle), std::sin(angle)});
        }
    }
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec2 a = outline[i], b = outline[(i + 1) % outline.size()];
        add_sheet(mesh, Vec3{a, 0.0}, Vec3{b - a, 0.0}, Vec3{0.0, 0.0, 1.0});
    }
    add_object(scene, "column", mesh);
    const FitResult result = fitted(scene);
    EXPECT_EQ(result.patches.patches.size(), 8U);
    EXPECT_EQ(result.round_patches, 4U);
    EXPECT_EQ(result.faces_left_small, 0U);
}

TEST(Fit, two_sided_sheet_is_two_patches_back_to_back) {
    model::Scene scene = empty_scene();
    model::Mesh sheet;
    add_sheet(sheet, Vec3{0.0}, Vec3{3.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0}, 2, 2,
              [](int i, int j) { return i == 0 || j == 0; });
    add_object(scene, "sheet", support::finished(sheet, {}, 1));
    const FitResult result = fitted(scene);
    ASSERT_EQ(result.patches.patches.size(), 2U);
    const model::Surface &front = result.patches.patches[0].surface,
                         &back = result.patches.patches[1].surface;
    EXPECT_NEAR(glm::dot(front.axis_w, back.axis_w), -1.0, 1e-14);
    EXPECT_NEAR(glm::dot(glm::cross(back.axis_u, back.axis_v), back.axis_w), 1.0, 1e-14);
    EXPECT_NEAR(area(result.patches.patches[0]), 2.25, 1e-13);
    EXPECT_NEAR(area(result.patches.patches[1]), 2.25, 1e-13);
    EXPECT_NEAR(result.area_in, 4.5, 1e-13);
}

TEST(Fit, order_of_faces_does_not_matter) {
    model::Scene scene = empty_scene();
    model::Mesh floor;
    add_sheet(floor, Vec3{0.0}, Vec3{4.0, 0.0, 0.0}, Vec3{0.0, 4.0, 0.0}, 7, 5);
    add_object(scene, "floor", floor);
    add_object(scene, "box", box_mesh(Vec3{1.0, 1.5, 0.0}, Vec3{2.0, 2.5, 1.0}));
    add_object(scene, "column", support::prism_mesh(Vec3{3.0, 3.0, 0.0}, 0.2, 2.0, 24));
    const FitResult straight = fitted(scene);
    for (model::Object& object : scene.objects) object.mesh = support::shuffled(object.mesh, 17);
    const FitResult mixed = fitted(scene);
    for (std::size_t object = 0; object < 3; ++object) {
        const std::vector<double> a = areas_of(straight, object), b = areas_of(mixed, object);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-12);
    }
    EXPECT_EQ(straight.faces_left_small, mixed.faces_left_small);
    EXPECT_NEAR(straight.area_out, mixed.area_out, 1e-12 * straight.area_out);
}

TEST(Fit, every_face_is_in_a_patch_or_left_small) {
    model::Scene scene = empty_scene();
    add_object(scene, "room",
               support::turned_inside_out(box_mesh(Vec3{-3.0, -3.0, 0.0}, Vec3{3.0, 3.0, 3.0})));
    add_object(scene, "column", support::prism_mesh(Vec3{1.0, 1.0, 0.0}, 0.2, 3.0, 24));
    const FitResult result = fitted(scene);
    EXPECT_EQ(result.faces_in_patches + result.faces_left_small,
              scene.objects[0].mesh.triangles.size() + scene.objects[1].mesh.triangles.size());
    const double chords = 48.0 * 0.2 * std::sin(std::numbers::pi / 24.0) * 3.0;
    EXPECT_NEAR(result.area_out, result.area_in - chords + 2.0 * std::numbers::pi * 0.2 * 3.0, 1e-9);
    EXPECT_EQ(result.contact_cuts, 2U); // floor and ceiling
}

TEST(Fit, scene_without_area_is_refused) {
    model::Scene scene = empty_scene();
    model::Mesh line;
    line.points = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}};
    line.triangles = {{0, 1, 2}};
    add_object(scene, "line", line);
    EXPECT_THROW(fit_patches(scene, {}), core::GeometryError);
}

} // namespace
} // namespace kinelux::fit
