// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "visibility/occluders.h"

namespace kinelux::test {

/// Two triangles over the parallelogram at `corner`; its front is edge_u x edge_v.
inline visibility::Body parallelogram(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v,
                                      bool moves = false) {
    visibility::Body body;
    body.points = {corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v};
    body.triangles = {{0, 1, 2}, {0, 2, 3}};
    body.moves = moves;
    return body;
}

/// The square [-half, half]^2 at height z, facing up.
inline visibility::Body level_square(double half, double z, bool moves = false) {
    return parallelogram({-half, -half, z}, {2.0 * half, 0.0, 0.0}, {0.0, 2.0 * half, 0.0}, moves);
}

} // namespace kinelux::test
