// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"
#include "model/surface.h"

namespace kinelux::fit {

/// A place on a mesh with the direction of its face there.
struct FaceSample {
    Vec3 position; ///< centroid of the face [m]
    Vec3 normal;   ///< unit
    double area;   ///< [m2]
};

/// Distance of a point from a cylinder, cone, sphere or torus, positive outside [m].
double signed_distance(const model::Surface& surface, const Vec3& x);

/// Turns a surface's frame so that its w axis is along a direction; u and v follow from that alone.
void set_axis(model::Surface& surface, const Vec3& axis);

/// Parameters of the point of such a surface nearest to x; u in (-pi, pi], v of tori in (-pi, pi], of spheres in
/// [-pi/2, pi/2]. At poles, tips and on the axis u is 0.
Vec2 round_parameters(const model::Surface& surface, const Vec3& x);

/// The cylinder, sphere, cone and torus nearest to a piece of a mesh, in this order; what cannot be found is left out.
/// First guesses follow from the faces' directions: normals of a cylinder are square to its axis, and the normals of a
/// surface of revolution all meet its axis. Then the distances of the points are made least (Levenberg-Marquardt).
/// @param points   corners of the faces [m], at least 4
/// @param samples  the faces
/// @cite Pottmann, Wallner, Computational Line Geometry, section 4.3, for the axis of a surface of revolution
std::vector<model::Surface> nearest_round_surfaces(std::span<const Vec3> points,
                                                   std::span<const FaceSample> samples);

} // namespace kinelux::fit
