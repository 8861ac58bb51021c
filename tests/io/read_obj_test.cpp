// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_mesh.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/mesh_import.h"
#include "io/temporary_folder.h"

namespace kinelux::io {
namespace {

using support::put_bytes;

class ReadObjTest : public testing::Test {
protected:
    std::filesystem::path write(const std::string& name, const std::string& text) const {
        put_bytes(folder.path() / name, text);
        return folder.path() / name;
    }
    ImportedMeshes read(const std::string& text, std::size_t channels = 3) const {
        return read_mesh(write("mesh.obj", text), channels);
    }
    std::string message_of(const std::string& text) const {
        try {
            read(text);
        } catch (const core::Error& error) {
            return error.what();
        }
        return "nothing thrown";
    }
    support::TemporaryFolder folder;
};

// A letter U, 3 wide and 3 high with a notch of 1 x 2: area 7.
const std::vector<Vec3> letter_u = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0},
                                    {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};

double area_of(const std::vector<Vec3>& corners) {
    double sum = 0.0;
    for (const model::Triangle& t : triangulate_polygon(corners))
        sum += 0.5 * glm::length(glm::cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]));
    return sum;
}

TEST(TriangulatePolygonTest, concave_polygon_is_covered_once_from_every_first_corner_and_side) {
    for (std::size_t start = 0; start < letter_u.size(); ++start)
        for (const bool reversed : {false, true})
            for (int axis = 0; axis < 3; ++axis) {
                std::vector<Vec3> corners;
                for (std::size_t i = 0; i < letter_u.size(); ++i) {
                    const Vec3& p =
                        letter_u[(start + (reversed ? letter_u.size() - i : i)) % letter_u.size()];
                    corners.push_back(axis == 0 ? p : axis == 1 ? Vec3(p.y, p.z, p.x) : Vec3(p.z, p.x, p.y));
                }
                EXPECT_NEAR(area_of(corners), 7.0, 1e-12) << start << reversed << axis;
            }
}

TEST(TriangulatePolygonTest, collinear_and_repeated_corners_keep_area_and_count) {
    const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    EXPECT_EQ(triangulate_polygon(corners).size(), 4U);
    EXPECT_NEAR(area_of(corners), 4.0, 1e-12);
}

