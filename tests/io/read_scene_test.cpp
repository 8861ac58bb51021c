// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_scene.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/scene_schema.h"
#include "io/scene_text.h"
#include "io/temporary_folder.h"

namespace kinelux::io {
namespace {

using support::put_bytes;

constexpr double pi = 3.14159265358979323846;

// A scene file with every key there is.
const char* const everything = R"(
format = 1
[scene]
title = "Everything"
length_unit = "mm"
up_axis = "y"
quantity = "photometric"
channels = ["day", "night"]
[accuracy]
target = "2.5%"
degree = 2
element_size = 250
[time]
start_s = 1
end_s = 3.0
frames = 5
[[material]]
name = "paint"
reflectance = [0.5, 0.6]
exitance = 7
sides = "front"
[[material]]
name = "film"
reflectance = 0.1
two_sided = true
[[object]]
name = "table"
mesh = "room.obj"
group = "floor"
material = "paint"
exitance = [1, 2]
dimming = "evening"
motion = "turn"
scale = 1000
translation = [1000, 2000, 3000]
rotation_axis = [0, 0, 2]
rotation_deg = 90
two_sided = true
[[object]]
name = "curtain"
mesh = "room.obj"
group = "shelf"
material = "film"
motion = "path"
[[motion]]
name = "turn"
interpolation = "step"
pivot = [0, 0, 1000]
[[motion.keyframe]]
time_s = 0
translation = [0, 0, 500]
[[motion.keyframe]]
time_s = 2
rotation_axis = [0, 1, 0]
rotation_deg = 180
[[motion]]
name = "path"
parent = "turn"
interpolation = "cubic"
csv = "path.csv"
[[dimming]]
name = "evening"
interpolation = "linear"
[[dimming.keyframe]]
time_s = 1
factor = 0.5
[[meter]]
name = "desk"
origin = [0, 0, 700]
edge_u = [1000, 0, 0]
edge_v = [0, 500, 0]
count_u = 4
count_v = 2
[effects]
interreflection = false
static_occlusion = true
moving_occlusion = false
[view]
eye = [1000, 0, 0]
target = [0, 1000, 0]
up = [0, 0, 1]
field_of_view_deg = 30
[export]
cell_size = 50
frames = [0, 4]
)";

class ReadEverythingTest : public ReadSceneTest {
protected:
    model::Scene read_everything() const {
        put("path.csv", "time_s,x,y,z,axis_x,axis_y,axis_z,angle_deg\n# comment\n0,0,0,0,0,0,1,0\n"
                        "1.5, 100,0,0, 0,0,1,90\n");
        return read(everything);
    }
};

TEST_F(ReadEverythingTest, file_holds_every_key_of_the_schema_but_those_that_exclude_each_other) {
    const std::string table = scene_format_table();
    for (std::size_t at = table.find("\n| `"); at != std::string::npos; at = table.find("\n| `", at + 1)) {
        const std::string key = table.substr(at + 4, table.find('`', at + 4) - at - 4);
        if (key == "flux" || key == "gltf_node") continue; // instead of exitance, keyframes
        EXPECT_NE(std::string(everything).find("\n" + key + " ="), std::string::npos) << key;
    }
}

TEST_F(ReadEverythingTest, every_setting_reaches_the_scene_in_metres) {
    const model::Scene scene = read_everything();
    EXPECT_EQ(scene.title, "Everything");
    EXPECT_EQ(scene.up, Vec3(0, 1, 0));
    EXPECT_EQ(scene.quantity, model::Quantity::Photometric);
    EXPECT_EQ(scene.channels, (std::vector<std::string>{"day", "night"}));
    EXPECT_DOUBLE_EQ(scene.accuracy.target, 0.025);
    EXPECT_EQ(scene.accuracy.degree, 2);
    EXPECT_EQ(scene.accuracy.element_size, 0.25);
    EXPECT_EQ(scene.time.start_s, 1.0);
    EXPECT_EQ(scene.time.end_s, 3.0);
    EXPECT_EQ(scene.time.frames, 5U);
    EXPECT_EQ(scene.effects.interreflection, false);
    EXPECT_EQ(scene.effects.static_occlusion, true);
    EXPECT_EQ(scene.effects.moving_occlusion, false);
    EXPECT_EQ(scene.view.eye, Vec3(1, 0, 0));
    EXPECT_EQ(scene.view.target, Vec3(0, 1, 0));
    EXPECT_EQ(scene.view.up, Vec3(0, 0, 1));
    EXPECT_EQ(scene.view.field_of_view_deg, 30.0);
    EXPECT_EQ(scene.exported.cell_size, 0.05);
    EXPECT_EQ(scene.exported.frames, (std::vector<std::uint32_t>{0, 4}));
}

TEST_F(ReadEverythingTest, placement_material_and_sides_of_an_object_reach_the_scene) {
    const model::Scene scene = read_everything();
    const model::Object& table = scene.objects.at(0);
    expect_near(table.mesh.points.at(1), {1.0, 3.0, 3.0});
    const model::Material& paint = scene.materials.at(table.mesh.materials.at(0).value);
    EXPECT_EQ(paint.name, "paint (table)");
    EXPECT_EQ(paint.reflectance, (std::vector<double>{0.5, 0.6}));
    EXPECT_EQ(paint.exitance, (std::vector<double>{1, 2}));
    EXPECT_EQ(paint.sides, model::Sides::Both);
    EXPECT_EQ(scene.materials.at(0).exitance, (std::vector<double>{7, 7}));
    EXPECT_EQ(scene.materials.at(0).sides, model::Sides::Front);
    EXPECT_EQ(scene.materials.at(scene.objects.at(1).mesh.materials.at(0).value).sides, model::Sides::Both);
}

TEST_F(ReadEverythingTest, keyframes_and_csv_reach_the_motions_in_metres) {
    const model::Scene scene = read_everything();
    const model::Motion& turn = scene.motions.at(scene.objects.at(0).motion->value);
    EXPECT_EQ(turn.interpolation, model::Interpolation::Step);
    EXPECT_EQ(turn.pivot, Vec3(0, 0, 1));
    EXPECT_EQ(turn.keyframes.at(0).translation, Vec3(0, 0, 0.5));
    EXPECT_NEAR(std::abs(turn.keyframes.at(1).rotation.y), 1.0, 1e-12);
    const model::Motion& path = scene.motions.at(scene.objects[1].motion->value);
    EXPECT_EQ(path.interpolation, model::Interpolation::Cubic);
    EXPECT_EQ(path.keyframes.at(1).time_s, 1.5);
    EXPECT_EQ(path.keyframes.at(1).translation, Vec3(0.1, 0, 0));
    EXPECT_NEAR(path.keyframes.at(1).rotation.z, std::sin(pi / 4.0), 1e-12);
}

TEST_F(ReadEverythingTest, meters_reach_the_scene_in_metres) {
    const model::Scene scene = read_everything();
    const model::GridMeter& desk = scene.meters.at(0);
    EXPECT_EQ(desk.name, "desk");
    expect_near(desk.origin, {0, 0, 0.7});
    expect_near(desk.edge_u, {1, 0, 0});
    expect_near(desk.edge_v, {0, 0.5, 0});
    EXPECT_EQ(desk.count_u, 4U);
    EXPECT_EQ(desk.count_v, 2U);
}

TEST_F(ReadSceneTest, absent_keys_leave_the_documented_defaults) {
    const model::Scene scene = read(head + "[[object]]\nname = \"all\"\nmesh = \"room.obj\"\n");
    EXPECT_EQ(scene.title, "scene");
    EXPECT_EQ(scene.channels.size(), 3U);
    EXPECT_EQ(scene.up, Vec3(0, 0, 1));
    EXPECT_EQ(scene.accuracy.target, 0.03);
    EXPECT_EQ(scene.time.frames, 1U);
    EXPECT_FALSE(scene.effects.interreflection || scene.exported.cell_size || scene.view.eye);
    ASSERT_EQ(scene.objects.size(), 1U);
    EXPECT_EQ(scene.objects[0].mesh.triangles.size(), 8U);
    ASSERT_EQ(scene.materials.size(), 2U);
    EXPECT_EQ(scene.materials[0].name, "wood");
    EXPECT_EQ(scene.materials[0].exitance, (std::vector<double>{1, 2, 3}));
}

TEST_F(ReadSceneTest, material_of_the_scene_file_replaces_the_one_of_that_name_in_the_mesh_file) {
    const model::Scene scene =
        read(head + "[[material]]\nname = \"wood\"\nreflectance = 0.8\n" + floor_object);
    ASSERT_EQ(scene.materials.size(), 1U);
    EXPECT_EQ(scene.materials[0].reflectance, std::vector<double>(3, 0.8));
    EXPECT_FALSE(scene.materials[0].emits());
}

TEST_F(ReadSceneTest, flux_is_divided_by_the_area_that_emits) {
    const auto exitance = [&](const std::string& keys) {
        const model::Scene scene =
            read(head + "[[object]]\nname = \"lamp\"\nmesh = \"room.obj\"\nflux = 12\n" + keys);
        return scene.materials[scene.objects[0].mesh.materials[0].value].exitance;
    };
    for (const double m : exitance("group = \"floor\"\nscale = 2\nsides = \"front\"\n"))
        EXPECT_NEAR(m, 3.0, 1e-12);
    for (const double m : exitance("group = \"floor\"\nscale = 2\n")) EXPECT_NEAR(m, 1.5, 1e-12);
    const double outside = 1.0 + std::sqrt(2.0); // of the tetrahedron; its inside does not emit
    for (const double m : exitance("group = \"block\"\n")) EXPECT_NEAR(m, 12.0 / outside, 1e-12);
}

TEST_F(ReadSceneTest, unknown_keys_name_file_line_and_the_nearest_known_key) {
    EXPECT_EQ(message_of(head + "[scene]\nlenght_unit = \"mm\"\n"),
              "scene.toml:3: unknown key 'lenght_unit' in [scene]; did you mean 'length_unit'?");
    EXPECT_EQ(message_of(head + floor_object + "matrial = \"wood\"\n"),
              "scene.toml:6: unknown key 'matrial' in [object]; did you mean 'material'?");
    EXPECT_EQ(message_of(head + "[acuracy]\n"),
              "scene.toml:2: unknown key 'acuracy' in the top of the file; did you "
              "mean 'accuracy'?");
    EXPECT_EQ(message_of(head + "[[motion]]\nname = \"m\"\n[[motion.keyframe]]\ntime_s = 0\nrotation = 3\n")
                  .substr(0, 63),
              "scene.toml:6: unknown key 'rotation' in [motion.keyframe]; did ");
}

TEST_F(ReadSceneTest, wrong_values_name_file_and_line) {
    const auto starts = [&](const std::string& text, const std::string& start) {
        const std::string message = message_of(text);
        EXPECT_EQ(message.substr(0, start.size()), start) << message;
    };
    starts("", "scene.toml:1: expected 'format = 1'");
    starts("format = 2\n[future]\n", "scene.toml:1: the file is of format 2");
    starts("format = 1\n[scene\n", "scene.toml:2: ");
    starts(head + "[scene]\nlength_unit = \"furlong\"\n",
           "scene.toml:3: 'length_unit': \"furlong\" is none of");
    starts(head + "[accuracy]\ntarget = 3\n", "scene.toml:3: 'target': 3 is not in (0, 1)");
    starts(head + "[accuracy]\ntarget = \"300%\"\n", "scene.toml:3: 'target': expected");
    starts(head + "[accuracy]\ndegree = 1.5\n", "scene.toml:3: 'degree': expected whole number");
    starts(head + "[accuracy]\nelement_size = nan\n", "scene.toml:3: 'element_size': nan is not");
    starts(head + "[time]\nframes = 0\n", "scene.toml:3: 'frames': 0 is not");
    starts(head + "[time]\nstart_s = 2\nend_s = 1\n" + floor_object, "scene.toml:4: end_s is before start_s");
    starts(head + "[[material]]\nname = \"a\"\nreflectance = 1.0\n",
           "scene.toml:4: 'reflectance': 1 is not in [0, 1)");
    starts(head + "[[material]]\nname = \"a\"\n", "scene.toml:2: [[material]] lacks the key 'reflectance'");
    starts(head + "[[material]]\nname = \"a\"\nreflectance = [0.5, 0.5]\n" + floor_object,
           "scene.toml:4: 'reflectance': 2 values, but the scene has 3 channels");
    starts(head + "[material]\nname = \"a\"\n",
           "scene.toml:2: there may be several of these; write [[material]]");
    starts(head + "[[scene]]\n", "scene.toml:2: 'scene' is a section; write [scene]");
    starts(head + floor_object + "translation = [1, 2]\n", "scene.toml:6: 'translation': expected [x, y, z]");
    starts(head + floor_object + "rotation_deg = 5\n", "scene.toml:6: 'rotation_deg' needs 'rotation_axis'");
    starts(head + floor_object + "exitance = 5\nflux = 3\n", "scene.toml:7: give either");
    starts(head + floor_object + floor_object, "scene.toml:7: there are two objects 'floor'");
    starts(head, "scene.toml:1: the scene has no [[object]]");
    starts(head + "[export]\nframes = [1]\n" + floor_object, "scene.toml:3: frame 1 does not exist");
}

TEST_F(ReadSceneTest, unknown_names_are_errors_that_list_what_exists) {
    const std::string object = "[[object]]\nname = \"o\"\nmesh = \"room.obj\"\n";
    EXPECT_EQ(
        message_of(head + object + "group = \"flor\"\n"),
        "scene.toml:5: 'room.obj' has no group 'flor'; it has: floor, shelf, block; did you mean 'floor'?");
    EXPECT_EQ(message_of(head + object + "material = \"steel\"\n"),
              "scene.toml:5: there is no material 'steel' here or in 'room.obj'; there are: wood, glass");
    EXPECT_EQ(message_of(head + object + "motion = \"spin\"\n"),
              "scene.toml:5: there is no motion 'spin'; there are: none");
    EXPECT_EQ(message_of(head + object + "[[motion]]\nname = \"spin\"\n[[motion.keyframe]]\ntime_s = 0\n"),
              "scene.toml:5: motion 'spin' moves no object; write motion = \"spin\" in one of: o");
}

TEST_F(ReadSceneTest, files_outside_the_folder_are_refused_unless_allowed) {
    const support::TemporaryFolder other;
    put_bytes(other.path() / "mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    std::filesystem::create_symlink(other.path() / "mesh.obj", folder.path() / "link.obj");
    for (const std::string& mesh : {(other.path() / "mesh.obj").string(), std::string("link.obj")}) {
        std::string text = head;
        text.append("[[object]]\nname = \"o\"\nmesh = \"").append(mesh).append("\"\n");
        EXPECT_THROW(read(text), core::FileError) << mesh;
        EXPECT_EQ(read(text, true).objects.size(), 1U) << mesh;
    }
}

TEST_F(ReadSceneTest, missing_mesh_and_mesh_without_faces_name_the_line_of_the_scene_file) {
    EXPECT_EQ(message_of(head + "[[object]]\nname = \"o\"\nmesh = \"no.obj\"\n"),
              "scene.toml:4: no.obj: there is no such file");
    put("none.obj", "v 0 0 0\n");
    EXPECT_EQ(message_of(head + "[[object]]\nname = \"o\"\nmesh = \"none.obj\"\n"),
              "scene.toml:4: none.obj: holds no faces");
    EXPECT_THROW(read_scene(folder.path() / "no.toml", {}), core::FileError);
}

TEST_F(ReadSceneTest, scene_file_cut_off_at_any_length_ends_in_an_error_or_a_valid_scene) {
    const std::string whole =
        head +
        "[scene]\nlength_unit = \"mm\"\n[[material]]\nname = \"wood\"\nreflectance = [0.1, 0.2, "
        "0.3]\n" +
        floor_object +
        "motion = \"m\"\n[[motion]]\nname = \"m\"\n[[motion.keyframe]]\n"
        "time_s = 0.5\ntranslation = [0, 0, 1e1]\n";
    for (std::size_t length = 0; length <= whole.size(); ++length) {
        try {
            model::check(read(whole.substr(0, length)));
        } catch (const core::Error&) {
        }
    }
    EXPECT_NO_THROW(read(whole));
}

TEST_F(ReadSceneTest, mesh_is_turned_only_where_its_stated_up_axis_differs) {
    const model::Scene scene =
        read(head + "[scene]\nup_axis = \"y\"\n" + floor_object +
             "up_axis = \"z\"\n"
             "[[object]]\nname = \"as it is\"\nmesh = \"room.obj\"\ngroup = \"floor\"\n");
    expect_near(model::triangle_normal(scene.objects.at(0).mesh, 0), {0, 1, 0});
    expect_near(model::triangle_normal(scene.objects.at(1).mesh, 0), {0, 0, 1});
}

TEST_F(ReadSceneTest, bare_mesh_file_becomes_one_object_per_group_in_metres) {
    const model::Scene scene = read_scene(folder.path() / "room.obj", {});
    ASSERT_EQ(scene.objects.size(), 3U);
    EXPECT_EQ(scene.objects[0].name, "floor");
    EXPECT_TRUE(scene.materials.at(0).emits());
    EXPECT_EQ(scene.time.frames, 1U);
}

TEST(SceneFormatTest, documentation_holds_the_table_that_the_program_prints) {
    const std::string page = support::bytes_of(KINELUX_SOURCE_DIR "/docs/scene-format.md");
    EXPECT_NE(page.find(scene_format_table()), std::string::npos)
        << "docs/scene-format.md is out of date; it needs:\n"
        << scene_format_table();
}

TEST(SceneFormatTest, worked_example_of_the_documentation_follows_the_schema) {
    const std::string page = support::bytes_of(KINELUX_SOURCE_DIR "/docs/scene-format.md");
    const std::size_t begin = page.find("```toml\n");
    ASSERT_NE(begin, std::string::npos);
    const std::string example = page.substr(begin + 8, page.find("```", begin + 8) - begin - 8);
    EXPECT_EQ(parse_scene_document(example, "example.toml").all("object").size(), 3U);
}

TEST(SceneFormatTest, scenes_that_come_with_the_program_are_read) {
    const std::filesystem::path scenes = KINELUX_SOURCE_DIR "/data/scenes";
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes))
        if (entry.path().extension() == ".toml") {
            EXPECT_NO_THROW(read_scene(entry.path(), {.allow_outside = true})) << entry.path();
            ++count;
        }
    EXPECT_GT(count, 0U);
}

TEST(NearestTest, suggestions_are_near_or_absent) {
    EXPECT_EQ(nearest("reflectence", {"name", "reflectance"}), "reflectance");
    EXPECT_EQ(nearest("zzz", {"name", "reflectance"}), std::nullopt);
}

} // namespace
} // namespace kinelux::io
