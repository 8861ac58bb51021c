// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <new>
#include <optional>
#include <set>

#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Poly_Triangulation.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include "core/error.h"
#include "io/mesh_import.h"

namespace kinelux::io {

namespace {

// Facets may be this far from the exact surface, of the size of the whole model, and turned by this angle.
constexpr double chord_share = 2e-4;
constexpr double facet_angle_rad = 0.15;
constexpr double metres_per_mm = 1e-3; // OpenCASCADE converts every file's unit to millimetres

// A part with its place and colour on the way down the assembly.
struct Place {
    TopLoc_Location location;
    std::vector<std::string> names;
    std::optional<Quantity_Color> colour; ///< of the nearest instance above that has one
};

std::string name_of(const TDF_Label& label) {
    Handle(TDataStd_Name) name;
    if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
    std::string text(static_cast<std::size_t>(name->Get().LengthOfCString()) + 1, '\0');
    Standard_PCharacter buffer = text.data();
    text.resize(static_cast<std::size_t>(name->Get().ToUTF8CString(buffer)));
    return text;
}

class CadReader {
public:
    CadReader(const MeshFile& file, const Handle(TDocStd_Document) & document)
        : file_(file),
          shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
          colours_(XCAFDoc_DocumentTool::ColorTool(document->Main())),
          collector_(file.channels) {}

    ImportedMeshes read() {
        TDF_LabelSequence roots;
        shapes_->GetFreeShapes(roots);
        Bnd_Box bounds;
        for (const TDF_Label& root : roots) BRepBndLib::Add(XCAFDoc_ShapeTool::GetShape(root), bounds, false);
        if (bounds.IsVoid()) throw core::GeometryError(file_.name() + ": holds no faces");
        deflection_mm_ = chord_share * std::sqrt(bounds.SquareExtent());
        for (const TDF_Label& root : roots) visit(root, {}, 0);
        result_.metres_per_unit = metres_per_mm;
        result_.unit_stated = true;
        result_.notes.push_back("exact surfaces are divided into facets, at most " +
                                shortest(deflection_mm_ * metres_per_mm) + " m and " +
                                shortest(facet_angle_rad * 180.0 / M_PI) + " degrees off");
        if (unmeshed_ > 0)
            result_.notes.push_back(std::to_string(unmeshed_) +
                                    " faces without a surface or with broken boundaries are left out");
        collector_.finish(result_);
        return std::move(result_);
    }

private:
    static std::string shortest(double value) {
        std::array<char, 32> text{};
        std::snprintf(text.data(), text.size(), "%.2g", value);
        return text.data();
    }

    void visit(const TDF_Label& label, Place place, int depth) {
        constexpr int deepest = 1000;
        if (depth > deepest) throw core::FileError(file_.name() + ": its assembly is nested too deeply");
        TDF_Label part = label;
        if (!place.colour) place.colour = colour_of(label);
        if (XCAFDoc_ShapeTool::GetReferredShape(label, part)) {
            place.location = place.location * XCAFDoc_ShapeTool::GetLocation(label);
            if (!place.colour) place.colour = colour_of(part);
        }
        // An instance goes by its own name, unless that is a number that the exporter has made up.
        std::string own = name_of(label), of_part = name_of(part);
        if (own.starts_with("NAUO")) std::swap(own, of_part);
        for (const std::string& name : {of_part, own})
            if (!name.empty() && (place.names.empty() || place.names.back() != name))
                place.names.push_back(name);
        TDF_LabelSequence components;
        if (XCAFDoc_ShapeTool::IsAssembly(part) && XCAFDoc_ShapeTool::GetComponents(part, components)) {
            for (const TDF_Label& component : components) visit(component, place, depth + 1);
            return;
        }
        add_object(XCAFDoc_ShapeTool::GetShape(part), place);
    }

    std::optional<Quantity_Color> colour_of(const TDF_Label& label) const {
        Quantity_Color colour;
        for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
            if (colours_->GetColor(label, type, colour)) return colour;
        return std::nullopt;
    }

    std::optional<Quantity_Color> colour_of(const TopoDS_Shape& shape) const {
        Quantity_Color colour;
        for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
            if (colours_->GetColor(shape, type, colour)) return colour;
        return std::nullopt;
    }

    MaterialId material_of(const std::optional<Quantity_Color>& colour) {
        if (!colour) return collector_.default_grey();
        Vec3 rgb(0.0);
        colour->Values(rgb.x, rgb.y, rgb.z, Quantity_TOC_RGB);
        std::array<char, 64> name{};
        std::snprintf(name.data(), name.size(), "colour %.3g %.3g %.3g", rgb.x, rgb.y, rgb.z);
        const auto known = materials_.find(name.data());
        if (known != materials_.end()) return known->second;
        return materials_[name.data()] = collector_.add(name.data(), rgb, Vec3(0.0), model::Sides::Auto);
    }

