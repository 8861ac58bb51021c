// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"
#include "geometry/pose.h"
#include "io/gltf_writer.h"
#include "io/temporary_folder.h"

namespace kinelux::io {
namespace {

using support::GltfWriter;
using support::put_bytes;

class ReadGltfTest : public testing::Test {
protected:
    // A triangle in the xy plane as mesh 0 of every file.
    ReadGltfTest() { positions = writer.add({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"); }

    std::string meshes(const std::string& more = "") const {
        return "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
               "\"POSITION\":" +
               std::to_string(positions) + "}" + more + "}]}]";
    }
    ImportedMeshes read(const std::string& rest) const {
        const auto file = folder.path() / "scene.glb";
        put_bytes(file, writer.glb(rest));
        return read_mesh(file, 3);
    }
    static void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-6) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
    }

    support::TemporaryFolder folder;
    GltfWriter writer;
    int positions = 0;
};

TEST_F(ReadGltfTest, node_transforms_apply_and_a_mirrored_face_keeps_its_front) {
    const ImportedMeshes read_back =
        read(meshes() + R"(,"nodes":[{"name":"room","translation":[10,0,0],"children":[1,2]},
        {"name":"plain","mesh":0,"rotation":[0,0,0.70710678118654752,0.70710678118654752],"scale":[2,2,2]},
        {"name":"mirrored","mesh":0,"scale":[-1,1,1]}])");
    ASSERT_EQ(read_back.objects.size(), 2U);
    const model::Mesh& plain = read_back.objects[0].mesh;
    expect_near(plain.points[1], {10, 2, 0});
    expect_near(plain.points[2], {8, 0, 0});
    // Mirroring turns the corners round; the front follows the surface as it was modelled.
    expect_near(model::triangle_normal(read_back.objects[1].mesh, 0), {0, 0, 1});
    EXPECT_EQ(read_back.up, Vec3(0, 1, 0));
    EXPECT_TRUE(read_back.unit_stated);
    EXPECT_NE(std::find(read_back.groups[1].begin(), read_back.groups[1].end(), "room"),
              read_back.groups[1].end());
}

TEST_F(ReadGltfTest, emissive_strength_multiplies_the_emissive_factor) {
    const ImportedMeshes read_back =
        read(meshes(",\"material\":0") + R"(,"nodes":[{"mesh":0}],"materials":[{"name":"lamp",
        "doubleSided":true,"emissiveFactor":[1,0.5,0],"pbrMetallicRoughness":{"baseColorFactor":[0.2,1,0.4,1]},
        "extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":40}}}])");
    ASSERT_EQ(read_back.materials.size(), 1U);
    EXPECT_EQ(read_back.materials[0].exitance, (std::vector<double>{40, 20, 0}));
    EXPECT_EQ(read_back.materials[0].reflectance, (std::vector<double>{0.2, 0.95, 0.4}));
    EXPECT_EQ(read_back.materials[0].sides, model::Sides::Both);
    EXPECT_EQ(read_back.notes.size(), 1U);
}

TEST_F(ReadGltfTest, material_of_a_bare_face_is_grey_with_a_note_and_lights_are_noted) {
    const ImportedMeshes read_back = read(meshes() + R"(,"nodes":[{"mesh":0}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","name":"bulb","intensity":5,"color":[1,1,1]}]}})");
    EXPECT_EQ(read_back.materials.at(0).reflectance, std::vector<double>(3, 0.5));
    ASSERT_EQ(read_back.notes.size(), 2U);
    EXPECT_NE(read_back.notes[0].find("bulb"), std::string::npos);
}

