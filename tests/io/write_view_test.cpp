// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_view.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/example_case.h"
#include "io/temporary_folder.h"

namespace kinelux::io {

namespace {

using support::bytes_of;

/// The display mesh of two rectangles, one per object of example_scene().
model::DisplayMesh two_rectangles(const model::Scene& scene) {
    model::DisplayMesh mesh;
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        const model::Mesh& source = scene.objects[o].mesh;
        const auto first = static_cast<std::uint32_t>(mesh.points.size());
        mesh.points.insert(mesh.points.end(), source.points.begin(), source.points.end());
        mesh.normals.resize(mesh.points.size(), model::triangle_normal(source, 0));
        mesh.point_objects.resize(mesh.points.size(), static_cast<std::uint32_t>(o));
        for (const auto& [a, b, c] : source.triangles)
            mesh.triangles.push_back({first + a, first + b, first + c});
        mesh.elements.resize(mesh.triangles.size(), ElementId(o));
        mesh.objects.resize(mesh.triangles.size(), ObjectId(o));
        mesh.materials.resize(mesh.triangles.size(), source.materials[0]);
        mesh.patches.resize(mesh.triangles.size(), static_cast<std::int32_t>(o));
        mesh.clusters.resize(mesh.triangles.size(), -1);
        mesh.degrees.resize(mesh.triangles.size(), 2);
    }
    return mesh;
}

model::SurfaceFields uniform_fields(const model::DisplayMesh& mesh, const model::Scene& scene, double time_s,
                                    float level) {
    model::SurfaceFields fields;
    fields.time_s = time_s;
    fields.points = mesh.points;
    model::NamedArray irradiance{"Irradiance_lx", 3, scene.channels, {}},
        radiosity{"Radiosity_lm_m2", 3, scene.channels, {}};
    for (std::size_t p = 0; p < mesh.points.size(); ++p)
        for (int c = 0; c < 3; ++c) {
            irradiance.values.push_back(level + static_cast<float>(p));
            radiosity.values.push_back(p < 4 ? level : 1000.0f * level);
        }
    fields.point_arrays = {irradiance, radiosity};
    fields.cell_arrays = {{"Level", 1, {}, std::vector<float>(mesh.triangles.size(), level)}};
    return fields;
}

class WriteViewTest : public testing::Test {
protected:
    void write(const std::filesystem::path& folder) const {
        ViewWriter writer(folder, scene);
        for (std::uint32_t frame = 0; frame < 3; ++frame)
            writer.write_frame(frame, mesh,
                               uniform_fields(mesh, scene, scene.time.time_of_frame(frame),
                                              10.0f + static_cast<float>(frame)));
        EXPECT_FALSE(std::filesystem::exists(folder / "view.pvd"));
        writer.finish();
    }

    support::TemporaryFolder temporary;
    const model::Scene scene = support::example_scene();
    const model::DisplayMesh mesh = two_rectangles(scene);
};

} // namespace

TEST_F(WriteViewTest, frames_come_back_as_written) {
    write(temporary.path());
    for (std::uint32_t f = 0; f < 3; ++f) {
        const auto wanted = uniform_fields(mesh, scene, 0.0, 10.0f + static_cast<float>(f));
        const auto file = temporary.path() / "frames" / ("frame_000" + std::to_string(f) + ".vtu");
        const ExportedFrame frame = read_frame(file, scene.quantity);
        EXPECT_EQ(frame.points, mesh.points); // small numbers of which floats hold every bit
        EXPECT_EQ(frame.triangles, mesh.triangles);
        EXPECT_EQ(frame.objects, (std::vector<std::uint32_t>{0, 0, 1, 1}));
        EXPECT_EQ(frame.irradiance.name, "Irradiance_lx");
        EXPECT_EQ(frame.irradiance.components, 3u);
        EXPECT_EQ(frame.irradiance.component_names, scene.channels);
        EXPECT_EQ(frame.irradiance.values, wanted.point_arrays[0].values);
    }
}

TEST_F(WriteViewTest, index_names_every_frame_with_its_time) {
    write(temporary.path());
    const std::string index = bytes_of(temporary.path() / "view.pvd");
    EXPECT_NE(index.find("timestep=\"0\" group=\"\" part=\"0\" file=\"frames/frame_0000.vtu\""),
              std::string::npos)
        << index;
    EXPECT_NE(index.find("timestep=\"0.15000000000000002\""), std::string::npos) << index;
    EXPECT_NE(index.find("timestep=\"0.30000000000000004\""), std::string::npos) << index;
}

TEST_F(WriteViewTest, same_fields_give_the_same_bytes) {
    write(temporary.path() / "a");
    write(temporary.path() / "b");
    for (const std::string name : {"view.pvd", "view.py", "frames/frame_0000.vtu", "frames/frame_0002.vtu"})
        EXPECT_TRUE(bytes_of(temporary.path() / "a" / name) == bytes_of(temporary.path() / "b" / name))
            << name;
}

TEST_F(WriteViewTest, truncated_frames_are_refused) {
    write(temporary.path());
    const auto file = temporary.path() / "frames" / "frame_0000.vtu";
    const std::string whole = bytes_of(file);
    for (std::size_t length = 0; length < whole.size() - 11; length += 1 + length / 8) {
        support::put_bytes(file, whole.substr(0, length));
        EXPECT_THROW(read_frame(file, scene.quantity), core::FileError) << length;
        // A lost middle with the end in place.
        support::put_bytes(file, whole.substr(0, length) + "\n</VTKFile>\n");
        EXPECT_THROW(read_frame(file, scene.quantity), core::FileError) << length;
    }
    EXPECT_THROW(read_frame(temporary.path() / "nothing.vtu", scene.quantity), core::FileError);
}

TEST_F(WriteViewTest, frame_without_the_irradiance_of_this_quantity_is_refused) {
    write(temporary.path());
    EXPECT_THROW(read_frame(temporary.path() / "frames" / "frame_0000.vtu", model::Quantity::Radiometric),
                 core::FileError);
}

TEST_F(WriteViewTest, view_script_names_no_path_but_its_own) {
    write(temporary.path());
    const std::string script = bytes_of(temporary.path() / "view.py");
    EXPECT_EQ(script.find(temporary.path().string()), std::string::npos);
    EXPECT_NE(script.find("Irradiance_lx"), std::string::npos);
    EXPECT_NE(script.find("Lampe \\u00e4 \\u0027x\\u0027"), std::string::npos);
}

TEST(WriteMeters, numbers_are_shortest_and_names_are_quoted_where_needed) {
    const support::TemporaryFolder temporary;
    const std::vector<model::MeterReading> readings{
        {0, 0.1, "desk", "irradiance", "red", 123.456, "lx", 0.1 + 0.2},
        {12, 1e-9, "a, \"b\"", "flux", "green", -0.0, "lm", 1e300}};
    write_meters(temporary.path() / "meters.csv", readings);
    EXPECT_EQ(bytes_of(temporary.path() / "meters.csv"),
              "frame,time_s,meter,quantity,channel,value,unit,error_estimate\n"
              "0,0.1,desk,irradiance,red,123.456,lx,0.30000000000000004\n"
              "12,1e-09,\"a, \"\"b\"\"\",flux,green,-0,lm,1e+300\n");
}

} // namespace kinelux::io
