// SPDX-License-Identifier: GPL-3.0-or-later
// CAD files that the tests write by OpenCASCADE, with areas and volumes known exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include <unistd.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <IGESCAFControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include "core/error.h"
#include "io/read_mesh.h"
#include "io/rehearse.h"
#include "io/temporary_folder.h"

namespace kinelux::io {
namespace {

namespace fs = std::filesystem;

/// A document whose shapes get names and colours.
class Drawing {
public:
    Drawing() : document_(new TDocStd_Document("BinXCAF")) {
        Message::DefaultMessenger()->ChangePrinters().Clear();
        shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
        colours_ = XCAFDoc_DocumentTool::ColorTool(document_->Main());
    }
    TDF_Label add(const TopoDS_Shape& shape, const char* name) {
        const TDF_Label label = shapes_->AddShape(shape, false);
        TDataStd_Name::Set(label, name);
        return label;
    }
    TDF_Label assembly(const char* name) {
        const TDF_Label label = shapes_->NewShape();
        TDataStd_Name::Set(label, name);
        return label;
    }
    void put(const TDF_Label& assembly, const TDF_Label& part, const gp_Vec& by, const char* name) {
        gp_Trsf move;
        move.SetTranslation(by);
        put(assembly, part, move, name);
    }
    void put(const TDF_Label& assembly, const TDF_Label& part, const gp_Trsf& move, const char* name) {
        TDataStd_Name::Set(shapes_->AddComponent(assembly, part, TopLoc_Location(move)), name);
    }
    void colour(const TDF_Label& label, double red, double green, double blue) {
        colours_->SetColor(label, Quantity_Color(red, green, blue, Quantity_TOC_RGB), XCAFDoc_ColorSurf);
    }
    fs::path write_step(const fs::path& file, const char* unit = "MM") {
        shapes_->UpdateAssemblies();
        STEPCAFControl_Writer writer;
        Interface_Static::SetCVal("write.step.unit", unit);
        writer.SetNameMode(true);
        writer.SetColorMode(true);
        EXPECT_TRUE(writer.Transfer(document_));
        EXPECT_EQ(writer.Write(file.c_str()), IFSelect_RetDone);
        Interface_Static::SetCVal("write.step.unit", "MM");
        return file;
    }
    fs::path write_iges(const fs::path& file) {
        IGESCAFControl_Writer writer;
        EXPECT_TRUE(writer.Transfer(document_));
        EXPECT_TRUE(writer.Write(file.c_str()));
        return file;
    }

private:
    Handle(TDocStd_Document) document_;
    Handle(XCAFDoc_ShapeTool) shapes_;
    Handle(XCAFDoc_ColorTool) colours_;
};

double volume(const model::Mesh& mesh) {
    double sum = 0.0;
    for (const model::Triangle& t : mesh.triangles)
        sum += glm::dot(mesh.points[t[0]], glm::cross(mesh.points[t[1]], mesh.points[t[2]])) / 6.0;
    return sum;
}

/// Edges that do not lie between two triangles.
std::size_t open_edges(const model::Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
    for (const model::Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) ++count[std::minmax(t[k], t[(k + 1) % 3])];
    return static_cast<std::size_t>(
        std::count_if(count.begin(), count.end(), [](const auto& edge) { return edge.second != 2; }));
}

TEST(ReadCad, solids_have_their_area_and_volume_and_are_closed) {
    const support::TemporaryFolder folder;
    const double pi = std::numbers::pi;
    struct Solid {
        const char* name;
        TopoDS_Shape shape;
        double area, volume; // [mm2], [mm3]
    };
    const TopoDS_Shape box = BRepPrimAPI_MakeBox(100.0, 200.0, 300.0);
    const TopoDS_Shape drill =
        BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(50, 100, -10), gp_Dir(0, 0, 1)), 20.0, 400.0);
    for (const Solid& solid :
         {Solid{"box", box, 220000.0, 6e6},
          Solid{"cylinder", BRepPrimAPI_MakeCylinder(50.0, 100.0), pi * 15000.0, pi * 250000.0},
          Solid{"sphere", BRepPrimAPI_MakeSphere(50.0), pi * 10000.0, pi * 500000.0 / 3.0},
          Solid{"drilled", BRepAlgoAPI_Cut(box, drill), 220000.0 - 800.0 * pi + 12000.0 * pi,
                6e6 - 120000.0 * pi}}) {
        SCOPED_TRACE(solid.name);
        Drawing drawing;
        drawing.add(solid.shape, solid.name);
        const ImportedMeshes step = read_mesh(drawing.write_step(folder.path() / "solid.step"), 3);
        ASSERT_EQ(step.objects.size(), 1u);
        EXPECT_EQ(step.objects[0].name, solid.name);
        EXPECT_TRUE(step.unit_stated);
        EXPECT_EQ(step.metres_per_unit, 1e-3);
        const model::Mesh& mesh = step.objects[0].mesh;
        EXPECT_EQ(open_edges(mesh), 0u);
        EXPECT_NEAR(model::area(mesh), solid.area, 5e-3 * solid.area);
        EXPECT_NEAR(volume(mesh), solid.volume, 1e-2 * solid.volume);
        const ImportedMeshes iges = read_mesh(drawing.write_iges(folder.path() / "solid.igs"), 3);
        double area = 0.0;
        for (const model::Object& object : iges.objects) area += model::area(object.mesh);
        EXPECT_NEAR(area, solid.area, 5e-3 * solid.area);
    }
}

