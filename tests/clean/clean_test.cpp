// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/clean.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "cluster/cluster.h"
#include "core/error.h"
#include "fit/fit.h"
#include "fit/scene_meshes.h"

namespace kinelux::clean {
namespace {

using support::add_object;
using support::add_sheet;
using support::box_mesh;
using support::empty_scene;

model::Scene auto_scene() { return empty_scene(model::Sides::Auto); }

// What a file without two_sided flags holds.
CleanResult cleaned(model::Scene scene) {
    for (model::Object& object : scene.objects) object.mesh.two_sided.clear();
    CleanResult result = clean_scene(std::move(scene), {});
    for (const model::Object& object : result.scene.objects) {
        model::check(object.mesh, object.name);
        EXPECT_EQ(object.mesh.two_sided.size(), object.mesh.triangles.size());
    }
    return result;
}

// Every face with corners of its own, as STL files have them.
model::Mesh exploded(const model::Mesh& mesh) {
    model::Mesh result = mesh;
    result.points.clear();
    for (model::Triangle& t : result.triangles) {
        for (std::uint32_t& corner : t) {
            result.points.push_back(mesh.points[corner]);
            corner = static_cast<std::uint32_t>(result.points.size() - 1);
        }
    }
    return result;
}

TEST(Clean, loose_faces_become_a_closed_box) {
    model::Scene scene = auto_scene();
    model::Mesh box = exploded(box_mesh(Vec3{0.0}, Vec3{1.0, 2.0, 3.0}));
    std::swap(box.triangles[3][0], box.triangles[3][1]);
    std::swap(box.triangles[7][1], box.triangles[7][2]);
    for (std::size_t p = 0; p < box.points.size(); p += 5) box.points[p].x += 1e-9;
    add_object(scene, "box", box);
    add_object(scene, "other", box_mesh(Vec3{5.0}, Vec3{6.0}));
    const CleanResult result = cleaned(scene);
    const CleanReport& report = result.reports[0];
    EXPECT_EQ(report.points_out, 8U);
    EXPECT_EQ(report.merged_points, 28U);
    EXPECT_EQ(report.flipped_faces, 2U);
    EXPECT_EQ(report.closed_parts, 1U);
    EXPECT_EQ(report.boundary_edges, 0U);
    EXPECT_EQ(report.two_sided_faces, 0U);
    EXPECT_NEAR(report.volume_out, 6.0, 1e-7);
    EXPECT_NEAR(model::signed_volume(result.scene.objects[0].mesh), 6.0, 1e-7);
    EXPECT_NEAR(report.area_out, 22.0, 1e-7);
}

TEST(Clean, duplicate_faces_go_and_faces_back_to_back_become_two_sided) {
    model::Scene scene = auto_scene();
    scene.materials[0].sides = model::Sides::Front;
    model::Mesh sheet;
    add_sheet(sheet, Vec3{0.0}, Vec3{1.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0});
    sheet.triangles.push_back({1, 3, 0});
    sheet.triangles.push_back({0, 3, 2});
    sheet.triangles[3] = {3, 1, 0};
    add_object(scene, "sheet", sheet);
    const CleanReport report = cleaned(scene).reports[0];
    EXPECT_EQ(report.faces_out, 2U);
    EXPECT_EQ(report.duplicate_faces + report.opposite_faces, 2U);
    EXPECT_EQ(report.opposite_faces, 1U);
    EXPECT_EQ(report.two_sided_faces, 1U);
}

TEST(Clean, faces_back_to_back_of_two_materials_are_both_kept) {
    model::Scene scene = auto_scene();
    model::Mesh sheet;
    sheet.points = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 1}};
    sheet.materials = {MaterialId(0), MaterialId(1)};
    add_object(scene, "sheet", sheet);
    const CleanResult result = cleaned(scene);
    EXPECT_EQ(result.reports[0].faces_out, 2U);
    EXPECT_EQ(result.reports[0].two_sided_faces, 0U);
    EXPECT_NEAR(result.reports[0].area_out, 1.0, 1e-15);
}

