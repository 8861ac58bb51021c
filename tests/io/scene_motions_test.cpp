// SPDX-License-Identifier: GPL-3.0-or-later
// What scene files say about time: motions, their parents and tables, dimmings, meters that move.
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/pose.h"
#include "io/gltf_writer.h"
#include "io/scene_text.h"

namespace kinelux::io {
namespace {

constexpr double pi = 3.14159265358979323846;

TEST_F(ReadSceneTest, motions_need_one_source_and_increasing_times) {
    const std::string object = floor_object + "motion = \"m\"\n[[motion]]\nname = \"m\"\n";
    EXPECT_EQ(message_of(head + object),
              "scene.toml:7: motion 'm' needs one of: [[motion.keyframe]], 'csv', 'gltf_node'");
    EXPECT_EQ(
        message_of(head + object + "[[motion.keyframe]]\ntime_s = 1\n[[motion.keyframe]]\ntime_s = 1\n"),
        "scene.toml:12: keyframes must be in the order of increasing time_s");
    put("m.csv", "time_s,x,y,z\n0,0,0,0\n1,0,zero,0\n");
    EXPECT_EQ(message_of(head + object + "csv = \"m.csv\"\n"),
              "scene.toml:9: m.csv:3: 'zero' is not a number");
    EXPECT_EQ(message_of(head + object + "csv = \"n.csv\"\n"), "scene.toml:9: n.csv: there is no such file");
    EXPECT_EQ(message_of(head + object + "gltf_node = \"a\"\n"),
              "scene.toml:9: 'room.obj' of object 'floor' has no animated node 'a'; animated are: none");
}

TEST_F(ReadSceneTest, a_motion_rides_on_its_parent_whatever_their_order_in_the_file) {
    const model::Scene scene = read(head + floor_object + R"(motion = "lamp"
[[motion]]
name = "lamp"
parent = "arm"
pivot = [1, 0, 0]
keyframe = [{time_s = 0}, {time_s = 1, rotation_axis = [0, 0, 1], rotation_deg = 90}]
[[motion]]
name = "arm"
keyframe = [{time_s = 0}, {time_s = 1, translation = [0, 0, 2]}]
)");
    ASSERT_EQ(scene.motions.size(), 2U);
    EXPECT_EQ(scene.motions[0].parent, MotionId(1));
    EXPECT_FALSE(scene.motions[1].parent);
    expect_near(geometry::object_poses(scene, 1.0).at(0).point({2, 0, 0}), {1, 1, 2});
}

TEST_F(ReadSceneTest, parents_that_are_unknown_or_carry_themselves_are_errors_with_their_line) {
    const std::string moved = head + floor_object + "motion = \"a\"\n"; // lines 1 to 6
    const auto motion = [](const std::string& name, const std::string& parent) {
        return "[[motion]]\nname = \"" + name + "\"\nparent = \"" + parent +
               "\"\nkeyframe = [{time_s = 0}]\n";
    };
    EXPECT_EQ(message_of(moved + motion("a", "an arm")),
              "scene.toml:9: there is no motion 'an arm'; there are: a");
    EXPECT_EQ(message_of(moved + motion("a", "a")), "scene.toml:9: motion 'a' is carried by 'a', which it "
                                                    "carries itself; take 'parent' from one of them");
    EXPECT_EQ(message_of(moved + motion("a", "b") + motion("b", "a")),
              "scene.toml:13: motion 'b' is carried by 'a', which it carries itself; take 'parent' from one "
              "of them");
    EXPECT_EQ(message_of(moved + "[[motion]]\nname = \"a\"\nkeyframe = [{time_s = 0}]\n" + motion("b", "a")),
              "scene.toml:10: motion 'b' moves no object; write motion = \"b\" in one of: floor")
        << "a motion that only rides and moves nothing is as unused as one alone";
}

TEST_F(ReadSceneTest, turns_about_one_axis_go_as_far_as_their_angles_say) {
    put("spin.csv", "time_s,x,y,z,axis_x,axis_y,axis_z,angle_deg\n0,0,0,0,0,0,1,90\n1,0,0,0,0,0,-1,270\n");
    const model::Scene scene = read(head + floor_object + R"(motion = "key"
[[object]]
name = "shelf"
mesh = "room.obj"
group = "shelf"
motion = "csv"
[[motion]]
name = "csv"
csv = "spin.csv"
[[motion]]
name = "key"
[[motion.keyframe]]
time_s = 0
[[motion.keyframe]]
time_s = 1
rotation_axis = [0, 0, 2]
rotation_deg = 720
[[motion.keyframe]]
time_s = 2
rotation_axis = [0, 0, 1]
rotation_deg = 700
[[motion.keyframe]]
time_s = 3
rotation_axis = [1, 0, 0]
rotation_deg = 720
)");
    const auto angle = [&](std::size_t object, double t) {
        const Vec3 x = geometry::object_poses(scene, t).at(object).direction({1, 0, 0});
        return std::atan2(x.y, x.x) * 180.0 / pi;
    };
    EXPECT_NEAR(angle(0, 0.1), 72.0, 1e-10);
    EXPECT_NEAR(angle(0, 0.6), 72.0, 1e-10) << "432 degrees";
    EXPECT_NEAR(angle(0, 1.5), -10.0, 1e-10) << "20 degrees back";
    EXPECT_NEAR(angle(0, 2.5), -10.0, 1e-10) << "about another axis: the shortest way, 20 degrees";
    EXPECT_NEAR(angle(1, 0.25), 0.0, 1e-10) << "360 degrees backwards from 90";
    EXPECT_NEAR(angle(1, 0.75), 180.0, 1e-10);
}

const std::string lamp_object =
    "[[object]]\nname = \"lamp\"\nmesh = \"room.obj\"\ngroup = \"shelf\"\nexitance = 4\n";

TEST_F(ReadSceneTest, dimmings_reach_the_materials_of_the_objects_and_materials_that_name_them) {
    put("cue.csv", "time_s,factor\n0,1\n2,0.5\n");
    const model::Scene scene = read(head + R"([[dimming]]
name = "cue"
csv = "cue.csv"
[[dimming]]
name = "switch"
interpolation = "step"
keyframe = [{time_s = 0, factor = 0}, {time_s = 1, factor = 1}]
[[material]]
name = "wood"
reflectance = 0.5
exitance = 2
dimming = "switch"
)" + floor_object + lamp_object + "dimming = \"cue\"\n");
    const auto exitance = [&](std::size_t object, double t) {
        const MaterialId material = scene.objects.at(object).mesh.materials.at(0);
        return model::exitances_at(scene, t).at(material.value).at(0);
    };
    EXPECT_EQ(exitance(0, 0.5), 0.0);
    EXPECT_EQ(exitance(0, 1.0), 2.0);
    EXPECT_EQ(exitance(1, 0.0), 4.0);
    EXPECT_EQ(exitance(1, 1.0), 3.0);
    EXPECT_EQ(exitance(1, 9.0), 2.0);
}

TEST_F(ReadSceneTest, dimmings_that_cannot_be_are_errors_with_their_line) {
    const std::string dimming = "[[dimming]]\nname = \"d\"\n"; // from line 2 on
    const std::string key = "keyframe = [{time_s = 0, factor = 1}]\n";
    const std::string follows = "dimming = \"d\"\n";
    EXPECT_EQ(message_of(head + dimming + lamp_object + follows),
              "scene.toml:2: dimming 'd' needs one of: [[dimming.keyframe]], 'csv'");
    EXPECT_EQ(message_of(head + dimming + key + lamp_object),
              "scene.toml:2: dimming 'd' dims no lamp; write dimming = \"d\" in an [[object]] or "
              "[[material]] that emits");
    EXPECT_EQ(message_of(head + dimming + key + lamp_object + "dimming = \"b\"\n"),
              "scene.toml:10: there is no dimming 'b'; there are: d");
    EXPECT_EQ(message_of(head + dimming + "keyframe = [{time_s = 0, factor = -1}]\n" + lamp_object + follows),
              "scene.toml:4: 'factor': -1 is not >= 0");
    EXPECT_EQ(message_of(head + dimming +
                         "keyframe = [{time_s = 1, factor = 1}, {time_s = 0, factor = 1}]\n" + lamp_object +
                         follows),
              "scene.toml:4: keyframes must be in the order of increasing time_s");
    EXPECT_EQ(message_of(head + dimming + key +
                         "[[object]]\nname = \"o\"\nmesh = \"room.obj\"\ngroup = \"shelf\"\n" + follows),
              "scene.toml:9: object 'o' emits no light that could be dimmed");
    put("d.csv", "time_s,factor\n0,-1\n");
    EXPECT_EQ(message_of(head + dimming + "csv = \"d.csv\"\n" + lamp_object + follows),
              "scene.toml:4: d.csv:2: the factor is below 0");
}

TEST_F(ReadSceneTest, a_meter_follows_a_motion_that_need_not_move_an_object) {
    const std::string meter =
        "[[meter]]\nname = \"m\"\norigin = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\n";
    const std::string motion = "[[motion]]\nname = \"carriage\"\nkeyframe = [{time_s = 0}]\n";
    const model::Scene scene = read(head + floor_object + motion + meter + "motion = \"carriage\"\n");
    EXPECT_EQ(scene.meters.at(0).motion, MotionId(0));
    EXPECT_EQ(message_of(head + floor_object + motion + meter + "motion = \"carrige\"\n"),
              "scene.toml:14: there is no motion 'carrige'; there are: carriage; did you mean 'carriage'?");
}

// A glTF file (metres, y up) with a square whose node glides along its own y and turns about it.
class ReadSceneGltfTest : public ReadSceneTest {
protected:
    ReadSceneGltfTest() {
        support::GltfWriter writer;
        writer.add({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
        writer.add({0.5F, 1.5F}, "SCALAR");
        writer.add({2, 0, 0, 2, 3, 0}, "VEC3");
        const float h = std::sqrt(0.5F);
        writer.add({0, 0, 0, 1, 0, h, 0, h}, "VEC4");
        put("lift.glb",
            writer.glb(R"("scenes":[{"nodes":[0]}],"nodes":[{"name":"lift","mesh":0,"translation":[2,0,0]}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"animations":[{"samplers":[{"input":1,"output":2},
            {"input":1,"output":3}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},
            {"sampler":1,"target":{"node":0,"path":"rotation"}}]}])"));
    }
};

