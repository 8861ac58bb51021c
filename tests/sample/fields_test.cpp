// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/parallel.h"
#include "kernel/polygon_irradiance.h"
#include "sample/frames.h"
#include "sample/sampler.h"
#include "sample/shown_patches.h"
#include "support/shapes.h"

namespace kinelux::sample {
namespace {

struct Case : test::ShownPatches {
    using ShownPatches::ShownPatches;

    model::SurfaceFields fields(const model::FrameSolution& frame) const {
        return surface_fields(mesh, shapes, scene, test::layout_of(shapes), frame, poses, occluders, {});
    }
};

const model::NamedArray& named(const model::SurfaceFields& fields, const std::string& name) {
    for (const model::NamedArray& array : fields.point_arrays)
        if (array.name == name) return array;
    throw std::runtime_error("no array " + name);
}

model::Patch cylinder(double orientation) {
    model::Patch patch;
    patch.surface.type = model::SurfaceType::Cylinder;
    patch.surface.radius = 0.5;
    patch.surface.orientation = orientation;
    const double turn = 2.0 * std::numbers::pi;
    for (std::uint32_t i = 0; i < 24; ++i) {
        const double u = turn * i / 24.0, w = turn * (i + 1) / 24.0;
        const auto first = static_cast<std::uint32_t>(patch.points.size());
        patch.points.insert(patch.points.end(), {{u, 0.0}, {w, 0.0}, {w, 1.0}, {u, 1.0}});
        patch.triangles.push_back({first, first + 1, first + 2});
        patch.triangles.push_back({first, first + 2, first + 3});
    }
    return patch;
}

TEST(SurfaceFields, constants_are_reproduced) {
    for (const int degree : {0, 1, 2}) {
        Case c(support::box({0, 0, 0}, {1, 2, 0.7}, support::Facing::Inwards), support::plain_scene(1, 0.5),
               3, degree, 0.21);
        const model::SurfaceFields fields = c.fields(test::uniform_frame(c.shapes, c.scene, 0.0, 3.0));
        for (std::size_t p = 0; p < c.mesh.points.size(); ++p) {
            EXPECT_NEAR(named(fields, "Indirect_W_m2").values[p], 3.0f, 1e-5f);
            EXPECT_NEAR(named(fields, "Irradiance_W_m2").values[p], 3.0f, 1e-5f);
            EXPECT_NEAR(named(fields, "Radiosity_W_m2").values[p], 1.5f, 1e-5f);
            EXPECT_EQ(named(fields, "Direct_W_m2").values[p], 0.0f);
            EXPECT_EQ(fields.points[p], c.mesh.points[p]);
        }
        ASSERT_EQ(fields.cell_arrays.size(), 1u);
        EXPECT_EQ(fields.cell_arrays[0].name, "ErrorEstimate_W_m2");
        EXPECT_EQ(fields.cell_arrays[0].values, std::vector<float>(c.mesh.triangles.size(), 0.25f));
    }
}

TEST(SurfaceFields, gathered_light_between_equal_walls_is_their_radiosity) {
    // The frame is no solution: its indirect irradiance is 3, but walls of radiosity 1.5 send 1.5 to every point.
    for (const int degree : {0, 2}) {
        const Case c(support::box({0, 0, 0}, {1, 2, 0.7}, support::Facing::Inwards),
                     support::plain_scene(1, 0.5), 3, degree, 0.21);
        const SurfaceSampler sampler(c.mesh, c.shapes, c.scene, c.occluders.end_offset());
        const model::UnknownLayout layout = test::layout_of(c.shapes);
        const auto fields = sampler.fields(layout, test::uniform_frame(c.shapes, c.scene, 0.0, 3.0), c.poses,
                                           c.occluders, {}, IndirectLight::Gathered);
        for (std::size_t p = 0; p < c.mesh.points.size(); ++p) {
            const Vec3& x = c.mesh.points[p];
            EXPECT_NEAR(named(fields, "Indirect_W_m2").values[p], 1.5, 0.015)
                << x.x << " " << x.y << " " << x.z;
            EXPECT_NEAR(named(fields, "Radiosity_W_m2").values[p], 0.75, 0.0075);
        }
    }
}

TEST(SurfaceFields, values_jump_neither_between_elements_nor_between_patches_in_one_plane) {
    // Two squares side by side in one object, elements with different constants.
    const std::vector<model::Patch> patches{support::rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                                            support::rectangle({1, 0, 0}, {1, 0, 0}, {0, 1, 0})};
    Case c(patches, support::plain_scene(1), 1, 0, 0.5);
    model::FrameSolution frame = test::uniform_frame(c.shapes, c.scene, 0.0, 1.0);
    frame.irradiance_indirect[1] = 3.0;
    const model::SurfaceFields fields = c.fields(frame);
    for (std::size_t p = 0; p < c.mesh.points.size(); ++p) {
        const double x = c.mesh.points[p].x;
        EXPECT_NEAR(named(fields, "Indirect_W_m2").values[p], x < 0.999 ? 1.0 : x > 1.001 ? 3.0 : 2.0, 1e-6);
    }
}

TEST(SurfaceFields, direct_light_is_exact_at_every_point_up_to_the_walls) {
    model::Scene scene = support::plain_scene(2);
    scene.materials.push_back({"lamp", {0.0}, {5.0}, model::Sides::Front});
    std::vector<model::Patch> patches = support::box({-1, -1, 0}, {1, 1, 2}, support::Facing::Inwards);
    patches.push_back(
        support::rectangle({-0.3, -0.3, 1.9}, {0, 0.6, 0}, {0.6, 0, 0}, ObjectId(1), MaterialId(1)));
    Case c(patches, scene, 2, 0, 0.3);
    const model::SurfaceFields fields = c.fields(test::uniform_frame(c.shapes, c.scene, 0.0, 0.0));
    const std::array<Vec3, 4> lamp{Vec3(-0.3, -0.3, 1.9), Vec3(-0.3, 0.3, 1.9), Vec3(0.3, 0.3, 1.9),
                                   Vec3(0.3, -0.3, 1.9)};
    for (std::size_t p = 0; p < c.mesh.points.size(); ++p)
        if (c.mesh.point_objects[p] == 0) {
            const double truth = 5.0 * kernel::point_to_polygon(c.mesh.points[p], c.mesh.normals[p], lamp);
            EXPECT_NEAR(named(fields, "Direct_W_m2").values[p], truth, 2e-3)
                << c.mesh.points[p].x << " " << c.mesh.points[p].y << " " << c.mesh.points[p].z;
        }
}

TEST(SurfaceFields, bent_surfaces_do_not_shadow_themselves) {
    // The inside and the outside of a tube, lit by a ring of nothing but a lamp far away on its axis or beside it.
    for (const double orientation : {1.0, -1.0}) {
        model::Scene scene = support::plain_scene(2);
        scene.materials.push_back({"lamp", {0.0}, {5.0}, model::Sides::Front});
        const model::Patch lamp =
            orientation < 0.0
                ? support::rectangle({-0.2, -0.2, 1.5}, {0, 0.4, 0}, {0.4, 0, 0}, ObjectId(1), MaterialId(1))
                : support::rectangle({3, -0.2, 0.3}, {0, 0, 0.4}, {0, 0.4, 0}, ObjectId(1), MaterialId(1));
        Case c({cylinder(orientation)}, scene, 1, 0, 0.1);
        c.set.patches.push_back(lamp);
        c.tree = support::uniform_elements({{lamp}, {}}, 1);
        model::Element tube;
        tube.patch = PatchId(0);
        tube.first_triangle = 2;
        tube.triangle_count = static_cast<std::uint32_t>(c.set.patches[0].triangles.size());
        for (const model::Triangle& t : c.set.patches[0].triangles)
            c.tree.domain_triangles.push_back({c.set.patches[0].points[t[0]], c.set.patches[0].points[t[1]],
                                               c.set.patches[0].points[t[2]]});
        c.tree.elements[0].patch = PatchId(1);
        c.tree.elements.insert(c.tree.elements.begin(), tube);
        c.shapes = geometry::element_shapes(c.set, c.tree, 0, 0);
        c.mesh = display_mesh(c.shapes, c.set, c.tree, 0.1);
        c.occluders = visibility::Occluders(visibility::bodies_of(c.set, c.scene));
        const model::SurfaceFields fields = c.fields(test::uniform_frame(c.shapes, c.scene, 0.0, 0.0));
        const std::array<Vec3, 4> corners{
            lamp.surface.origin, lamp.surface.origin + 0.4 * lamp.surface.axis_u,
            lamp.surface.origin + 0.4 * (lamp.surface.axis_u + lamp.surface.axis_v),
            lamp.surface.origin + 0.4 * lamp.surface.axis_v};
        std::size_t lit = 0;
        for (std::size_t p = 0; p < c.mesh.points.size(); ++p) {
            if (c.mesh.point_objects[p] != 0) continue;
            const Vec3 x = c.mesh.points[p], n = c.mesh.normals[p];
            const double truth = 5.0 * kernel::point_to_polygon(x, n, corners);
            // Points that see the whole lamp well above the horizon get all of it.
            bool clear = truth > 0.0;
            for (const Vec3& corner : corners) clear = clear && glm::dot(glm::normalize(corner - x), n) > 0.1;
            if (!clear) continue;
            ++lit;
            EXPECT_NEAR(named(fields, "Direct_W_m2").values[p] / truth, 1.0, 0.02)
                << x.x << " " << x.y << " " << x.z;
        }
        EXPECT_GT(lit, 50u);
    }
}

/// A ball of small triangles of radius 0.5 about the origin, in clusters of one band of latitude each.
void add_ball(model::PatchSet& set, model::ClusterTree& tree) {
    constexpr std::uint32_t around = 24, bands = 12;
    for (std::uint32_t j = 0; j <= bands; ++j)
        for (std::uint32_t i = 0; i < around; ++i) {
            const double u = 2.0 * std::numbers::pi * i / around,
                         v = std::numbers::pi * (j / double(bands) - 0.5);
            set.small.points.push_back(
                0.5 * Vec3(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)));
        }
    for (std::uint32_t j = 0; j < bands; ++j) {
        model::Cluster cluster;
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t a = j * around + i, b = j * around + (i + 1) % around;
            for (const model::Triangle& t :
                 {model::Triangle{a, b, b + around}, model::Triangle{a, b + around, a + around}}) {
                cluster.triangles.push_back(static_cast<std::uint32_t>(set.small.triangles.size()));
                set.small.triangles.push_back(t);
                set.small.objects.emplace_back(0u);
                set.small.materials.emplace_back(0u);
            }
        }
        model::Element element;
        element.cluster = ClusterId(tree.clusters.size());
        tree.elements.push_back(element);
        tree.clusters.push_back(cluster);
    }
}

