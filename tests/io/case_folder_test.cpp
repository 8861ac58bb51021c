// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/case_folder.h"

#include <bit>
#include <cstring>

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/example_case.h"
#include "io/temporary_folder.h"

namespace kinelux::io {

namespace {

using support::bytes_of;
using support::put_bytes;

/// Bit for bit: -0.0 is not 0.0.
template <class Value>
bool same_bits(const std::vector<Value>& a, const std::vector<Value>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Value)) == 0);
}
bool same_bits(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool same_bits(const Vec3& a, const Vec3& b) {
    return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

/// A case with every file, written once for each test.
class CaseFolderTest : public testing::Test {
protected:
    void SetUp() override {
        folder.write_scene(support::example_scene());
        folder.write_patches(support::example_patches(), support::example_scene());
        folder.write_clusters(support::example_clusters(), support::example_patches());
        folder.write_plan(support::example_plan());
        folder.write_coefficients(support::example_coefficients());
        folder.write_solution(support::example_solution());
    }

    /// What reading the file of this name throws; "" when it is read.
    std::string error_of(const std::string& file) const {
        try {
            read(file);
        } catch (const core::FileError& error) {
            return error.what();
        }
        return "";
    }

    void read(const std::string& file) const {
        if (file == "scene.json") folder.read_scene();
        if (file == "patches.h5") folder.read_patches();
        if (file == "clusters.h5") folder.read_clusters();
        if (file == "plan.json") folder.read_plan();
        if (file == "coefficients.h5") folder.read_coefficients();
        if (file == "solution.h5") folder.read_solution();
    }

    support::TemporaryFolder temporary;
    CaseFolder folder{temporary.path() / "room.case", true};
    const std::vector<std::string> files{"scene.json", "patches.h5",      "clusters.h5",
                                         "plan.json",  "coefficients.h5", "solution.h5"};
};

} // namespace

TEST_F(CaseFolderTest, scene_settings_come_back_exactly) {
    const model::Scene wanted = support::example_scene(), read = folder.read_scene();
    EXPECT_EQ(read.title, wanted.title);
    EXPECT_EQ(read.quantity, wanted.quantity);
    EXPECT_EQ(read.channels, wanted.channels);
    EXPECT_TRUE(same_bits(read.up, wanted.up));
    EXPECT_EQ(read.accuracy.target, wanted.accuracy.target);
    EXPECT_EQ(read.accuracy.degree, wanted.accuracy.degree);
    EXPECT_EQ(read.accuracy.element_size, wanted.accuracy.element_size);
    EXPECT_EQ(read.time.start_s, wanted.time.start_s);
    EXPECT_EQ(read.time.end_s, wanted.time.end_s);
    EXPECT_EQ(read.time.frames, wanted.time.frames);
    EXPECT_EQ(read.effects.interreflection, wanted.effects.interreflection);
    EXPECT_EQ(read.effects.static_occlusion, wanted.effects.static_occlusion);
    EXPECT_EQ(read.effects.moving_occlusion, wanted.effects.moving_occlusion);
    EXPECT_EQ(read.view.eye, wanted.view.eye);
    EXPECT_EQ(read.view.target, wanted.view.target);
    EXPECT_EQ(read.view.up, wanted.view.up);
    EXPECT_EQ(read.view.field_of_view_deg, wanted.view.field_of_view_deg);
    EXPECT_EQ(read.exported.cell_size, wanted.exported.cell_size);
    EXPECT_EQ(read.exported.frames, wanted.exported.frames);
    EXPECT_EQ(read.source, wanted.source);
}

TEST_F(CaseFolderTest, scene_materials_motions_and_meters_come_back_exactly) {
    const model::Scene wanted = support::example_scene(), read = folder.read_scene();
    ASSERT_EQ(read.materials.size(), wanted.materials.size());
    for (std::size_t m = 0; m < wanted.materials.size(); ++m) {
        EXPECT_EQ(read.materials[m].name, wanted.materials[m].name);
        EXPECT_TRUE(same_bits(read.materials[m].reflectance, wanted.materials[m].reflectance));
        EXPECT_TRUE(same_bits(read.materials[m].exitance, wanted.materials[m].exitance));
        EXPECT_EQ(read.materials[m].sides, wanted.materials[m].sides);
        EXPECT_EQ(read.materials[m].dimming, wanted.materials[m].dimming);
    }
    ASSERT_EQ(read.motions.size(), wanted.motions.size());
    for (std::size_t m = 0; m < wanted.motions.size(); ++m) {
        EXPECT_EQ(read.motions[m].name, wanted.motions[m].name);
        EXPECT_EQ(read.motions[m].parent, wanted.motions[m].parent);
        EXPECT_EQ(read.motions[m].interpolation, wanted.motions[m].interpolation);
        EXPECT_EQ(read.motions[m].rotation_interpolation, wanted.motions[m].rotation_interpolation);
        EXPECT_TRUE(same_bits(read.motions[m].pivot, wanted.motions[m].pivot));
        EXPECT_EQ(read.motions[m].keyframes, wanted.motions[m].keyframes);
    }
    ASSERT_EQ(read.dimmings.size(), 1u);
    EXPECT_EQ(read.dimmings[0].name, wanted.dimmings[0].name);
    EXPECT_EQ(read.dimmings[0].interpolation, wanted.dimmings[0].interpolation);
    EXPECT_EQ(read.dimmings[0].keys, wanted.dimmings[0].keys);
    ASSERT_EQ(read.meters.size(), 1u);
    EXPECT_EQ(read.meters[0].name, wanted.meters[0].name);
    EXPECT_TRUE(same_bits(read.meters[0].origin, wanted.meters[0].origin));
    EXPECT_TRUE(same_bits(read.meters[0].edge_u, wanted.meters[0].edge_u));
    EXPECT_TRUE(same_bits(read.meters[0].edge_v, wanted.meters[0].edge_v));
    EXPECT_EQ(read.meters[0].count_u, wanted.meters[0].count_u);
    EXPECT_EQ(read.meters[0].count_v, wanted.meters[0].count_v);
    EXPECT_EQ(read.meters[0].motion, wanted.meters[0].motion);
}

TEST_F(CaseFolderTest, scene_meshes_come_back_exactly) {
    const model::Scene wanted = support::example_scene(), read = folder.read_scene();
    ASSERT_EQ(read.objects.size(), wanted.objects.size());
    for (std::size_t o = 0; o < wanted.objects.size(); ++o) {
        EXPECT_EQ(read.objects[o].name, wanted.objects[o].name);
        EXPECT_EQ(read.objects[o].source, wanted.objects[o].source);
        EXPECT_EQ(read.objects[o].motion, wanted.objects[o].motion);
        const model::Mesh &mesh = read.objects[o].mesh, &original = wanted.objects[o].mesh;
        EXPECT_TRUE(same_bits(mesh.points, original.points));
        EXPECT_TRUE(same_bits(mesh.triangles, original.triangles));
        EXPECT_TRUE(same_bits(mesh.materials, original.materials));
        EXPECT_TRUE(same_bits(mesh.two_sided, original.two_sided));
        EXPECT_TRUE(same_bits(mesh.source_faces, original.source_faces));
    }
}

TEST_F(CaseFolderTest, corners_of_bilinear_surfaces_come_back_exactly) {
    model::PatchSet wanted = support::example_patches();
    model::Surface& surface = wanted.patches[0].surface;
    surface.type = model::SurfaceType::Bilinear;
    surface.corners = {Vec3(0, 0, 0), Vec3(1, 0, 0.1), Vec3(1, 1, 0), Vec3(0, 1, 1.0 / 3.0)};
    folder.write_patches(wanted, support::example_scene());
    const model::PatchSet read = folder.read_patches();
    EXPECT_EQ(read.patches[0].surface.type, model::SurfaceType::Bilinear);
    EXPECT_EQ(read.patches[0].surface.corners, surface.corners);
    EXPECT_EQ(read.patches[1].surface.type, model::SurfaceType::BSpline);
}

TEST_F(CaseFolderTest, patches_come_back_exactly) {
    const model::PatchSet wanted = support::example_patches(), read = folder.read_patches();
    ASSERT_EQ(read.patches.size(), wanted.patches.size());
    for (std::size_t p = 0; p < wanted.patches.size(); ++p) {
        const model::Patch &a = read.patches[p], &b = wanted.patches[p];
        EXPECT_EQ(a.object, b.object);
        EXPECT_EQ(a.material, b.material);
        EXPECT_TRUE(same_bits(a.points, b.points));
        EXPECT_TRUE(same_bits(a.triangles, b.triangles));
        EXPECT_EQ(a.loops, b.loops);
        EXPECT_TRUE(same_bits(a.deviation_max, b.deviation_max));
        EXPECT_TRUE(same_bits(a.deviation_rms, b.deviation_rms));
        const model::Surface &s = a.surface, &t = b.surface;
        EXPECT_EQ(s.type, t.type);
        EXPECT_TRUE(same_bits(s.origin, t.origin));
        EXPECT_TRUE(same_bits(s.axis_u, t.axis_u));
        EXPECT_TRUE(same_bits(s.axis_v, t.axis_v));
        EXPECT_TRUE(same_bits(s.axis_w, t.axis_w));
        EXPECT_EQ(s.radius, t.radius);
        EXPECT_EQ(s.minor_radius, t.minor_radius);
        EXPECT_EQ(s.half_angle_rad, t.half_angle_rad);
        EXPECT_EQ(s.orientation, t.orientation);
        EXPECT_EQ(s.bspline.degree_u, t.bspline.degree_u);
        EXPECT_EQ(s.bspline.degree_v, t.bspline.degree_v);
        EXPECT_EQ(s.bspline.count_u, t.bspline.count_u);
        EXPECT_EQ(s.bspline.count_v, t.bspline.count_v);
        EXPECT_TRUE(same_bits(s.bspline.knots_u, t.bspline.knots_u));
        EXPECT_TRUE(same_bits(s.bspline.knots_v, t.bspline.knots_v));
        EXPECT_TRUE(same_bits(s.bspline.poles, t.bspline.poles));
        EXPECT_TRUE(same_bits(s.bspline.weights, t.bspline.weights));
    }
    EXPECT_TRUE(same_bits(read.small.points, wanted.small.points));
    EXPECT_TRUE(same_bits(read.small.triangles, wanted.small.triangles));
    EXPECT_TRUE(same_bits(read.small.objects, wanted.small.objects));
    EXPECT_TRUE(same_bits(read.small.materials, wanted.small.materials));
}

TEST_F(CaseFolderTest, clusters_come_back_exactly) {
    const model::ClusterTree wanted = support::example_clusters(), read = folder.read_clusters();
    EXPECT_EQ(read.element_size, wanted.element_size);
    ASSERT_EQ(read.clusters.size(), wanted.clusters.size());
    EXPECT_EQ(read.clusters[0].object, wanted.clusters[0].object);
    EXPECT_EQ(read.clusters[0].material, wanted.clusters[0].material);
    EXPECT_EQ(read.clusters[0].triangles, wanted.clusters[0].triangles);
    EXPECT_EQ(read.clusters[0].normal_spread_deg, wanted.clusters[0].normal_spread_deg);
    ASSERT_EQ(read.elements.size(), wanted.elements.size());
    for (std::size_t e = 0; e < wanted.elements.size(); ++e) {
        EXPECT_EQ(read.elements[e].patch, wanted.elements[e].patch);
        EXPECT_EQ(read.elements[e].cluster, wanted.elements[e].cluster);
        EXPECT_EQ(read.elements[e].object, wanted.elements[e].object);
        EXPECT_EQ(read.elements[e].material, wanted.elements[e].material);
        EXPECT_EQ(read.elements[e].first_triangle, wanted.elements[e].first_triangle);
        EXPECT_EQ(read.elements[e].triangle_count, wanted.elements[e].triangle_count);
    }
    EXPECT_TRUE(same_bits(read.domain_triangles, wanted.domain_triangles));
}

TEST_F(CaseFolderTest, plan_comes_back_exactly) {
    const model::Plan wanted = support::example_plan(), read = folder.read_plan();
    ASSERT_EQ(read.effects.size(), wanted.effects.size());
    for (std::size_t e = 0; e < wanted.effects.size(); ++e) {
        EXPECT_EQ(read.effects[e].name, wanted.effects[e].name);
        EXPECT_EQ(read.effects[e].simulated, wanted.effects[e].simulated);
        EXPECT_EQ(read.effects[e].reason, wanted.effects[e].reason);
        EXPECT_EQ(read.effects[e].risked_error, wanted.effects[e].risked_error);
        EXPECT_EQ(read.effects[e].overridden, wanted.effects[e].overridden);
    }
    EXPECT_EQ(read.degree, wanted.degree);
    EXPECT_EQ(read.cluster_degree, wanted.cluster_degree);
    EXPECT_EQ(read.bounces, wanted.bounces);
    EXPECT_EQ(read.single_channel, wanted.single_channel);
    EXPECT_EQ(read.static_occlusion, wanted.static_occlusion);
    EXPECT_EQ(read.moving_occlusion, wanted.moving_occlusion);
    EXPECT_EQ(read.moving_objects, wanted.moving_objects);
    EXPECT_EQ(read.unknowns, wanted.unknowns);
    EXPECT_EQ(read.predicted_blocks, wanted.predicted_blocks);
    EXPECT_EQ(read.predicted_memory_mib, wanted.predicted_memory_mib);
}

TEST_F(CaseFolderTest, coefficients_come_back_exactly) {
    const model::Coefficients wanted = support::example_coefficients(), read = folder.read_coefficients();
    EXPECT_EQ(read.layout.offsets, wanted.layout.offsets);
    EXPECT_EQ(read.degree, wanted.degree);
    ASSERT_EQ(read.static_blocks.entries.size(), wanted.static_blocks.entries.size());
    for (std::size_t k = 0; k < wanted.static_blocks.entries.size(); ++k) {
        const auto &a = read.static_blocks.entries[k], &b = wanted.static_blocks.entries[k];
        EXPECT_EQ(a.i, b.i);
        EXPECT_EQ(a.j, b.j);
        EXPECT_EQ(a.offset, b.offset);
        EXPECT_EQ(a.error, b.error);
    }
    EXPECT_TRUE(same_bits(read.static_blocks.values, wanted.static_blocks.values));
    const model::Hierarchy &links = read.hierarchy, &wanted_links = wanted.hierarchy;
    EXPECT_EQ(links.layout.offsets, wanted_links.layout.offsets);
    ASSERT_EQ(links.groups.size(), 1u);
    EXPECT_EQ(links.groups[0].first, wanted_links.groups[0].first);
    EXPECT_EQ(links.groups[0].second, wanted_links.groups[0].second);
    EXPECT_EQ(links.groups[0].offset, wanted_links.groups[0].offset);
    EXPECT_TRUE(same_bits(links.restrictions, wanted_links.restrictions));
    ASSERT_EQ(links.links.entries.size(), 1u);
    EXPECT_EQ(links.links.entries[0].j, 3u);
    EXPECT_TRUE(same_bits(links.links.values, wanted_links.links.values));
    EXPECT_EQ(links.error_estimate, wanted_links.error_estimate);
    EXPECT_EQ(read.moving_pairs, wanted.moving_pairs);
    EXPECT_EQ(read.crossed_pairs, wanted.crossed_pairs);
    EXPECT_EQ(read.pairs_examined, wanted.pairs_examined);
    EXPECT_EQ(read.rays_cast, wanted.rays_cast);
}

TEST_F(CaseFolderTest, solution_comes_back_exactly_without_its_seconds) {
    const model::Solution wanted = support::example_solution(), read = folder.read_solution();
    EXPECT_EQ(read.layout.offsets, wanted.layout.offsets);
    EXPECT_EQ(read.channels, wanted.channels);
    ASSERT_EQ(read.frames.size(), wanted.frames.size());
    for (std::size_t f = 0; f < wanted.frames.size(); ++f) {
        const model::FrameSolution &a = read.frames[f], &b = wanted.frames[f];
        EXPECT_EQ(a.frame, b.frame);
        EXPECT_EQ(a.time_s, b.time_s);
        EXPECT_TRUE(same_bits(a.radiosity, b.radiosity));
        EXPECT_TRUE(same_bits(a.irradiance_direct, b.irradiance_direct));
        EXPECT_TRUE(same_bits(a.irradiance_indirect, b.irradiance_indirect));
        EXPECT_EQ(a.sweeps, b.sweeps);
        EXPECT_EQ(a.residual, b.residual);
        EXPECT_EQ(a.unshot, b.unshot);
        EXPECT_EQ(a.solver_error, b.solver_error);
        EXPECT_EQ(a.error_estimate, b.error_estimate);
        EXPECT_TRUE(same_bits(a.element_error, b.element_error));
        EXPECT_EQ(a.converged, b.converged);
        EXPECT_EQ(a.blocks_recomputed, b.blocks_recomputed);
        EXPECT_EQ(a.seconds, 0.0);
    }
}

TEST_F(CaseFolderTest, solution_so_far_comes_back_exactly_for_its_key_and_goes_when_the_solution_is_written) {
    const std::vector<double> some{0.1, -2.0 / 3.0, 1e-300};
    const model::SolverState state{.reflected = {some, {1.0, 2.0, 3.0}},
                                   .irradiance = {{4.0, 5.0, 6.0}, some},
                                   .mode = {some, {7.0, 8.0, 9.0}, {0.25}, {0.5}},
                                   .frames_since_exact = 17};
    model::Solution solution = support::example_solution();
    solution.frames.back().seconds = 0.125;
    folder.write_solution_so_far(solution, state, "one key");
    EXPECT_FALSE(folder.read_solution_so_far("another key").has_value());
    const auto read = folder.read_solution_so_far("one key");
    ASSERT_TRUE(read.has_value());
    ASSERT_EQ(read->solution.frames.size(), solution.frames.size());
    EXPECT_TRUE(same_bits(read->solution.frames.back().radiosity, solution.frames.back().radiosity));
    EXPECT_EQ(read->solution.frames.back().seconds, 0.125);
    EXPECT_EQ(read->state.reflected, state.reflected);
    EXPECT_EQ(read->state.irradiance, state.irradiance);
    EXPECT_EQ(read->state.mode.shape, state.mode.shape);
    EXPECT_EQ(read->state.mode.image, state.mode.image);
    EXPECT_EQ(read->state.mode.margin, state.mode.margin);
    EXPECT_EQ(read->state.mode.second, state.mode.second);
    EXPECT_EQ(read->state.frames_since_exact, 17u);
    folder.write_solution(solution);
    EXPECT_FALSE(folder.read_solution_so_far("one key").has_value());
}

TEST_F(CaseFolderTest, coefficients_so_far_come_back_for_their_key_and_go_when_the_whole_is_written) {
    model::Coefficients whole = support::example_coefficients();
    whole.hierarchy = {};
    folder.write_coefficients_so_far({.coefficients = whole, .rows = 1}, "one key");
    EXPECT_FALSE(folder.read_coefficients_so_far("another key").has_value());
    const auto read = folder.read_coefficients_so_far("one key");
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(read->rows, 1u);
    EXPECT_EQ(read->coefficients.static_blocks.values, whole.static_blocks.values);
    EXPECT_EQ(read->coefficients.moving_pairs, whole.moving_pairs);
    folder.write_coefficients_so_far({.coefficients = whole, .rows = 1000}, "one key");
    EXPECT_THROW(folder.read_coefficients_so_far("one key"), core::FileError);
    folder.write_coefficients(whole);
    EXPECT_FALSE(folder.read_coefficients_so_far("one key").has_value());
}

TEST_F(CaseFolderTest, same_data_gives_the_same_bytes) {
    std::vector<std::string> first;
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
        if (entry.is_regular_file()) paths.push_back(entry.path());
    first.reserve(paths.size());
    for (const auto& path : paths) first.push_back(bytes_of(path));
    ASSERT_EQ(paths.size(), 11u); // six files, clean.vtm with two meshes, patches.vtu, clusters.vtu
    SetUp();
    for (std::size_t k = 0; k < paths.size(); ++k) EXPECT_TRUE(bytes_of(paths[k]) == first[k]) << paths[k];
}

TEST_F(CaseFolderTest, truncated_files_are_refused_by_name) {
    for (const std::string& file : files) {
        const std::string whole = bytes_of(folder.file(file));
        const std::size_t step = std::max<std::size_t>(whole.size() / 60, 1);
        for (std::size_t length = 0; length < whole.size() - 1; length += length < 64 ? 7 : step) {
            put_bytes(folder.file(file), whole.substr(0, length));
            const std::string error = error_of(file);
            EXPECT_NE(error.find(file), std::string::npos)
                << file << " cut to " << length << ": '" << error << "'";
            EXPECT_NE(error.find("again"), std::string::npos) << error;
            EXPECT_EQ(error.find('\n'), std::string::npos) << error;
        }
        put_bytes(folder.file(file), whole);
        EXPECT_EQ(error_of(file), "");
    }
}

TEST_F(CaseFolderTest, damaged_bytes_are_refused_in_hdf5_and_never_crash) {
    for (const std::string& file : files) {
        const std::string whole = bytes_of(folder.file(file));
        for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 100) {
            std::string damaged = whole;
            damaged[at] = static_cast<char>(damaged[at] ^ 0x5A);
            put_bytes(folder.file(file), damaged);
            const std::string error = error_of(file);
            const bool may_pass =
                file.ends_with(".json") || (at >= 60 && at < 512); // a name; padding of the user block
            EXPECT_TRUE(may_pass || error.find(file) != std::string::npos)
                << file << " byte " << at << ": " << error;
        }
        put_bytes(folder.file(file), whole);
    }
}

