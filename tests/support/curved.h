// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>

#include "model/patch_set.h"

namespace kinelux::support {

/// A surface of radius 1, minor radius 0.25 and half angle 0.3 whose frame is in no special position.
inline model::Surface tilted_surface(model::SurfaceType type, double orientation = 1.0) {
    model::Surface s;
    s.type = type;
    s.origin = {0.4, -0.7, 0.2};
    s.axis_u = Vec3(1.0, 2.0, 2.0) / 3.0;
    s.axis_v = Vec3(2.0, 1.0, -2.0) / 3.0;
    s.axis_w = Vec3(-2.0, 2.0, -1.0) / 3.0;
    s.radius = 1.0;
    s.minor_radius = 0.25;
    s.half_angle_rad = 0.3;
    s.orientation = orientation;
    s.corners = {Vec3(0, 0, 0), Vec3(1, 0, 0.3), Vec3(1.2, 1, 0), Vec3(0, 0.9, 0.4)};
    return s;
}

/// The part of a surface over a rectangle of its parameters.
inline model::Patch surface_patch(const model::Surface& surface, const Vec2& low, const Vec2& high) {
    model::Patch patch;
    patch.surface = surface;
    patch.points = {low, {high.x, low.y}, high, {low.x, high.y}};
    patch.triangles = {{0, 1, 2}, {0, 2, 3}};
    patch.loops = {{0, 1, 2, 3}};
    return patch;
}

/// A whole sphere of a surface's frame and radius, seam and poles included.
inline model::Patch whole_sphere(double orientation = 1.0) {
    return surface_patch(tilted_surface(model::SurfaceType::Sphere, orientation),
                         {0.0, -0.5 * std::numbers::pi}, {2.0 * std::numbers::pi, 0.5 * std::numbers::pi});
}

/// A quarter of a disc about the z axis as a rational surface: u the angle, v the distance from the axis, both in 0..1.
/// @param facing  +1: up
inline model::Patch quarter_disc(double radius, double height, int quarter, double facing) {
    model::Surface s;
    s.type = model::SurfaceType::BSpline;
    s.orientation = -facing;
    s.bspline = {.degree_u = 2, .degree_v = 1, .count_u = 3, .count_v = 2};
    s.bspline.knots_u = {0, 0, 0, 1, 1, 1};
    s.bspline.knots_v = {0, 0, 1, 1};
    const double turn = 0.5 * std::numbers::pi * quarter;
    const Vec3 x(std::cos(turn), std::sin(turn), 0.0), y(-x.y, x.x, 0.0), centre(0.0, 0.0, height);
    for (int v = 0; v < 2; ++v)
        for (const Vec3& corner : {x, x + y, y}) s.bspline.poles.push_back(centre + v * radius * corner);
    s.bspline.weights = {1.0, std::sqrt(0.5), 1.0, 1.0, std::sqrt(0.5), 1.0};
    return surface_patch(s, {0, 0}, {1, 1});
}

} // namespace kinelux::support
