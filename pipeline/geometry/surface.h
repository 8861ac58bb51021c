// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/vec.h"
#include "geometry/pose.h"
#include "model/patch_set.h"

namespace kinelux::geometry {

/// A point of a parametric surface.
struct SurfaceJet {
    Vec3 position;      ///< [m]
    Vec3 normal;        ///< unit, to the front
    double area_factor; ///< dA / (du dv)
};

/// A point of a parametric surface with its derivatives by u and v.
struct SurfaceTangents {
    Vec3 position; ///< [m]
    Vec3 along_u;  ///< [m per unit of u]
    Vec3 along_v;  ///< [m per unit of v]
};

/// Position and derivatives, which every surface has also where it has no normal.
/// @throws GeometryError  a B-spline whose sizes do not fit
SurfaceTangents surface_tangents(const model::Surface& surface, const Vec2& uv);

/// Evaluates any surface type at (u,v); see model::Surface for the parametrisations.
/// @throws GeometryError  a B-spline whose sizes do not fit, or a point where the surface has no normal
SurfaceJet evaluate(const model::Surface& surface, const Vec2& uv);

/// The same; where the surface has no normal (a pole, an apex), from a millionth of the way to a point inside.
/// @throws GeometryError  as evaluate(), of the point inside
SurfaceJet evaluate_towards(const model::Surface& surface, const Vec2& uv, const Vec2& inside);

/// Position alone, which every surface has also where it has no normal (poles, tips, collapsed edges) [m].
/// @throws GeometryError  a B-spline whose sizes do not fit
Vec3 position(const model::Surface& surface, const Vec2& uv);

/// The same surface elsewhere: position(moved(s, pose), uv) = pose.point(position(s, uv)).
model::Surface moved(const model::Surface& surface, const Pose& pose);

/// Parameters of the point of a plane nearest to x. @param surface  a Plane
Vec2 plane_parameters(const model::Surface& surface, const Vec3& x);

/// Area of a patch [m2]: exact on planes, cylinders and cones, to rounding on spheres and tori whose triangles span half
/// a turn of v or less, by a rule of degree 20 per triangle on the others.
double area(const model::Patch& patch);
/// Area of all small triangles [m2].
double area(const model::SmallTriangles& small);

} // namespace kinelux::geometry