TEST(ReadCad, instances_have_names_places_and_colours) {
    const support::TemporaryFolder folder;
    Drawing drawing;
    const TDF_Label leg = drawing.add(BRepPrimAPI_MakeBox(10.0, 10.0, 70.0), "leg");
    const TDF_Label top = drawing.add(BRepPrimAPI_MakeBox(100.0, 60.0, 2.0), "top");
    drawing.colour(leg, 0.5, 0.25, 0.125);
    const TDF_Label table = drawing.assembly("table");
    drawing.put(table, leg, gp_Vec(0, 0, 0), "leg left");
    drawing.put(table, leg, gp_Vec(90, 0, 0), "leg right");
    drawing.put(table, top, gp_Vec(0, 0, 70), "plate");
    const ImportedMeshes found = read_mesh(drawing.write_step(folder.path() / "table.stp"), 3);
    ASSERT_EQ(found.objects.size(), 3u);
    std::set<std::string> groups;
    double left = 1e9, highest = -1e9;
    for (std::size_t o = 0; o < 3; ++o) {
        groups.insert(found.groups[o].begin(), found.groups[o].end());
        for (const Vec3& point : found.objects[o].mesh.points) {
            left = std::min(left, point.x);
            highest = std::max(highest, point.z);
        }
        EXPECT_EQ(open_edges(found.objects[o].mesh), 0u);
        EXPECT_GT(volume(found.objects[o].mesh), 0.0);
    }
    EXPECT_NEAR(left, 0.0, 1e-9);
    EXPECT_NEAR(highest, 72.0, 1e-9);
    for (const char* name : {"table", "leg", "top", "leg left", "leg right", "plate"})
        EXPECT_TRUE(groups.contains(name)) << name;
    std::size_t coloured = 0;
    for (const model::Object& object : found.objects)
        for (const MaterialId id : object.mesh.materials) {
            const auto& rho = found.materials[id.value].reflectance;
            coloured += std::abs(rho[0] - 0.5) < 1e-3 && std::abs(rho[2] - 0.125) < 1e-3 ? 1 : 0;
        }
    EXPECT_EQ(coloured, 24u); // two boxes of 12
}