TEST(Clean, faces_without_area_go_and_the_gap_they_closed_is_stitched) {
    // The upper long edge of the lower triangle is split by a point, and a face without area closes the gap.
    model::Scene scene = auto_scene();
    model::Mesh mesh;
    mesh.points = {{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {1.0, -1.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 4}, {3, 1, 4}, {2, 2, 1}};
    add_object(scene, "kite", mesh);
    const CleanReport report = cleaned(scene).reports[0];
    EXPECT_EQ(report.degenerate_faces, 2U);
    EXPECT_EQ(report.faces_out, 4U);
    EXPECT_EQ(report.boundary_edges, 4U);
    EXPECT_EQ(report.parts, 1U);
    EXPECT_NEAR(report.area_out, 2.0, 1e-15);
}

TEST(Clean, room_with_furniture_faces_inwards_and_the_furniture_outwards) {
    for (const bool inside_out : {false, true}) {
        model::Scene scene = auto_scene();
        const model::Mesh room = box_mesh(Vec3{0.0}, Vec3{5.0, 4.0, 3.0}),
                          table = box_mesh(Vec3{1.0, 1.0, 0.0}, Vec3{2.0, 2.0, 1.0});
        add_object(scene, "room", inside_out ? support::turned_inside_out(room) : room);
        add_object(scene, "table", inside_out ? support::turned_inside_out(table) : table);
        const CleanResult result = cleaned(scene);
        EXPECT_NEAR(model::signed_volume(result.scene.objects[0].mesh), -60.0, 1e-12);
        EXPECT_NEAR(model::signed_volume(result.scene.objects[1].mesh), 1.0, 1e-12);
        EXPECT_EQ(result.reports[0].two_sided_faces, 0U);
        EXPECT_FALSE(result.reports[0].notes.empty());
    }
}

TEST(Clean, unlit_things_inside_a_body_do_not_make_it_a_room) {
    model::Scene scene = auto_scene();
    add_object(scene, "body", box_mesh(Vec3{0.0}, Vec3{1.0}));
    add_object(scene, "works", box_mesh(Vec3{0.4}, Vec3{0.6}));
    add_object(scene, "elsewhere", box_mesh(Vec3{3.0}, Vec3{4.0}));
    const CleanResult result = cleaned(scene);
    for (const model::Object& object : result.scene.objects)
        EXPECT_GT(model::signed_volume(object.mesh), 0.0);
}

TEST(Clean, lone_closed_part_is_a_room) {
    model::Scene scene = auto_scene();
    add_object(scene, "room", box_mesh(Vec3{0.0}, Vec3{1.0}));
    EXPECT_NEAR(model::signed_volume(cleaned(scene).scene.objects[0].mesh), -1.0, 1e-14);
}

TEST(Clean, walls_that_are_objects_of_their_own_make_a_room) {
    model::Scene scene = auto_scene();
    const model::Mesh room = box_mesh(Vec3{0.0}, Vec3{5.0, 4.0, 3.0});
    for (std::size_t side = 0; side < 6; ++side) {
        model::Mesh wall = support::finished(
            {room.points, {room.triangles[2 * side], room.triangles[2 * side + 1]}, {}, {}, {}});
        if (side % 2 == 0) wall = support::turned_inside_out(wall);
        add_object(scene, "wall " + std::to_string(side), wall);
    }
    // One wall has a point more on its edges than its neighbours.
    model::Mesh& wall = scene.objects[1].mesh;
    wall.points.push_back(0.5 * (wall.points[wall.triangles[0][0]] + wall.points[wall.triangles[0][1]]));
    const model::Triangle whole = wall.triangles[0];
    wall.triangles[0] = {whole[0], 8, whole[2]};
    wall.triangles.push_back({8, whole[1], whole[2]});
    wall.materials.push_back({});
    wall.source_faces.push_back(2);
    add_object(scene, "table", box_mesh(Vec3{1.0, 1.0, 0.0}, Vec3{2.0, 2.0, 1.0}));
    const CleanResult result = cleaned(scene);
    for (std::size_t o = 0; o < 6; ++o) {
        EXPECT_EQ(result.reports[o].two_sided_faces, 0U);
        const model::Mesh& mesh = result.scene.objects[o].mesh;
        const Vec3 to_middle = Vec3{2.5, 2.0, 1.5} - mesh.points[mesh.triangles[0][0]];
        EXPECT_GT(glm::dot(model::triangle_normal(mesh, 0), to_middle), 0.0);
    }
    EXPECT_NEAR(result.reports[0].volume_out, 60.0, 1e-12);
}

TEST(Clean, walls_with_a_gap_stay_sheets) {
    model::Scene scene = auto_scene();
    const model::Mesh room = box_mesh(Vec3{0.0}, Vec3{5.0, 4.0, 3.0});
    for (std::size_t side = 0; side < 5; ++side) {
        add_object(scene, "wall",
                   support::finished(
                       {room.points, {room.triangles[2 * side], room.triangles[2 * side + 1]}, {}, {}, {}}));
    }
    for (const CleanReport& report : cleaned(scene).reports) EXPECT_EQ(report.two_sided_faces, 2U);
}

TEST(Clean, skin_around_a_cavity_faces_outwards) {
    model::Scene scene = auto_scene();
    add_object(scene, "skin", box_mesh(Vec3{0.0}, Vec3{5.0}));
    add_object(scene, "cavity", support::turned_inside_out(box_mesh(Vec3{0.5}, Vec3{4.5})));
    add_object(scene, "table", box_mesh(Vec3{1.0}, Vec3{2.0}));
    const CleanResult result = cleaned(scene);
    EXPECT_GT(model::signed_volume(result.scene.objects[0].mesh), 0.0);
    EXPECT_LT(model::signed_volume(result.scene.objects[1].mesh), 0.0);
    EXPECT_GT(model::signed_volume(result.scene.objects[2].mesh), 0.0);
}

TEST(Clean, front_materials_are_made_to_agree_but_never_turned_as_a_whole) {
    model::Scene scene = empty_scene();
    model::Mesh box = support::turned_inside_out(box_mesh(Vec3{0.0}, Vec3{1.0, 2.0, 3.0}));
    std::swap(box.triangles[5][0], box.triangles[5][1]);
    add_object(scene, "box", box);
    add_object(scene, "other", box_mesh(Vec3{5.0}, Vec3{6.0}));
    const CleanResult result = cleaned(scene);
    EXPECT_EQ(result.reports[0].flipped_faces, 1U);
    EXPECT_NEAR(model::signed_volume(result.scene.objects[0].mesh), -6.0, 1e-13);
    EXPECT_EQ(result.reports[0].two_sided_faces, 0U);
}

TEST(Clean, sides_are_decided_face_by_face) {
    // An open box: Auto sides, one side Both, one Front.
    model::Scene scene = auto_scene();
    scene.materials.push_back({"both", {0.5}, {0.0}, model::Sides::Both});
    scene.materials.push_back({"front", {0.5}, {0.0}, model::Sides::Front});
    model::Mesh box = box_mesh(Vec3{0.0}, Vec3{1.0});
    box.triangles.resize(10);
    box.materials.resize(10);
    box.source_faces.resize(10);
    box.two_sided.clear();
    box.materials[0] = box.materials[1] = MaterialId(2);
    box.materials[2] = box.materials[3] = MaterialId(3);
    add_object(scene, "box", box);
    const CleanResult result = cleaned(scene);
    const std::vector<std::uint8_t> expected{1, 1, 0, 0, 1, 1, 1, 1, 1, 1};
    EXPECT_EQ(result.scene.objects[0].mesh.two_sided, expected);
    EXPECT_EQ(result.reports[0].flipped_faces, 0U);
}

TEST(Clean, edge_of_three_faces_is_kept_with_doubled_points) {
    model::Scene scene = auto_scene();
    model::Mesh fan;
    fan.points = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {-1.0, 1.0, 0.0}, {-1.0, -1.0, 0.0}};
    fan.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    add_object(scene, "fan", fan);
    const CleanReport report = cleaned(scene).reports[0];
    EXPECT_EQ(report.non_manifold_edges, 1U);
    EXPECT_EQ(report.faces_out, 3U);
    EXPECT_EQ(report.parts, 3U);
    EXPECT_NEAR(report.area_out, report.area_in, 1e-15);
}