TEST(TriangulatePolygonTest, polygon_with_a_hole_reached_by_a_bridge_keeps_its_area) {
    const std::vector<Vec3> corners = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                                       {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
    EXPECT_NEAR(area_of(corners), 12.0, 1e-12);
}

TEST(TriangulatePolygonTest, polygon_of_three_hundred_corners_keeps_its_area) {
    std::vector<Vec3> star;
    double expected = 0.0;
    constexpr int points = 300;
    for (int i = 0; i < points; ++i) {
        const double angle = 2.0 * 3.14159265358979323846 * i / points, radius = i % 2 == 0 ? 1.0 : 0.5;
        star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
    }
    for (int i = 0; i < points; ++i) expected += 0.5 * 0.5 * std::sin(2.0 * 3.14159265358979323846 / points);
    EXPECT_NEAR(area_of(star), expected, 1e-12);
}

TEST_F(ReadObjTest, concave_face_has_the_right_area_and_orientation) {
    std::string text;
    for (const Vec3& p : letter_u)
        text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
    const ImportedMeshes meshes = read(text + "f 1 2 3 4 5 6 7 8\n");
    const model::Mesh& mesh = meshes.objects.at(0).mesh;
    EXPECT_NEAR(model::area(mesh), 7.0, 1e-12);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        EXPECT_EQ(model::triangle_normal(mesh, t), Vec3(0, 0, 1));
    EXPECT_EQ(mesh.source_faces, std::vector<std::uint32_t>(6, 0));
}

TEST_F(ReadObjTest, coordinates_are_the_nearest_doubles) {
    const ImportedMeshes meshes = read("v 1000000.1234567 0.1 -1e-7\nv +1 0 0\nv 0 1 0\nf -3 -2 -1\n");
    EXPECT_EQ(meshes.objects.at(0).mesh.points.at(0), Vec3(1000000.1234567, 0.1, -1e-7));
}

TEST_F(ReadObjTest, groups_and_objects_become_objects_and_groups_of_one_name_are_joined) {
    const ImportedMeshes meshes =
        read("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\no house\ng wall\nf 1 2 3\ng door frame\n"
             "f 2 4 3\ng wall\nf 1 3 4\n");
    ASSERT_EQ(meshes.objects.size(), 2U);
    EXPECT_EQ(meshes.objects[0].name, "wall");
    EXPECT_EQ(meshes.objects[0].mesh.triangles.size(), 2U);
    EXPECT_EQ(meshes.objects[0].mesh.source_faces, (std::vector<std::uint32_t>{0, 2}));
    EXPECT_EQ(meshes.objects[1].name, "door frame");
    const auto& names = meshes.groups[1];
    for (const char* name : {"door", "frame", "house"})
        EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
}

TEST_F(ReadObjTest, material_colours_survive_and_white_is_lowered_with_a_note) {
    write("my lamp.mtl", "newmtl lamp\nKd 1 0.5 0.25\nKe 12 10 8\n");
    const std::string text = "mtllib my lamp.mtl\nusemtl lamp\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const ImportedMeshes meshes = read(text);
    ASSERT_EQ(meshes.materials.size(), 1U);
    EXPECT_EQ(meshes.materials[0].reflectance, (std::vector<double>{0.95, 0.5, 0.25}));
    EXPECT_EQ(meshes.materials[0].exitance, (std::vector<double>{12, 10, 8}));
    ASSERT_EQ(meshes.notes.size(), 1U);
    EXPECT_NE(meshes.notes[0].find("lamp"), std::string::npos);
    EXPECT_EQ(read(text, 1).materials[0].exitance, std::vector<double>{10});
}

TEST_F(ReadObjTest, missing_material_file_is_a_note_and_its_names_survive_as_grey) {
    const ImportedMeshes meshes =
        read("mtllib no.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl brick\nf 1 2 3\nusemtl tile\nf 3 2 1\n");
    ASSERT_EQ(meshes.materials.size(), 2U);
    EXPECT_EQ(meshes.materials[0].name, "brick");
    EXPECT_EQ(meshes.materials[1].name, "tile");
    EXPECT_EQ(meshes.materials[0].reflectance, std::vector<double>(3, 0.5));
    EXPECT_EQ(meshes.notes.size(), 2U);
}

TEST_F(ReadObjTest, material_file_outside_the_folder_is_refused) {
    std::filesystem::create_directory(folder.path() / "inner");
    write("secret.mtl", "newmtl a\nKd 1 1 1\n");
    const auto file = write("inner/mesh.obj", "mtllib ../secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_THROW(read_mesh(file, 3), core::FileError);
    write("inner/mesh.obj", "mtllib link.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    std::filesystem::create_symlink("../secret.mtl", folder.path() / "inner/link.mtl");
    EXPECT_THROW(read_mesh(file, 3), core::FileError);
}

TEST_F(ReadObjTest, bad_vertices_and_indices_name_file_and_line) {
    EXPECT_NE(message_of("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n").find("mesh.obj:2:"), std::string::npos);
    EXPECT_NE(message_of("v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n").find("mesh.obj:2:"), std::string::npos);
    EXPECT_NE(message_of("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n").find("mesh.obj:2:"), std::string::npos);
    EXPECT_NE(message_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n").find("mesh.obj:5:"),
              std::string::npos);
    EXPECT_NE(message_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n").find("mesh.obj:4:"), std::string::npos);
    EXPECT_NE(message_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n").find("mesh.obj:4:"), std::string::npos);
}

TEST_F(ReadObjTest, vertex_that_is_not_a_number_is_a_geometry_error) {
    EXPECT_THROW(read("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), core::GeometryError);
    EXPECT_THROW(read("v 0 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n"), core::GeometryError);
}

TEST_F(ReadObjTest, file_without_faces_is_a_geometry_error) {
    EXPECT_THROW(read("v 0 0 0\nv 1 0 0\nv 0 1 0\n"), core::GeometryError);
    EXPECT_THROW(read("v 0 0 0\nv 1 0 0\nl 1 2\nf 1 2\n"), core::GeometryError);
    EXPECT_THROW(read("# nothing\n"), core::GeometryError);
    EXPECT_THROW(read(""), core::FileError);
}

TEST_F(ReadObjTest, file_cut_off_at_any_length_ends_in_an_error_or_a_valid_mesh) {
    write("lamp.mtl", "newmtl lamp\nKd 0.5 0.5 0.5\n");
    const std::string whole =
        "mtllib lamp.mtl\no box\nv 0 0 0\nv 1.5 0 0\nv 1.5 1e0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\n"
        "g top\nusemtl lamp\ns 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\ng bottom\nf -1//1 -2//1 -3//1\n";
    for (std::size_t length = 0; length <= whole.size(); ++length) {
        try {
            const ImportedMeshes meshes = read(whole.substr(0, length));
            for (const model::Object& object : meshes.objects) model::check(object.mesh, object.name);
        } catch (const core::FileError&) {
        } catch (const core::GeometryError&) {
        }
    }
    EXPECT_EQ(read(whole).objects.size(), 2U);
}

} // namespace
} // namespace kinelux::io
