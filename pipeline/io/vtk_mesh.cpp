// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vtk_mesh.h"

#include <fstream>
#include <type_traits>

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedIntArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include "core/error.h"
#include "core/run_record.h"

namespace kinelux::io {

namespace {

template <class Value>
struct VtkArrayOf;
template <>
struct VtkArrayOf<float> {
    using Type = vtkFloatArray;
};
template <>
struct VtkArrayOf<double> {
    using Type = vtkDoubleArray;
};
template <>
struct VtkArrayOf<std::int32_t> {
    using Type = vtkIntArray;
};
template <>
struct VtkArrayOf<std::uint32_t> {
    using Type = vtkUnsignedIntArray;
};
template <>
struct VtkArrayOf<std::uint8_t> {
    using Type = vtkUnsignedCharArray;
};

/// Keeps what VTK would print, so that a damaged file gives one line of ours instead of a page of VTK's.
class QuietWindow : public vtkOutputWindow {
public:
    vtkTypeMacro(QuietWindow, vtkOutputWindow) static QuietWindow* New();
    void DisplayText(const char* /*text*/) override { ++messages_; } // NOLINT: VTK's name
    int messages() const { return messages_; }

private:
    int messages_ = 0;
};
vtkStandardNewMacro(QuietWindow)

    /// While it lives, VTK's errors and warnings are counted instead of printed.
    class CapturedErrors {
public:
    CapturedErrors() : previous_(vtkOutputWindow::GetInstance()) {
        vtkOutputWindow::SetInstance(window_);
        vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    }
    ~CapturedErrors() {
        vtkLogger::SetStderrVerbosity(
            vtkLogger::VERBOSITY_INFO); // VTK's default; there is no way to ask what it was
        vtkOutputWindow::SetInstance(previous_);
    }
    CapturedErrors(const CapturedErrors&) = delete;
    CapturedErrors& operator=(const CapturedErrors&) = delete;
    bool any() const { return window_->messages() > 0; }

private:
    vtkNew<QuietWindow> window_;
    vtkSmartPointer<vtkOutputWindow> previous_;
};

/// A VTK array that looks at our values; VTK's interface wants them mutable but the writers only read.
template <class Value>
vtkSmartPointer<vtkDataArray> borrowed(const VtkArray& array, std::span<const Value> values) {
    vtkNew<typename VtkArrayOf<Value>::Type> result;
    result->SetName(array.name.c_str());
    result->SetNumberOfComponents(static_cast<int>(array.components));
    constexpr int keep = 1; // VTK must not free them
    result->SetArray(const_cast<Value*>(values.data()), static_cast<vtkIdType>(values.size()), keep);
    for (std::size_t c = 0; c < array.component_names.size(); ++c)
        result->SetComponentName(static_cast<vtkIdType>(c), array.component_names[c].c_str());
    return result.Get();
}

void add_arrays(vtkDataSetAttributes* attributes, const std::vector<VtkArray>& arrays) {
    for (const VtkArray& array : arrays)
        attributes->AddArray(std::visit([&](auto values) { return borrowed(array, values); }, array.values));
}

vtkSmartPointer<vtkPoints> make_points(std::span<const Vec3> points, PointPrecision precision) {
    vtkNew<vtkPoints> result;
    if (precision == PointPrecision::Double) {
        vtkNew<vtkDoubleArray> values;
        values->SetNumberOfComponents(3);
        constexpr int keep = 1;
        values->SetArray(const_cast<double*>(points.empty() ? nullptr : &points.front().x),
                         static_cast<vtkIdType>(points.size()) * 3, keep);
        result->SetData(values);
        return result.Get();
    }
    result->SetDataTypeToFloat();
    result->SetNumberOfPoints(static_cast<vtkIdType>(points.size()));
    float* out = static_cast<float*>(result->GetVoidPointer(0));
    for (const Vec3& point : points)
        for (int axis = 0; axis < 3; ++axis) *out++ = static_cast<float>(point[axis]);
    return result.Get();
}

/// 32-bit indices: half the bytes of VTK's default.
vtkSmartPointer<vtkCellArray> make_cells(std::span<const model::Triangle> triangles) {
    vtkNew<vtkTypeInt32Array> offsets, corners;
    offsets->SetNumberOfValues(static_cast<vtkIdType>(triangles.size()) + 1);
    corners->SetNumberOfValues(static_cast<vtkIdType>(triangles.size()) * 3);
    vtkTypeInt32* corner = corners->GetPointer(0);
    for (const model::Triangle& triangle : triangles)
        for (const std::uint32_t index : triangle) *corner++ = static_cast<vtkTypeInt32>(index);
    for (std::size_t t = 0; t <= triangles.size(); ++t)
        offsets->SetValue(static_cast<vtkIdType>(t), static_cast<vtkTypeInt32>(3 * t));
    vtkNew<vtkCellArray> cells;
    cells->SetData(offsets, corners);
    return cells.Get();
}

void add_fields(vtkDataSet* data, const VtkTriangles& triangles) {
    if (triangles.time_s) {
        vtkNew<vtkDoubleArray> time;
        time->SetName("TimeValue");
        time->InsertNextValue(*triangles.time_s);
        data->GetFieldData()->AddArray(time);
    }
    for (const auto& [name, values] : triangles.names) {
        vtkNew<vtkStringArray> list;
        list->SetName(name.c_str());
        for (const std::string& value : values) list->InsertNextValue(value);
        data->GetFieldData()->AddArray(list);
    }
}

std::string to_xml(vtkXMLWriter* writer, vtkDataSet* data, const VtkTriangles& triangles) {
    add_arrays(data->GetPointData(), triangles.point_arrays);
    add_arrays(data->GetCellData(), triangles.cell_arrays);
    add_fields(data, triangles);
    writer->SetInputDataObject(data);
    writer->SetDataModeToBinary();
    writer->SetCompressorTypeToZLib();
    writer->SetCompressionLevel(1); // higher levels cost several times the time for a tenth of the size
    writer->WriteToOutputStringOn();
    writer->Write();
    return writer->GetOutputString();
}

core::FileError damaged(const std::filesystem::path& file, const std::string& what) {
    return core::FileError(fmt::format("{}: {}", file.string(), what));
}

/// A whole VTK XML file ends with its closing tag; readers of VTK stumble over one that does not in many ways.
void require_whole(const std::filesystem::path& file) {
    constexpr std::string_view closing = "</VTKFile>";
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    if (!in || std::filesystem::is_directory(file)) throw damaged(file, "cannot be read; does it exist?");
    const std::streamoff size = in.tellg();
    std::string tail(static_cast<std::size_t>(std::min<std::streamoff>(size, 16)), '\0');
    in.seekg(size - static_cast<std::streamoff>(tail.size()));
    in.read(tail.data(), static_cast<std::streamsize>(tail.size()));
    if (!in || tail.find(closing) == std::string::npos)
        throw damaged(file, "truncated or not a VTK XML file");
}

template <class Reader>
vtkSmartPointer<vtkPointSet> read_with(const std::filesystem::path& file) {
    const CapturedErrors errors;
    vtkNew<Reader> reader;
    reader->SetFileName(file.c_str());
    reader->Update();
    if (errors.any() || reader->GetErrorCode() != 0 || reader->GetOutput() == nullptr ||
        reader->GetOutput()->GetPoints() == nullptr)
        throw damaged(file, "damaged, or not the VTK XML file that its name says");
    return reader->GetOutput();
}

vtkCellArray* cells_of(vtkPointSet* data) {
    if (auto* grid = vtkUnstructuredGrid::SafeDownCast(data)) return grid->GetCells();
    return vtkPolyData::SafeDownCast(data)->GetPolys();
}

std::vector<model::Triangle> read_triangles(const std::filesystem::path& file, vtkPointSet* data) {
    vtkCellArray* cells = cells_of(data);
    if (cells == nullptr || cells->GetNumberOfCells() != data->GetNumberOfCells())
        throw damaged(file, "holds cells that are no triangles");
    std::vector<model::Triangle> triangles(static_cast<std::size_t>(cells->GetNumberOfCells()));
    vtkIdType count = 0;
    const vtkIdType* corners = nullptr;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        cells->GetCellAtId(static_cast<vtkIdType>(t), count, corners);
        if (count != 3) throw damaged(file, "holds cells that are no triangles");
        for (int k = 0; k < 3; ++k) {
            if (corners[k] < 0 || corners[k] >= data->GetNumberOfPoints())
                throw damaged(file, fmt::format("triangle {} names a point that is not there", t));
            triangles[t][static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(corners[k]);
        }
    }
    return triangles;
}

template <class Value>
VtkValues<Value> read_array(const std::filesystem::path& file, vtkDataSetAttributes* attributes,
                            const std::string& name) {
    vtkDataArray* array = attributes->GetArray(name.c_str());
    if (array == nullptr) throw damaged(file, fmt::format("array '{}' is missing", name));
    VtkValues<Value> result;
    result.components = static_cast<std::uint32_t>(array->GetNumberOfComponents());
    for (int c = 0; c < array->GetNumberOfComponents(); ++c)
        result.component_names.emplace_back(
            array->GetComponentName(c) == nullptr ? "" : array->GetComponentName(c));
    result.values.reserve(static_cast<std::size_t>(array->GetNumberOfValues()));
    for (vtkIdType item = 0; item < array->GetNumberOfTuples(); ++item)
        for (int c = 0; c < array->GetNumberOfComponents(); ++c)
            result.values.push_back(static_cast<Value>(array->GetComponent(item, c)));
    return result;
}

} // namespace

void write_vtk(const std::filesystem::path& file, const VtkTriangles& triangles) {
    const auto points = make_points(triangles.points, triangles.precision);
    const auto cells = make_cells(triangles.triangles);
    if (file.extension() == ".vtp") {
        vtkNew<vtkPolyData> data;
        data->SetPoints(points);
        data->SetPolys(cells);
        core::write_whole_file(file, to_xml(vtkNew<vtkXMLPolyDataWriter>(), data, triangles));
    } else {
        vtkNew<vtkUnstructuredGrid> data;
        data->SetPoints(points);
        data->SetCells(VTK_TRIANGLE, cells);
        core::write_whole_file(file, to_xml(vtkNew<vtkXMLUnstructuredGridWriter>(), data, triangles));
    }
}

VtkContent read_vtk(const std::filesystem::path& file, const VtkWanted& wanted) {
    require_whole(file);
    const vtkSmartPointer<vtkPointSet> data = file.extension() == ".vtp"
                                                  ? read_with<vtkXMLPolyDataReader>(file)
                                                  : read_with<vtkXMLUnstructuredGridReader>(file);
    VtkContent content;
    content.points.resize(static_cast<std::size_t>(data->GetNumberOfPoints()));
    for (std::size_t p = 0; p < content.points.size(); ++p)
        data->GetPoint(static_cast<vtkIdType>(p), &content.points[p].x);
    content.triangles = read_triangles(file, data);
    for (const std::string& name : wanted.cell_arrays)
        content.cell_arrays.push_back(read_array<std::uint32_t>(file, data->GetCellData(), name));
    for (const std::string& name : wanted.point_arrays)
        content.point_arrays.push_back(read_array<float>(file, data->GetPointData(), name));
    return content;
}

std::string xml_escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
        case '&': result += "&amp;"; break;
        case '<': result += "&lt;"; break;
        case '>': result += "&gt;"; break;
        case '"': result += "&quot;"; break;
        default: result += static_cast<unsigned char>(c) < ' ' ? '?' : c;
        }
    }
    return result;
}

} // namespace kinelux::io
