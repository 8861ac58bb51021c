// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/patch_set.h"

#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"

namespace kinelux::model {
namespace {

Scene one_object() {
    Scene scene;
    scene.channels = {"grey"};
    scene.materials = {{"grey", {0.5}, {0.0}, Sides::Front}};
    scene.objects.resize(1);
    return scene;
}

PatchSet square_and_triangle() {
    PatchSet set;
    Patch patch;
    patch.points = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
    patch.triangles = {{0, 1, 2}, {0, 2, 3}};
    patch.loops = {{0, 1, 2, 3}};
    set.patches.push_back(patch);
    set.small.points = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    set.small.triangles = {{0, 1, 2}};
    set.small.objects = {ObjectId(0)};
    set.small.materials = {MaterialId(0)};
    return set;
}

TEST(PatchSet, well_formed_set_passes) { EXPECT_NO_THROW(check(square_and_triangle(), one_object())); }

TEST(PatchSet, ids_and_indices_out_of_range_are_refused) {
    const Scene scene = one_object();
    PatchSet set = square_and_triangle();
    set.patches[0].object = ObjectId(1);
    EXPECT_THROW(check(set, scene), core::GeometryError);
    set = square_and_triangle();
    set.patches[0].triangles[1][2] = 4;
    EXPECT_THROW(check(set, scene), core::GeometryError);
    set = square_and_triangle();
    set.patches[0].loops[0][0] = 9;
    EXPECT_THROW(check(set, scene), core::GeometryError);
    set = square_and_triangle();
    set.small.triangles[0][0] = 3;
    EXPECT_THROW(check(set, scene), core::GeometryError);
    set = square_and_triangle();
    set.small.materials[0] = MaterialId(2);
    EXPECT_THROW(check(set, scene), core::GeometryError);
}

TEST(PatchSet, numbers_that_are_not_finite_are_refused) {
    const Scene scene = one_object();
    PatchSet set = square_and_triangle();
    set.patches[0].points[2].x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(check(set, scene), core::GeometryError);
    set = square_and_triangle();
    set.small.points[0].y = std::numeric_limits<double>::infinity();
    EXPECT_THROW(check(set, scene), core::GeometryError);
}

TEST(PatchSet, domain_that_is_clockwise_or_without_triangles_is_refused) {
    const Scene scene = one_object();
    PatchSet set = square_and_triangle();
    set.patches[0].triangles = {{0, 2, 1}, {0, 3, 2}};
    EXPECT_THROW(check(set, scene), core::GeometryError);
    set.patches[0].triangles.clear();
    EXPECT_THROW(check(set, scene), core::GeometryError);
}

TEST(PatchSet, sizes_that_differ_are_refused) {
    PatchSet set = square_and_triangle();
    set.small.objects.clear();
    EXPECT_THROW(check(set, one_object()), core::GeometryError);
}

} // namespace
} // namespace kinelux::model