TEST_F(ReadSceneGltfTest, bare_file_brings_its_own_animation_unit_and_up_axis) {
    const model::Scene scene = read_scene(folder.path() / "lift.glb", {});
    EXPECT_EQ(scene.up, Vec3(0, 1, 0));
    EXPECT_EQ(scene.time.start_s, 0.5);
    EXPECT_EQ(scene.time.end_s, 1.5);
    EXPECT_EQ(scene.time.frames, 25U);
    ASSERT_TRUE(scene.objects.at(0).motion);
    expect_near(geometry::object_poses(scene, 1.5).at(0).point({3, 0, 0}), {2, 3, -1}, 1e-6);
}

TEST_F(ReadSceneGltfTest, node_motion_follows_the_placement_of_its_object) {
    const model::Scene scene = read(head + R"([scene]
up_axis = "z"
length_unit = "cm"
[time]
end_s = 2
frames = 3
[[object]]
name = "a"
mesh = "lift.glb"
motion = "up"
scale = 2
translation = [0, 0, 100]
[[object]]
name = "b"
mesh = "lift.glb"
motion = "up"
[[object]]
name = "c"
mesh = "lift.glb"
motion = "up"
[[motion]]
name = "up"
gltf_node = "lift"
)");
    // glTF metres stay metres, y is turned to z: the corner (3,0,0) rests at (6,0,1), its pivot at (4,0,1).
    expect_near(scene.objects.at(0).mesh.points.at(1), {6, 0, 1});
    expect_near(geometry::object_poses(scene, 1.5).at(0).point({6, 0, 1}), {4, 2, 7}, 1e-6);
    expect_near(geometry::object_poses(scene, 1.5).at(1).point({3, 0, 0}), {2, 1, 3}, 1e-6);
    EXPECT_EQ(scene.motions.size(), 2U) << "objects placed alike share a motion";
}

