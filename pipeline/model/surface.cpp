// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/surface.h"

#include <cmath>
#include <string>

#include "core/error.h"

namespace kinelux::model {

namespace {

[[noreturn]] void fail(const std::string& where, const std::string& what) {
    throw core::GeometryError(where + ": " + what);
}

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

} // namespace

void check(const Surface& s, const std::string& where) {
    const bool numbers = finite(s.origin) && finite(s.axis_u) && finite(s.axis_v) && finite(s.axis_w) &&
                         std::isfinite(s.radius) && std::isfinite(s.minor_radius) &&
                         std::isfinite(s.half_angle_rad);
    if (!numbers) fail(where, "its surface has a number that is not finite");
    if (s.orientation != 1.0 && s.orientation != -1.0) fail(where, "its orientation is neither 1 nor -1");
    for (const Vec3& corner : s.corners) {
        if (!finite(corner)) fail(where, "a corner of its surface is not finite");
    }
    for (const Vec3& pole : s.bspline.poles) {
        if (!finite(pole)) fail(where, "a pole of its surface is not finite");
    }
}

} // namespace kinelux::model