TEST(Clean, crossing_sheets_are_counted) {
    model::Scene scene = auto_scene();
    model::Mesh cross;
    add_sheet(cross, Vec3{-1.0, -1.0, 0.0}, Vec3{2.0, 0.0, 0.0}, Vec3{0.0, 2.0, 0.0});
    add_sheet(cross, Vec3{-0.4, 0.1, -1.0}, Vec3{0.5, 0.0, 0.0}, Vec3{0.0, 0.0, 2.0});
    add_object(scene, "cross", cross);
    add_object(scene, "box", box_mesh(Vec3{3.0}, Vec3{4.0}));
    const CleanResult result = cleaned(scene);
    EXPECT_GT(result.reports[0].self_intersections, 0U);
    EXPECT_GT(result.reports[0].crossing_faces, 1U);
    EXPECT_EQ(result.reports[1].self_intersections, 0U);
    EXPECT_EQ(result.reports[1].crossing_faces, 0U);
}

// Each face in turn is taken out of a closed box: the gap is its three edges, the longest of them the diagonal.
TEST(Clean, gap_left_by_any_missing_face_is_measured_and_placed) {
    const model::Mesh box = box_mesh(Vec3{0.0}, Vec3{1.0});
    for (std::size_t missing = 0; missing < box.triangles.size(); ++missing) {
        model::Scene scene = auto_scene();
        model::Mesh open = box;
        open.triangles.erase(open.triangles.begin() + static_cast<std::ptrdiff_t>(missing));
        open.materials.pop_back();
        add_object(scene, "open", open);
        add_object(scene, "box", box_mesh(Vec3{3.0}, Vec3{4.0}));
        const CleanResult result = cleaned(scene);
        EXPECT_NEAR(result.reports[0].gap_length, 2.0 + std::sqrt(2.0), 1e-12);
        EXPECT_EQ(result.reports[1].gap_length, 0.0);
        const model::Triangle& t = box.triangles[missing];
        Vec3 middle{0.0};
        double longest = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &a = box.points[t[k]], &b = box.points[t[(k + 1) % 3]];
            if (glm::distance(a, b) <= longest) continue;
            longest = glm::distance(a, b);
            middle = 0.5 * (a + b);
        }
        std::ostringstream place;
        place << "(1.41421 m) at (" << middle.x << ", " << middle.y << ", " << middle.z << ") m";
        const std::vector<std::string>& notes = result.reports[0].notes;
        EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
            return note.find(place.str()) != std::string::npos;
        })) << place.str();
    }
}