TEST_F(ReadSceneGltfTest, a_node_motion_carries_and_is_carried_where_one_object_says_which_file_it_is_of) {
    const std::string scene_and_lift = head + R"([scene]
up_axis = "y"
[[object]]
name = "lift"
mesh = "lift.glb"
motion = "up"
[[object]]
name = "floor"
mesh = "room.obj"
group = "floor"
motion = "rider"
)";
    const std::string motions = R"([[motion]]
name = "rider"
parent = "up"
keyframe = [{time_s = 0, translation = [1, 0, 0]}]
[[motion]]
name = "up"
gltf_node = "lift"
parent = "ship"
[[motion]]
name = "ship"
keyframe = [{time_s = 0}, {time_s = 1.5, translation = [0, 0, 10]}]
)";
    const model::Scene scene = read(scene_and_lift + motions);
    const auto poses = geometry::object_poses(scene, 1.5);
    expect_near(poses.at(0).point({3, 0, 0}), {2, 3, 9}, 1e-6);
    expect_near(poses.at(1).point({2, 0, 0}), poses.at(0).point({3, 0, 0}), 1e-12);
    const std::string two =
        scene_and_lift + "[[object]]\nname = \"b\"\nmesh = \"lift.glb\"\nscale = 2\nmotion = \"up\"\n";
    EXPECT_EQ(message_of(two + motions), "scene.toml:20: motion 'up' is a glTF node's and its objects lie in "
                                         "several files or places; follow a "
                                         "motion of its own");
}

} // namespace
} // namespace kinelux::io