TEST(SurfaceFields, clusters_are_lit_smoothly_up_to_their_vertices) {
    model::Scene scene = support::plain_scene(2);
    scene.materials.push_back({"lamp", {0.0}, {5.0}, model::Sides::Front});
    const model::Patch lamp =
        support::rectangle({3, -0.2, -0.2}, {0, 0, 0.4}, {0, 0.4, 0}, ObjectId(1), MaterialId(1));
    Case c({lamp}, scene, 1, 0, 10.0);
    const model::Element lit_by = c.tree.elements[0];
    c.tree.elements.clear();
    add_ball(c.set, c.tree);
    c.tree.elements.push_back(lit_by);
    c.shapes = geometry::element_shapes(c.set, c.tree, 0, 0);
    c.mesh = display_mesh(c.shapes, c.set, c.tree, 0.1);
    c.occluders = visibility::Occluders(visibility::bodies_of(c.set, c.scene));
    const model::SurfaceFields fields = c.fields(test::uniform_frame(c.shapes, c.scene, 0.0, 0.0));
    const std::array<Vec3, 4> corners{Vec3(3, -0.2, -0.2), Vec3(3, -0.2, 0.2), Vec3(3, 0.2, 0.2),
                                      Vec3(3, 0.2, -0.2)};
    std::size_t lit = 0;
    for (std::size_t p = 0; p < c.mesh.points.size(); ++p) {
        if (c.mesh.point_objects[p] != 0 || c.mesh.normals[p].x < 0.45) continue;
        const double truth = 5.0 * kernel::point_to_polygon(c.mesh.points[p], c.mesh.normals[p], corners);
        EXPECT_NEAR(named(fields, "Direct_W_m2").values[p] / truth, 1.0, 0.02) << c.mesh.normals[p].x;
        ++lit;
    }
    EXPECT_GT(lit, 100u);
}

