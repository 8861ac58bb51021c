// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>

#include "model/cluster_tree.h"
#include "model/coefficients.h"
#include "model/patch_set.h"
#include "model/plan.h"
#include "model/scene.h"
#include "model/solution.h"
#include "model/surface_field.h"

// A small case that has everything a file can hold: two bodies (a floor and a lamp that moves above it), patches of
// two surface types, small triangles, every optional value set or unset.
namespace kinelux::support {

inline constexpr double awkward = 0.1 + 0.2; // 0.30000000000000004: needs all 17 digits

inline model::Object rectangle_object(const std::string& name, double size, double height,
                                      MaterialId material, bool facing_up) {
    model::Object object;
    object.name = name;
    object.source = "room.obj:" + name;
    object.mesh.points = {{0, 0, height}, {size, 0, height}, {size, size, height}, {0, size, height}};
    object.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    if (!facing_up) object.mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
    object.mesh.materials.assign(2, material);
    object.mesh.two_sided = {0, 1};
    object.mesh.source_faces = {7, 9};
    return object;
}

inline model::Scene example_scene() {
    model::Scene scene;
    scene.title = "A \"floor\" & a lamp";
    scene.quantity = model::Quantity::Photometric;
    scene.channels = {"red", "green", "blue"};
    scene.up = {0.0, 0.0, 1.0};
    scene.accuracy = {.target = 0.01, .degree = 2, .element_size = std::nullopt};
    scene.time = {.start_s = 0.0, .end_s = awkward, .frames = 3};
    scene.effects.static_occlusion = false;
    scene.view.target = Vec3(0.5, awkward, 1e-300);
    scene.view.field_of_view_deg = 40.0;
    scene.exported = {.cell_size = 0.125, .frames = std::vector<std::uint32_t>{0, 2}};
    scene.materials = {{"white", {0.7, awkward, 0.0}, {0.0, 0.0, 0.0}, model::Sides::Front},
                       {"lamp <1>", {0.5, 0.5, 0.5}, {100.0, 90.0, 80.0}, model::Sides::Both}};
    scene.objects = {rectangle_object("floor/main", 2.0, 0.0, MaterialId(0), true),
                     rectangle_object("Lampe \xC3\xA4 'x' & <y>", 0.5, 1.5, MaterialId(1), false)};
    scene.objects[1].motion = MotionId(0);
    scene.motions = {{"glide", model::Interpolation::Cubic, Vec3(0.0, -0.0, awkward), {}}};
    scene.motions[0].keyframes = {
        {0.0, Vec3(0.0), Quat(1.0, 0.0, 0.0, 0.0)},
        {awkward, Vec3(1.0, 0.5, 0.0), Quat(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5))}};
    scene.motions.push_back({"turn", model::Interpolation::Step, Vec3(awkward), {{0.0}}});
    scene.motions[1].keyframes[0].turn = Vec3(0.0, 7.0, awkward);
    scene.motions[1].keyframes[0].tangents = {Vec3(awkward), Vec3(1.0), Quat(0, 0, 0, awkward),
                                              Quat(1, 2, 3, 4)};
    scene.motions[1].rotation_interpolation = model::Interpolation::Cubic;
    scene.motions[1].parent = MotionId(0);
    scene.dimmings = {{"evening", model::Interpolation::Step, {{0.0, 1.0}, {awkward, awkward}}}};
    scene.materials[1].dimming = DimmingId(0);
    scene.meters = {{"desk", Vec3(0.1, 0.1, 0.7), Vec3(1, 0, 0), Vec3(0, 1, 0), 4, 3, MotionId(1)}};
    scene.source = "scenes/room.toml";
    return scene;
}

inline model::Patch plane_patch(ObjectId object, MaterialId material) {
    model::Patch patch;
    patch.object = object;
    patch.material = material;
    patch.points = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    patch.triangles = {{0, 1, 2}, {0, 2, 3}};
    patch.loops = {{0, 1, 2, 3}};
    patch.deviation_max = awkward;
    patch.deviation_rms = 0.01;
    return patch;
}

inline model::Patch spline_patch(ObjectId object, MaterialId material) {
    model::Patch patch = plane_patch(object, material);
    patch.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.25, 0.25}, {0.25, 0.5}, {0.5, 0.25}};
    patch.triangles = {{0, 1, 6}, {1, 2, 6}, {2, 3, 5}};
    patch.loops = {{0, 1, 2, 3}, {4, 5, 6}};
    patch.surface.type = model::SurfaceType::BSpline;
    patch.surface.orientation = -1.0;
    patch.surface.radius = 3.5;
    patch.surface.minor_radius = 0.25;
    patch.surface.half_angle_rad = 0.125;
    patch.surface.bspline = {.degree_u = 1,
                             .degree_v = 1,
                             .count_u = 2,
                             .count_v = 2,
                             .knots_u = {0, 0, 1, 1},
                             .knots_v = {0, 0, 1, 1},
                             .poles = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1 + awkward}},
                             .weights = {1, 1, 1, 0.5}};
    return patch;
}