TEST_F(CaseFolderTest, missing_file_names_the_stage_that_makes_it) {
    for (const std::string& file : files) {
        const std::string whole = bytes_of(folder.file(file));
        std::filesystem::remove(folder.file(file));
        const std::string error = error_of(file);
        EXPECT_NE(error.find(file + ": missing; run kinelux-"), std::string::npos) << error;
        put_bytes(folder.file(file), whole);
    }
}

TEST_F(CaseFolderTest, file_of_a_newer_version_is_refused) {
    std::string text = bytes_of(folder.file("plan.json"));
    text.replace(text.find("\"version\": 1"), 12, "\"version\": 2");
    put_bytes(folder.file("plan.json"), text);
    const std::string error = error_of("plan.json");
    EXPECT_NE(error.find("format version 2"), std::string::npos) << error;
    EXPECT_NE(error.find("kinelux-plan"), std::string::npos) << error;
}

TEST_F(CaseFolderTest, file_of_another_kind_is_refused) {
    put_bytes(folder.file("clusters.h5"), bytes_of(folder.file("patches.h5")));
    EXPECT_NE(error_of("clusters.h5").find("its format is 'kinelux-patches'"), std::string::npos);
    put_bytes(folder.file("plan.json"), "[1, 2]");
    EXPECT_NE(error_of("clusters.h5"), "");
    EXPECT_NE(error_of("plan.json"), "");
}