TEST(ReadCad, assemblies_in_assemblies_are_turned_and_moved_with_them) {
    const support::TemporaryFolder folder;
    Drawing drawing;
    const TDF_Label rod = drawing.add(BRepPrimAPI_MakeBox(100.0, 2.0, 1.0), "rod");
    const TDF_Label inner = drawing.assembly("inner"), outer = drawing.assembly("outer");
    gp_Trsf quarter; // takes x to y
    quarter.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), std::numbers::pi / 2.0);
    drawing.put(inner, rod, gp_Vec(10, 0, 0), "NAUO7"); // a name that exporters make up
    drawing.put(outer, inner, quarter, "arm");
    const ImportedMeshes found = read_mesh(drawing.write_step(folder.path() / "arm.step"), 3);
    ASSERT_EQ(found.objects.size(), 1u);
    EXPECT_EQ(found.objects[0].name, "rod");
    Vec3 low(1e9), high(-1e9);
    for (const Vec3& point : found.objects[0].mesh.points) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    EXPECT_LT(glm::distance(low, Vec3(-2, 10, 0)), 1e-9);
    EXPECT_LT(glm::distance(high, Vec3(0, 110, 1)), 1e-9);
    EXPECT_NEAR(volume(found.objects[0].mesh), 200.0, 1e-9);
    for (const char* name : {"outer", "inner", "arm", "rod"})
        EXPECT_TRUE(std::ranges::count(found.groups[0], name) > 0) << name;
}

TEST(ReadCad, inches_become_metres) {
    const support::TemporaryFolder folder;
    Drawing drawing;
    drawing.add(BRepPrimAPI_MakeBox(1.0, 1.0, 1.0), "inch"); // the writer relabels numbers and converts none
    const ImportedMeshes found = read_mesh(drawing.write_step(folder.path() / "inch.step", "INCH"), 3);
    EXPECT_NEAR(model::area(found.objects.at(0).mesh) * found.metres_per_unit * found.metres_per_unit,
                6.0 * 0.0254 * 0.0254, 1e-9);
}

TEST(ReadCad, broken_files_are_refused_with_a_reason) {
    const support::TemporaryFolder folder;
    Drawing drawing;
    drawing.add(BRepPrimAPI_MakeSphere(50.0), "sphere");
    const fs::path whole = drawing.write_step(folder.path() / "whole.step");
    std::ifstream in(whole, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const auto refused = [&](const std::string& content, const char* name) {
        std::ofstream(folder.path() / name, std::ios::binary) << content;
        try {
            read_mesh(folder.path() / name, 3);
            return std::string("read");
        } catch (const core::FileError& error) {
            return std::string(error.what());
        } catch (const core::GeometryError& error) {
            return std::string(error.what());
        }
    };
    for (const double part : {0.1, 0.3, 0.5, 0.7, 0.9})
        EXPECT_NE(refused(bytes.substr(0, static_cast<std::size_t>(part * static_cast<double>(bytes.size()))),
                          "cut.step"),
                  "read")
            << part;
    EXPECT_NE(refused("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n", "empty.step"),
              "read");
    EXPECT_NE(refused(std::string("ISO-10303-21;") + std::string(5000, '\x01'), "noise.step"), "read");
    EXPECT_NE(refused(std::string(5000, '\x7f'), "noise.iges"), "read");
}

TEST(Rehearse, turns_crashes_hangs_and_hunger_into_errors) {
    const auto message = [](const ImportLimits& limits, const std::function<void()>& import) {
        try {
            rehearse("file.xyz", limits, import);
            return std::string();
        } catch (const core::FileError& error) {
            return std::string(error.what());
        }
    };
    EXPECT_EQ(message({}, [] {}), "");
    EXPECT_EQ(message({}, [] { throw core::FileError("later"); }), "");
    EXPECT_TRUE(message({}, [] {
                    std::abort();
                }).starts_with("file.xyz: the library that reads this format crashes"));
    EXPECT_TRUE(message({.cpu_s = 1.0}, [] {
                    std::atomic<int> spins = 0;
                    for (;;) ++spins;
                }).starts_with("file.xyz: reading it takes longer than 1 s"));
    EXPECT_TRUE(message({.cpu_s = 0.25}, [] { pause(); }).starts_with("file.xyz: reading it takes longer"));
#if !defined(__SANITIZE_ADDRESS__)
    EXPECT_TRUE(message({.memory_gib = 0.5}, [] {
                    std::vector<std::string> all;
                    all.reserve(100);
                    for (int i = 0; i < 100; ++i) all.emplace_back(std::size_t{1} << 26, 'x');
                }).starts_with("file.xyz: reading it takes more than 0.5 GiB"));
#endif
}

} // namespace
} // namespace kinelux::io