TEST_F(ReadGltfTest, linear_animation_moves_the_whole_subtree_about_the_nodes_origin) {
    const std::string times = std::to_string(writer.add({0, 2}, "SCALAR"));
    const float h = std::sqrt(0.5F);
    const std::string turn = std::to_string(writer.add({0, 0, 0, 1, 0, 0, h, h}, "VEC4"));
    const std::string shift = std::to_string(writer.add({1, 0, 0, 1, 0, 4}, "VEC3"));
    const ImportedMeshes read_back =
        read(meshes() + R"(,"nodes":[{"name":"world","translation":[0,5,0],"children":[1]},
        {"name":"door","translation":[1,0,0],"children":[2]},{"name":"leaf","mesh":0,"translation":[3,0,0]}],
        "animations":[{"samplers":[{"input":)" +
             times + R"(,"output":)" + turn + R"(},{"input":)" + times + R"(,"output":)" + shift +
             R"(}],"channels":[{"sampler":0,"target":{"node":1,"path":"rotation"}},
        {"sampler":1,"target":{"node":1,"path":"translation"}}]}])");
    ASSERT_EQ(read_back.motions.size(), 1U);
    const model::Motion& motion = read_back.motions[0];
    EXPECT_EQ(motion.name, "door");
    EXPECT_EQ(motion.interpolation, model::Interpolation::Linear);
    ASSERT_TRUE(read_back.objects.at(0).motion);
    const Vec3 corner = read_back.objects[0].mesh.points[0];
    expect_near(corner, {4, 5, 0});
    expect_near(geometry::pose_at(motion, 0.0).point(corner), {4, 5, 0});
    expect_near(geometry::pose_at(motion, 2.0).point(corner), {1, 8, 4});
    const double s = std::sqrt(0.5);
    expect_near(geometry::pose_at(motion, 1.0).point(corner), {1 + 3 * s, 5 + 3 * s, 2});
}

TEST_F(ReadGltfTest, moving_parent_and_child_follow_their_joint_path_between_the_keys) {
    const std::string times = std::to_string(writer.add({0, 1}, "SCALAR"));
    const float h = std::sqrt(0.5F);
    const std::string turn = std::to_string(writer.add({0, 0, 0, 1, 0, 0, h, h}, "VEC4"));
    const std::string target = R"(,"target":{"path":"rotation","node":)";
    const ImportedMeshes read_back = read(meshes() + R"(,"nodes":[{"name":"upper","children":[1]},
        {"name":"lower","mesh":0,"translation":[2,0,0]}],"animations":[{"samplers":[{"input":)" +
                                          times + R"(,"output":)" + turn + R"(}],"channels":[{"sampler":0)" +
                                          target + R"(0}},{"sampler":0)" + target + R"(1}}]}])");
    const model::Motion& motion = read_back.motions.at(0);
    const Vec3 tip = read_back.objects.at(0).mesh.points[1]; // 1 beyond the joint at (2, 0, 0)
    expect_near(tip, {3, 0, 0});
    const double s = std::sqrt(0.5);
    expect_near(geometry::pose_at(motion, 0.5).point(tip), {2 * s, 2 * s + 1, 0}, 1e-3);
    expect_near(geometry::pose_at(motion, 1.0).point(tip), {-1, 2, 0}, 1e-6);
}

TEST_F(ReadGltfTest, step_and_cubic_interpolation_survive_and_scale_channels_are_refused_with_a_note) {
    const std::string times = std::to_string(writer.add({0, 1}, "SCALAR"));
    const std::string shift = std::to_string(writer.add({0, 0, 0, 5, 0, 0}, "VEC3"));
    const std::string spline =
        std::to_string(writer.add({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0}, "VEC3"));
    const auto with = [&](const std::string& output, const std::string& mode) {
        return read(meshes() + R"(,"nodes":[{"name":"lift","mesh":0}],"animations":[{"samplers":[{"input":)" +
                    times + R"(,"output":)" + output + R"(,"interpolation":")" + mode + R"("},{"input":)" +
                    times + R"(,"output":)" + shift +
                    R"(}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},
                    {"sampler":1,"target":{"node":0,"path":"scale"}}]}])");
    };
    const ImportedMeshes step = with(shift, "STEP");
    EXPECT_EQ(step.motions.at(0).interpolation, model::Interpolation::Step);
    EXPECT_TRUE(std::any_of(step.notes.begin(), step.notes.end(),
                            [](const std::string& note) { return note.find("scale") != std::string::npos; }));
    const ImportedMeshes cubic = with(spline, "CUBICSPLINE");
    EXPECT_EQ(cubic.motions.at(0).interpolation, model::Interpolation::Cubic);
    EXPECT_EQ(cubic.motions[0].keyframes.at(1).translation, Vec3(5, 0, 0));
    EXPECT_TRUE(std::any_of(cubic.notes.begin(), cubic.notes.end(), [](const std::string& note) {
        return note.find("spline") != std::string::npos;
    }));
}