TEST_F(CaseFolderTest, file_made_from_something_else_is_refused_with_all_that_follows) {
    model::ClusterTree other = support::example_clusters();
    other.element_size = 7.0;
    folder.write_clusters(other, support::example_patches());
    EXPECT_EQ(error_of("patches.h5"), "");
    EXPECT_EQ(error_of("clusters.h5"), "");
    for (const std::string file : {"plan.json", "coefficients.h5", "solution.h5"}) {
        const std::string error = error_of(file);
        EXPECT_NE(
            error.find("plan.json: made from another clusters.h5 than lies beside it; run kinelux-plan"),
            std::string::npos)
            << error;
    }
}

TEST_F(CaseFolderTest, changed_mesh_is_refused) {
    const auto mesh = folder.file("clean/floor_main.vtp");
    const std::string whole = bytes_of(mesh);
    put_bytes(mesh, whole.substr(0, whole.size() - 30));
    EXPECT_NE(error_of("scene.json").find("'clean/floor_main.vtp' is not the mesh"), std::string::npos);
    std::filesystem::remove(mesh);
    EXPECT_NE(error_of("scene.json").find("floor_main.vtp"), std::string::npos);
}

TEST_F(CaseFolderTest, inconsistent_content_is_refused) {
    model::Coefficients broken = support::example_coefficients();
    broken.static_blocks.entries[1].offset = 1000;
    folder.write_coefficients(broken);
    EXPECT_NE(error_of("coefficients.h5").find("ends beyond"), std::string::npos);
    broken = support::example_coefficients();
    broken.hierarchy.groups[0].second = 3;
    folder.write_coefficients(broken);
    EXPECT_NE(error_of("coefficients.h5").find("cannot be a child"), std::string::npos);
}