TEST(SurfaceFields, moved_objects_take_their_points_and_their_light_along) {
    model::Scene scene = support::plain_scene(2);
    scene.materials.push_back({"lamp", {0.0}, {5.0}, model::Sides::Front});
    scene.motions.push_back(
        {"slide", model::Interpolation::Linear, Vec3(0.0), {{0.0, Vec3(0), Quat(1, 0, 0, 0)}}});
    scene.objects[1].motion = MotionId(0);
    const std::vector<model::Patch> patches{
        support::rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}),
        support::rectangle({-0.3, -0.3, 1}, {0, 0.6, 0}, {0.6, 0, 0}, ObjectId(1), MaterialId(1))};
    Case c(patches, scene, 1, 0, 0.4);
    c.poses[1].translation = {0.5, 0.25, 0.0};
    c.occluders.set_poses(c.poses);
    const model::SurfaceFields fields = c.fields(test::uniform_frame(c.shapes, c.scene, 0.0, 0.0));
    const std::array<Vec3, 4> lamp{Vec3(0.2, -0.05, 1), Vec3(0.2, 0.55, 1), Vec3(0.8, 0.55, 1),
                                   Vec3(0.8, -0.05, 1)};
    for (std::size_t p = 0; p < c.mesh.points.size(); ++p) {
        const bool moves = c.mesh.point_objects[p] == 1;
        EXPECT_EQ(fields.points[p], c.mesh.points[p] + (moves ? Vec3(0.5, 0.25, 0.0) : Vec3(0.0)));
        if (!moves) {
            EXPECT_NEAR(named(fields, "Direct_W_m2").values[p],
                        5.0 * kernel::point_to_polygon(c.mesh.points[p], {0, 0, 1}, lamp), 2e-3);
        }
    }
}

