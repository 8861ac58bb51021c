// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/vec.h"

namespace kinelux::model {

enum class SurfaceType : std::uint8_t { Plane, Cylinder, Cone, Sphere, Torus, BSpline, Bilinear };

/// A tensor-product rational B-spline surface.
struct BSpline {
    std::uint32_t degree_u = 0, degree_v = 0;
    std::uint32_t count_u = 0, count_v = 0; ///< poles along u and v
    std::vector<double> knots_u, knots_v;   ///< count + degree + 1 each, non-decreasing
    std::vector<Vec3> poles;                ///< count_u * count_v, u fastest [m]
    std::vector<double> weights;            ///< same size, > 0; empty = 1
};

/// A parametric surface x(u,v) in a right-handed orthonormal frame (axis_u, axis_v, axis_w) at origin:
///   Plane     origin + u axis_u + v axis_v                                         u, v [m]
///   Cylinder  origin + radius e(u) + v axis_w                                      u [rad], v [m]
///   Cone      origin + (radius + v tan(half_angle)) e(u) + v axis_w                u [rad], v [m]
///   Sphere    origin + radius (cos v e(u) + sin v axis_w)                          u, v [rad]
///   Torus     origin + (radius + minor_radius cos v) e(u) + minor_radius sin v axis_w
/// with e(u) = cos u axis_u + sin u axis_v; two use no frame:
///   BSpline   its own poles
///   Bilinear  (1-u)(1-v) corners[0] + u(1-v) corners[1] + uv corners[2] + (1-u)v corners[3]   u, v [1]
/// The normal is x_u x x_v, times `orientation`.
struct Surface {
    SurfaceType type = SurfaceType::Plane;
    Vec3 origin{0.0};
    Vec3 axis_u{1.0, 0.0, 0.0}, axis_v{0.0, 1.0, 0.0}, axis_w{0.0, 0.0, 1.0};
    double radius = 0.0;       ///< [m]
    double minor_radius = 0.0; ///< [m]
    double half_angle_rad = 0.0;
    double orientation = 1.0; ///< +1 or -1
    BSpline bspline;          ///< only for BSpline
    std::array<Vec3, 4>
        corners{}; ///< only for Bilinear, counter-clockwise seen from the front at orientation 1 [m]
};

/// @param where  starts the message, e.g. the patch's number
/// @throws GeometryError  a number is not finite, or the orientation is neither 1 nor -1
void check(const Surface& surface, const std::string& where);

} // namespace kinelux::model