TEST(Clean, coordinate_that_is_not_a_number_names_object_and_face) {
    model::Scene scene = auto_scene();
    model::Mesh box = box_mesh(Vec3{0.0}, Vec3{1.0});
    box.points[7].y = std::numeric_limits<double>::quiet_NaN();
    add_object(scene, "crate", box);
    try {
        cleaned(scene);
        FAIL() << "no error";
    } catch (const core::GeometryError& error) {
        EXPECT_NE(std::string(error.what()).find("'crate', face 2:"), std::string::npos) << error.what();
    }
}

TEST(Clean, object_of_which_nothing_is_left_is_refused) {
    model::Scene scene = auto_scene();
    model::Mesh line;
    line.points = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}};
    line.triangles = {{0, 1, 2}};
    add_object(scene, "line", line);
    EXPECT_THROW(cleaned(scene), core::GeometryError);
}

// A panel in a ceiling at z = 2, both facing down.
enum class Panel { Sliding, Emitting, Neither };
CleanResult panel_in_ceiling(Panel kind) {
    model::Scene scene = empty_scene();
    model::Mesh ceiling, panel;
    support::add_sheet(ceiling, Vec3{0.0, 0.0, 2.0}, Vec3{0.0, 4.0, 0.0}, Vec3{4.0, 0.0, 0.0});
    support::add_sheet(panel, Vec3{1.0, 1.0, 2.0}, Vec3{0.0, 0.5, 0.0}, Vec3{0.5, 0.0, 0.0});
    add_object(scene, "ceiling", ceiling);
    model::Object& object = add_object(scene, "panel", panel);
    if (kind == Panel::Emitting) object.mesh.materials.assign(2, MaterialId(1));
    if (kind == Panel::Sliding) {
        object.motion = MotionId(0);
        scene.time = {0.0, 1.0, 3};
        scene.motions = {
            {"slide",
             model::Interpolation::Linear,
             Vec3{0.0},
             {{0.0, Vec3{0.0}, Quat{1, 0, 0, 0}}, {1.0, Vec3{2.0, 0.0, 0.0}, Quat{1, 0, 0, 0}}}}};
    }
    return cleaned(std::move(scene));
}