TEST(SurfaceFields, the_bytes_do_not_depend_on_the_number_of_threads) {
    model::Scene scene = support::plain_scene(3);
    scene.materials.push_back({"lamp", {0.0}, {5.0}, model::Sides::Front});
    std::vector<model::Patch> patches = support::box({-1, -1, 0}, {1, 1, 2}, support::Facing::Inwards);
    patches.push_back(
        support::rectangle({-0.3, -0.3, 1.9}, {0, 0.6, 0}, {0.6, 0, 0}, ObjectId(1), MaterialId(1)));
    patches.push_back(support::rectangle({-0.4, -0.3, 1.0}, {0.7, 0, 0.1}, {0, 0.5, 0}, ObjectId(2)));
    Case c(patches, scene, 2, 1, 0.15);
    const model::FrameSolution frame = test::uniform_frame(c.shapes, c.scene, 0.0, 1.0);
    core::set_thread_count(1);
    const model::SurfaceFields one = c.fields(frame);
    core::set_thread_count(2);
    const model::SurfaceFields two = c.fields(frame);
    core::set_thread_count(0);
    for (std::size_t a = 0; a < one.point_arrays.size(); ++a)
        EXPECT_EQ(one.point_arrays[a].values, two.point_arrays[a].values);
}

} // namespace
} // namespace kinelux::sample