TEST_F(ReadGltfTest, bad_coordinates_indices_and_circles_are_errors) {
    EXPECT_THROW(read(meshes() + R"(,"nodes":[{"mesh":0,"children":[0]}])"), core::FileError);
    EXPECT_THROW(read(meshes() + R"(,"nodes":[{"mesh":7}])"), core::FileError);
    EXPECT_THROW(read(meshes(",\"material\":3") + R"(,"nodes":[{"mesh":0}])"), core::FileError);
    EXPECT_THROW(read(meshes() + R"(,"nodes":[{"name":"nothing"}])"), core::GeometryError);
    const std::string indices = std::to_string(writer.add(std::vector<std::uint32_t>{0, 1, 3}));
    EXPECT_THROW(read(meshes(",\"indices\":" + indices) + R"(,"nodes":[{"mesh":0}])"), core::GeometryError);
    positions = writer.add({0, 0, 0, 1, std::numeric_limits<float>::quiet_NaN(), 0, 0, 1, 0}, "VEC3");
    EXPECT_THROW(read(meshes() + R"(,"nodes":[{"mesh":0}])"), core::GeometryError);
}

TEST_F(ReadGltfTest, buffer_file_is_read_beside_the_json_and_refused_outside_its_folder) {
    std::filesystem::create_directory(folder.path() / "inner");
    put_bytes(folder.path() / "inner/data.bin", writer.bytes());
    put_bytes(folder.path() / "data.bin", writer.bytes());
    const auto file = folder.path() / "inner/scene.gltf";
    const std::string rest = meshes() + R"(,"nodes":[{"mesh":0}])";
    put_bytes(file, writer.json(rest, "data.bin"));
    EXPECT_EQ(read_mesh(file, 3).objects.size(), 1U);
    put_bytes(file, writer.json(rest, "../data.bin"));
    EXPECT_THROW(read_mesh(file, 3), core::FileError);
    put_bytes(file, writer.json(rest, "missing.bin"));
    EXPECT_THROW(read_mesh(file, 3), core::FileError);
}

TEST_F(ReadGltfTest, binary_file_cut_off_at_any_length_is_a_file_error) {
    const std::string whole = writer.glb(meshes() + R"(,"nodes":[{"name":"a","mesh":0}])");
    const auto file = folder.path() / "cut.glb";
    for (std::size_t length = 0; length < whole.size(); ++length) {
        put_bytes(file, whole.substr(0, length));
        EXPECT_THROW(read_mesh(file, 3), core::FileError) << length;
    }
    put_bytes(file, whole);
    EXPECT_EQ(read_mesh(file, 3).objects.size(), 1U);
}

TEST_F(ReadGltfTest, binary_file_with_any_byte_changed_ends_in_an_error_or_a_valid_mesh) {
    const std::string whole = writer.glb(meshes() + R"(,"nodes":[{"name":"a","mesh":0}])");
    const auto file = folder.path() / "changed.glb";
    for (std::size_t i = 0; i < whole.size(); ++i)
        for (const char flip : {'\x01', '\x10', '\x80'}) {
            std::string changed = whole;
            changed[i] = static_cast<char>(changed[i] ^ flip);
            put_bytes(file, changed);
            try {
                for (const model::Object& object : read_mesh(file, 3).objects)
                    model::check(object.mesh, "changed");
            } catch (const core::Error&) {
            }
        }
}

} // namespace
} // namespace kinelux::io