inline model::PatchSet example_patches() {
    model::PatchSet set;
    set.patches = {plane_patch(ObjectId(0), MaterialId(0)), spline_patch(ObjectId(1), MaterialId(1))};
    set.small.points = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, awkward}};
    set.small.triangles = {{0, 1, 2}, {1, 3, 2}};
    set.small.objects = {ObjectId(1), ObjectId(1)};
    set.small.materials = {MaterialId(1), MaterialId(1)};
    return set;
}

inline model::ClusterTree example_clusters() {
    model::ClusterTree tree;
    tree.clusters = {{ObjectId(1), MaterialId(1), {1, 0}, 12.5}};
    tree.domain_triangles = {{Vec2(0, 0), Vec2(2, 0), Vec2(2, 2)},
                             {Vec2(0, 0), Vec2(2, 2), Vec2(0, 2)},
                             {Vec2(0, 0), Vec2(1, 0), Vec2(0.5, 0.25)}};
    tree.elements = {{PatchId(0), std::nullopt, ObjectId(0), MaterialId(0), 0, 2},
                     {PatchId(1), std::nullopt, ObjectId(1), MaterialId(1), 2, 1},
                     {std::nullopt, ClusterId(0), ObjectId(1), MaterialId(1), 0, 0}};
    tree.element_size = awkward;
    return tree;
}

inline model::Plan example_plan() {
    model::Plan plan;
    plan.effects = {{"colour", true, "three channels differ by 12 %", 0.0, false},
                    {"moving occlusion", false, "the scene says so", awkward, true}};
    plan.degree = 3;
    plan.cluster_degree = 1;
    plan.bounces = 4;
    plan.single_channel = true;
    plan.static_occlusion = false;
    plan.moving_objects = {ObjectId(1)};
    plan.unknowns = (1ull << 53) + 1; // more than a double can count
    plan.predicted_blocks = 6;
    plan.predicted_memory_mib = awkward;
    return plan;
}

inline model::Coefficients example_coefficients() {
    model::Coefficients coefficients;
    coefficients.layout.offsets = {0, 3, 4, 5};
    coefficients.degree = 1;
    coefficients.static_blocks.entries = {{0, 1, 0, 1e-3f}, {0, 2, 3, 0.1f}, {1, 2, 6, 0.0f}};
    coefficients.static_blocks.values = {0.1f, -0.2f, 0.3f, 1e-30f, 0.5f, 0.6f, 0.7f};
    coefficients.hierarchy.layout.offsets = {0, 3, 4, 5, 7};
    coefficients.hierarchy.groups = {{1, 2, 0}};
    coefficients.hierarchy.restrictions = {0.6, 0.8, 1e-300, -0.5};
    coefficients.hierarchy.links.entries = {{0, 3, 0, 0.25f}};
    coefficients.hierarchy.links.values = {0.1f, -1e-30f, 0.3f, 0.4f, 0.5f, 0.6f};
    coefficients.hierarchy.error_estimate = 0.004;
    coefficients.moving_pairs = {{0, 1}, {0, 2}};
    coefficients.crossed_pairs = {{1, 2}};
    coefficients.pairs_examined = 3.0;
    coefficients.rays_cast = 1e10;
    return coefficients;
}

inline model::Solution example_solution() {
    model::Solution solution;
    solution.layout.offsets = {0, 3, 4, 5};
    solution.channels = 3;
    for (std::uint32_t f = 0; f < 3; ++f) {
        model::FrameSolution frame;
        frame.frame = f;
        frame.time_s = f * awkward / 2.0;
        for (int k = 0; k < 15; ++k) {
            frame.radiosity.push_back(awkward * k + f);
            frame.irradiance_direct.push_back(awkward / (k + 1.0));
            frame.irradiance_indirect.push_back(-awkward * k);
        }
        frame.sweeps = 5.25 + f;
        frame.solver_error = 1e-5 * awkward;
        frame.residual = 1e-7 * awkward;
        frame.unshot = 0.001 * awkward;
        frame.error_estimate = 0.01 * awkward;
        frame.element_error = {0.25f, 0.5f, static_cast<float>(f)};
        frame.converged = f != 1;
        frame.blocks_recomputed = 2 * f;
        solution.frames.push_back(std::move(frame));
    }
    return solution;
}

} // namespace kinelux::support
