// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mesh.h"

#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"

namespace kinelux::model {
namespace {

// A tetrahedron with corners at the origin and one unit along each axis, moved.
Mesh tetrahedron(const Vec3& shift) {
    Mesh mesh;
    mesh.points = {shift, shift + Vec3(1, 0, 0), shift + Vec3(0, 1, 0), shift + Vec3(0, 0, 1)};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    mesh.materials.assign(4, MaterialId(0));
    return mesh;
}

TEST(MeshTest, area_and_volume_of_a_tetrahedron_are_exact) {
    const Mesh mesh = tetrahedron(Vec3(0.0));
    EXPECT_NEAR(area(mesh), 1.5 + std::sqrt(3.0) / 2.0, 1e-15);
    EXPECT_NEAR(signed_volume(mesh), 1.0 / 6.0, 1e-15);
}

TEST(MeshTest, volume_survives_a_shift_far_from_the_origin) {
    EXPECT_NEAR(signed_volume(tetrahedron(Vec3(1048576.0, -2097152.0, 524288.0))), 1.0 / 6.0, 1e-12);
}

TEST(MeshTest, volume_changes_sign_when_the_mesh_is_turned_inside_out) {
    Mesh mesh = tetrahedron(Vec3(0.0));
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    EXPECT_NEAR(signed_volume(mesh), -1.0 / 6.0, 1e-15);
}

TEST(MeshTest, an_empty_mesh_has_no_area_and_no_volume) {
    EXPECT_EQ(area(Mesh{}), 0.0);
    EXPECT_EQ(signed_volume(Mesh{}), 0.0);
}

TEST(MeshTest, normal_of_a_face_without_area_is_zero) {
    Mesh mesh = tetrahedron(Vec3(0.0));
    EXPECT_EQ(triangle_normal(mesh, 0), Vec3(0, 0, -1));
    mesh.points[2] = mesh.points[1];
    EXPECT_EQ(triangle_normal(mesh, 0), Vec3(0.0));
}

TEST(MeshTest, check_refuses_bad_indices_lengths_and_coordinates) {
    EXPECT_NO_THROW(check(tetrahedron(Vec3(0.0)), "body"));
    Mesh mesh = tetrahedron(Vec3(0.0));
    mesh.triangles[1][2] = 4;
    EXPECT_THROW(check(mesh, "body"), core::GeometryError);
    mesh = tetrahedron(Vec3(0.0));
    mesh.materials.pop_back();
    EXPECT_THROW(check(mesh, "body"), core::GeometryError);
    mesh = tetrahedron(Vec3(0.0));
    mesh.source_faces = {1, 2};
    EXPECT_THROW(check(mesh, "body"), core::GeometryError);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        mesh = tetrahedron(Vec3(0.0));
        mesh.points[3].y = bad;
        EXPECT_THROW(check(mesh, "body"), core::GeometryError);
    }
}

TEST(MeshTest, check_wants_a_surface_of_every_triangle_where_any_is_stated) {
    Mesh mesh = tetrahedron(Vec3(0.0));
    mesh.surfaces = {Surface{}};
    EXPECT_THROW(check(mesh, "body"), core::GeometryError);
    mesh.surface_of = {0, no_surface, no_surface, no_surface};
    EXPECT_NO_THROW(check(mesh, "body"));
    mesh.surface_of[1] = 1;
    EXPECT_THROW(check(mesh, "body"), core::GeometryError);
    mesh.surface_of[1] = 0;
    mesh.surfaces[0].orientation = 0.0;
    EXPECT_THROW(check(mesh, "body"), core::GeometryError);
}

} // namespace
} // namespace kinelux::model
