// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_mesh.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/temporary_folder.h"

namespace kinelux::io {
namespace {

using support::put_bytes;

const char* const triangle_ply =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
    "end_header\n0 0 0\n2 0 0\n0 2 0\n3 0 1 2\n";

TEST(ReadMeshTest, missing_file_folder_and_unknown_format_are_file_errors) {
    const support::TemporaryFolder folder;
    EXPECT_THROW(read_mesh(folder.path() / "no.obj", 3), core::FileError);
    EXPECT_THROW(read_mesh(folder.path(), 3), core::FileError);
    put_bytes(folder.path() / "text.xyzzy", "nothing that a mesh is made of");
    EXPECT_THROW(read_mesh(folder.path() / "text.xyzzy", 3), core::FileError);
    put_bytes(folder.path() / "text.stl", "nothing that a mesh is made of");
    EXPECT_THROW(read_mesh(folder.path() / "text.stl", 3), core::Error);
}

TEST(ReadMeshTest, content_decides_where_the_extension_lies) {
    const support::TemporaryFolder folder;
    for (const char* name : {"mesh.ply", "mesh.obj", "mesh.stl", "mesh"}) {
        put_bytes(folder.path() / name, triangle_ply);
        EXPECT_NEAR(model::area(read_mesh(folder.path() / name, 3).objects.at(0).mesh), 2.0, 1e-12) << name;
    }
    put_bytes(folder.path() / "noextension", "# mesh\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(read_mesh(folder.path() / "noextension", 3).objects.size(), 1U);
}

TEST(ReadMeshTest, any_number_of_channels_but_three_gets_the_mean_of_rgb) {
    const support::TemporaryFolder folder;
    put_bytes(folder.path() / "a.mtl", "newmtl a\nKd 0.1 0.2 0.6\n");
    put_bytes(folder.path() / "a.obj", "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (const std::size_t channels : {1U, 2U, 5U}) {
        const std::vector<double> rho =
            read_mesh(folder.path() / "a.obj", channels).materials.at(0).reflectance;
        ASSERT_EQ(rho.size(), channels);
        for (const double value : rho) EXPECT_NEAR(value, 0.3, 1e-15);
    }
}

TEST(ReadMeshTest, counts_larger_than_the_file_are_file_errors) {
    const support::TemporaryFolder folder;
    put_bytes(folder.path() / "a.off", "OFF\n353535235358 6 0\n0 0 0\n");
    EXPECT_THROW(read_mesh(folder.path() / "a.off", 3), core::FileError);
    put_bytes(folder.path() / "a.ply",
              "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n");
    EXPECT_THROW(read_mesh(folder.path() / "a.ply", 3), core::FileError);
}

TEST(ReadMeshTest, concave_polygon_read_by_assimp_has_the_right_area) {
    const support::TemporaryFolder folder;
    put_bytes(folder.path() / "u.off", "OFF\n8 1 0\n0 0 0\n3 0 0\n3 3 0\n2 3 0\n2 1 0\n1 1 0\n1 3 0\n0 3 0\n"
                                       "8 0 1 2 3 4 5 6 7\n");
    EXPECT_NEAR(model::area(read_mesh(folder.path() / "u.off", 3).objects.at(0).mesh), 7.0, 1e-6);
}

struct Sample {
    const char* file;
    std::size_t least_faces;
};

class AssimpModelsTest : public testing::TestWithParam<Sample> {};

// Debian's package assimp-testmodels.
TEST_P(AssimpModelsTest, sample_file_is_read_with_finite_faces_of_some_area) {
    const std::filesystem::path file = std::filesystem::path("/usr/share/assimp/models") / GetParam().file;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "assimp-testmodels is not installed";
    const ImportedMeshes meshes = read_mesh(file, 3);
    std::size_t faces = 0;
    double area = 0.0;
    for (const model::Object& object : meshes.objects) {
        faces += object.mesh.triangles.size();
        area += model::area(object.mesh);
        for (const MaterialId material : object.mesh.materials)
            ASSERT_LT(material.value, meshes.materials.size());
    }
    EXPECT_GE(faces, GetParam().least_faces);
    EXPECT_GT(area, 0.0);
    EXPECT_EQ(meshes.groups.size(), meshes.objects.size());
}

INSTANTIATE_TEST_SUITE_P(EachFormat, AssimpModelsTest,
                         testing::Values(Sample{"OBJ/spider.obj", 1000}, Sample{"OBJ/box.obj", 12},
                                         Sample{"PLY/cube.ply", 12}, Sample{"STL/Spider_ascii.stl", 1000},
                                         Sample{"STL/Spider_binary.stl", 1000},
                                         Sample{"3DS/cubes_with_alpha.3DS", 12}, Sample{"OFF/Cube.off", 12},
                                         Sample{"Collada/duck.dae", 1000},
                                         Sample{"glTF2/BoxTextured-glTF-Binary/BoxTextured.glb", 12},
                                         Sample{"glTF2/BoxTextured-glTF/BoxTextured.gltf", 12}));

} // namespace
} // namespace kinelux::io