    void add_object(const TopoDS_Shape& shape, const Place& place) {
        if (shape.IsNull()) return;
        // Facets of faces that share an edge share its points.
        const BRepMesh_IncrementalMesh facets(shape, deflection_mm_, false, facet_angle_rad, false);
        static_cast<void>(facets); // they are in the shape now
        model::Object object;
        std::map<std::array<double, 3>, std::uint32_t> known;
        for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next())
            append(TopoDS::Face(faces.Current()), place, known, object.mesh);
        if (object.mesh.triangles.empty()) return;
        std::vector<std::string> names = place.names;
        const std::string own = names.empty() ? file_.path.stem().string() : names.back();
        object.name = unique_name(own, taken_);
        object.source = file_.name() + ":" + own;
        names.push_back(object.name);
        result_.objects.push_back(std::move(object));
        result_.groups.push_back(std::move(names));
    }

    void append(const TopoDS_Face& face, const Place& place,
                std::map<std::array<double, 3>, std::uint32_t>& known, model::Mesh& mesh) {
        const std::uint32_t number = face_++;
        TopLoc_Location own;
        const Handle(Poly_Triangulation) facets = BRep_Tool::Triangulation(face, own);
        if (facets.IsNull()) {
            ++unmeshed_;
            return;
        }
        const gp_Trsf to_world = (place.location * own).Transformation();
        std::vector<std::uint32_t> numbers;
        for (int i = 1; i <= facets->NbNodes(); ++i) {
            const gp_Pnt at = facets->Node(i).Transformed(to_world);
            const auto [entry, is_new] =
                known.try_emplace({at.X(), at.Y(), at.Z()}, static_cast<std::uint32_t>(mesh.points.size()));
            if (is_new) mesh.points.emplace_back(at.X(), at.Y(), at.Z());
            numbers.push_back(entry->second);
        }
        std::optional<Quantity_Color> colour = colour_of(face);
        const MaterialId material = material_of(colour ? colour : place.colour);
        const bool turned = (face.Orientation() == TopAbs_REVERSED) != to_world.IsNegative();
        for (int i = 1; i <= facets->NbTriangles(); ++i) {
            int a = 0, b = 0, c = 0;
            facets->Triangle(i).Get(a, b, c);
            if (turned) std::swap(b, c);
            const model::Triangle triangle{numbers[static_cast<std::size_t>(a) - 1],
                                           numbers[static_cast<std::size_t>(b) - 1],
                                           numbers[static_cast<std::size_t>(c) - 1]};
            if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
                continue; // at a pole or an apex
            mesh.triangles.push_back(triangle);
            mesh.materials.push_back(material);
            mesh.source_faces.push_back(number);
        }
    }

    const MeshFile& file_;
    Handle(XCAFDoc_ShapeTool) shapes_;
    Handle(XCAFDoc_ColorTool) colours_;
    MaterialCollector collector_;
    ImportedMeshes result_;
    std::map<std::string, MaterialId> materials_;
    std::set<std::string> taken_;
    double deflection_mm_ = 0.0;
    std::uint32_t face_ = 0;
    std::size_t unmeshed_ = 0;
};

template <typename Reader>
Handle(TDocStd_Document) transferred(const MeshFile& file, Reader& reader) {
    const auto fail = [&](const char* reason) {
        throw core::FileError(file.name() + ": cannot be read as a CAD model: " + reason);
    };
    reader.SetColorMode(true);
    reader.SetNameMode(true);
    if (reader.ReadFile(file.name().c_str()) != IFSelect_RetDone)
        fail("it is truncated or not of this format");
    Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
    if (!reader.Transfer(document)) fail("none of its shapes can be made");
    return document;
}

} // namespace

ImportedMeshes read_cad(const MeshFile& file, CadFormat format) {
    Message::DefaultMessenger()->ChangePrinters().Clear(); // nothing on our terminal
    try {
        if (format == CadFormat::Iges) {
            IGESCAFControl_Reader reader;
            return CadReader(file, transferred(file, reader)).read();
        }
        STEPCAFControl_Reader reader;
        return CadReader(file, transferred(file, reader)).read();
    } catch (const Standard_OutOfMemory&) {
        throw std::bad_alloc();
    } catch (const Standard_Failure& failure) {
        throw core::FileError(file.name() + ": cannot be read as a CAD model: " + failure.GetMessageString());
    }
}

} // namespace kinelux::io