TEST(Clean, a_motion_without_effect_in_the_frames_ends_as_a_body_at_rest_and_a_note) {
    model::Scene scene = empty_scene();
    model::Mesh sheet;
    support::add_sheet(sheet, Vec3{0.0}, Vec3{1.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0});
    add_object(scene, "sheet", sheet).motion = MotionId(0);
    scene.motions = {{"lift",
                      model::Interpolation::Linear,
                      Vec3{0.0},
                      {{0.0, Vec3{0.0}, Quat{1, 0, 0, 0}}, {1.0, Vec3{0.0, 0.0, 2.0}, Quat{1, 0, 0, 0}}}}};
    scene.time = {0.5, 0.5, 1};
    const CleanResult result = cleaned(scene);
    EXPECT_FALSE(result.scene.objects[0].motion);
    for (const Vec3& point : result.scene.objects[0].mesh.points) EXPECT_EQ(point.z, 1.0);
    ASSERT_FALSE(result.reports[0].notes.empty());
    EXPECT_NE(result.reports[0].notes[0].find("rests"), std::string::npos);
}

TEST(Clean, lamps_and_sliding_panels_within_a_ceiling_are_lifted_to_its_front) {
    for (const Panel kind : {Panel::Sliding, Panel::Emitting}) {
        const CleanResult result = panel_in_ceiling(kind);
        for (const Vec3& point : result.scene.objects[1].mesh.points) EXPECT_NEAR(point.z, 2.0 - 2e-5, 1e-12);
        for (const Vec3& point : result.scene.objects[0].mesh.points) EXPECT_EQ(point.z, 2.0);
        EXPECT_EQ(result.reports[1].notes.size(),
                  panel_in_ceiling(Panel::Neither).reports[1].notes.size() + 1);
    }
    for (const Vec3& point : panel_in_ceiling(Panel::Neither).scene.objects[1].mesh.points)
        EXPECT_EQ(point.z, 2.0);
}

TEST(Clean, merging_never_eats_area) {
    // A plate so thin that its sides are nearer to each other than the default tolerance.
    model::Scene scene = auto_scene();
    add_object(scene, "foil", box_mesh(Vec3{0.0}, Vec3{1.0, 1.0, 1e-8}));
    add_object(scene, "box", box_mesh(Vec3{3.0}, Vec3{4.0}));
    const CleanResult result = cleaned(scene);
    EXPECT_NEAR(result.reports[0].area_out * (result.reports[0].two_sided_faces > 0 ? 2.0 : 1.0), 2.0, 1e-6);
}

TEST(Clean, area_is_kept_through_clean_fit_and_cluster) {
    model::Scene scene = auto_scene();
    add_object(scene, "room", exploded(box_mesh(Vec3{0.0}, Vec3{5.0, 4.0, 3.0})));
    add_object(scene, "column", exploded(support::prism_mesh(Vec3{1.0, 1.0, 0.0}, 0.2, 3.0, 14)));
    add_object(scene, "table", exploded(box_mesh(Vec3{2.0, 2.0, 0.0}, Vec3{3.0, 3.0, 1.0})));
    model::Mesh screen;
    add_sheet(screen, Vec3{3.5, 0.5, 0.5}, Vec3{0.0, 1.0, 0.3}, Vec3{0.1, 0.0, 1.0}, 3, 2);
    add_object(scene, "screen", screen);
    double area = 0.0;
    for (const model::Object& object : scene.objects) area += model::area(object.mesh);
    area += model::area(scene.objects[3].mesh); // its back

    const CleanResult result = cleaned(scene);
    const fit::FitResult fitted = fit::fit_patches(result.scene, {});
    EXPECT_NEAR(fitted.area_in, area, 1e-12 * area);
    EXPECT_NEAR(fitted.area_out, area, 1e-12 * area);
    const model::ClusterTree tree =
        cluster::build_clusters(fitted.patches, cluster::cluster_options_for(result.scene, fitted.patches));
    model::check(tree, fitted.patches);
    double pieces = 0.0;
    for (const model::DomainTriangle& t : tree.domain_triangles) {
        pieces += 0.5 * ((t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x));
    }
    for (const model::Cluster& cluster : tree.clusters) {
        for (const std::uint32_t f : cluster.triangles) {
            const model::SmallTriangles& small = fitted.patches.small;
            const model::Triangle& t = small.triangles[f];
            const Vec3 a = small.points[t[0]];
            pieces += 0.5 * glm::length(glm::cross(small.points[t[1]] - a, small.points[t[2]] - a));
        }
    }
    EXPECT_NEAR(pieces, area, 1e-12 * area);
}

} // namespace
} // namespace kinelux::clean
