// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::model {

/// A triangulation of all elements on which fields are shown: vertices are shared inside a patch or cluster, never
/// across. Positions are at rest; a frame moves the vertices of each object by its pose. Frames may have meshes of
/// their own.
struct DisplayMesh {
    std::vector<Vec3> points;     ///< [m], at rest
    std::vector<Vec3> normals;    ///< unit, one per point
    std::vector<Vec2> parameters; ///< u, v on its patch, one per point; of no meaning in a cluster
    std::vector<Triangle> triangles;
    std::vector<ElementId> elements;          ///< one per triangle
    std::vector<ObjectId> objects;            ///< one per triangle; triangles are sorted by object
    std::vector<MaterialId> materials;        ///< one per triangle
    std::vector<std::int32_t> patches;        ///< one per triangle; -1 in a cluster
    std::vector<std::int32_t> clusters;       ///< one per triangle; -1 in a patch
    std::vector<std::uint8_t> degrees;        ///< one per triangle: degree of the element's basis
    std::vector<std::uint32_t> point_objects; ///< one per point: its object
};

/// Named values at the points or triangles of a DisplayMesh, value of item i, component c at [i * components + c].
struct NamedArray {
    std::string name; ///< with unit, e.g. "Irradiance_lx"
    std::uint32_t components = 1;
    std::vector<std::string> component_names; ///< e.g. channels; empty or one per component
    std::vector<float> values;
};

/// One frame as it is exported.
struct SurfaceFields {
    double time_s = 0.0;
    std::vector<Vec3> points; ///< moved, one per DisplayMesh point [m]
    std::vector<NamedArray> point_arrays;
    std::vector<NamedArray> cell_arrays;
};

/// One row of meters.csv.
struct MeterReading {
    std::uint32_t frame = 0;
    double time_s = 0.0;
    std::string meter;    ///< object or grid name
    std::string quantity; ///< "radiosity", "irradiance", "flux", ...
    std::string channel;
    double value = 0.0;
    std::string unit;
    double error_estimate = 0.0; ///< same unit
};

} // namespace kinelux::model
