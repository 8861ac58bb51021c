// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::io {

/// Values at the points or cells of a VtkTriangles, component fastest. They must outlive the writing: nothing is copied.
struct VtkArray {
    std::string name;
    std::uint32_t components = 1;
    std::vector<std::string> component_names{}; ///< empty or one per component
    std::variant<std::span<const float>, std::span<const double>, std::span<const std::int32_t>,
                 std::span<const std::uint32_t>, std::span<const std::uint8_t>>
        values{};
};

enum class PointPrecision { Single, Double };

/// Triangles with everything that a .vtp or .vtu file says about them.
struct VtkTriangles {
    std::span<const Vec3> points; ///< [m]
    std::span<const model::Triangle> triangles;
    PointPrecision precision = PointPrecision::Double;
    std::vector<VtkArray> point_arrays{}, cell_arrays{};
    std::optional<double> time_s{}; ///< written as TimeValue
    std::vector<std::pair<std::string, std::vector<std::string>>>
        names{}; ///< lists of names, kept as field data
};

/// Writes VTK XML (.vtp: poly data, .vtu: unstructured grid) aside and renames it. Inline binary with zlib: ParaView
/// 5.11 with Debian's expat cannot read VTK's default, appended data. The same data gives the same bytes.
/// @throws FileError  the file cannot be written
void write_vtk(const std::filesystem::path& file, const VtkTriangles& triangles);

/// An array read back, converted to Value.
template <class Value>
struct VtkValues {
    std::uint32_t components = 1;
    std::vector<std::string> component_names; ///< one per component
    std::vector<Value> values;
};

/// The triangles of a .vtp or .vtu file and those arrays that were asked for.
struct VtkContent {
    std::vector<Vec3> points;
    std::vector<model::Triangle> triangles;
    std::vector<VtkValues<std::uint32_t>> cell_arrays; ///< in the order asked for
    std::vector<VtkValues<float>> point_arrays;        ///< in the order asked for
};

/// Which arrays a reader cannot do without.
struct VtkWanted {
    std::vector<std::string> cell_arrays{}, point_arrays{};
};

/// @throws FileError  missing, truncated, not VTK XML, cells that are no triangles, an array that is not there
VtkContent read_vtk(const std::filesystem::path& file, const VtkWanted& wanted);

/// Text as it stands inside an XML attribute. Control characters, which XML does not know, become '?'.
std::string xml_escaped(const std::string& text);

} // namespace kinelux::io