TEST_F(CaseFolderTest, objects_get_distinct_file_names_and_old_ones_go) {
    model::Scene scene = support::example_scene();
    scene.objects[0].name = "A/b";
    scene.objects[1].name = "a:B";
    folder.write_scene(scene);
    EXPECT_TRUE(std::filesystem::exists(folder.file("clean/A_b.vtp")));
    EXPECT_TRUE(std::filesystem::exists(folder.file("clean/a_B_2.vtp")));
    EXPECT_FALSE(std::filesystem::exists(folder.file("clean/floor_main.vtp")));
    EXPECT_EQ(folder.read_scene().objects[1].name, "a:B");
}

TEST_F(CaseFolderTest, empty_lists_come_back) {
    model::PatchSet only_small = support::example_patches();
    only_small.patches.clear();
    folder.write_patches(only_small, support::example_scene());
    EXPECT_TRUE(folder.read_patches().patches.empty());
    model::PatchSet no_small = support::example_patches();
    no_small.small = {};
    folder.write_patches(no_small, support::example_scene());
    EXPECT_TRUE(folder.read_patches().small.triangles.empty());
    EXPECT_EQ(folder.read_patches().patches.size(), 2u);
}

TEST(CaseFolder, folder_that_is_a_file_is_refused) {
    const support::TemporaryFolder temporary;
    put_bytes(temporary.path() / "file", "");
    EXPECT_THROW(CaseFolder(temporary.path() / "file"), core::FileError);
    EXPECT_THROW(CaseFolder(temporary.path() / "nothing"), core::FileError);
    EXPECT_NO_THROW(CaseFolder(temporary.path() / "new" / "case", true));
}

} // namespace kinelux::io
