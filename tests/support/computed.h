// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "coefficients/coefficients.h"
#include "support/shapes.h"

namespace kinelux::support {

/// Elements and blocks of a scene at rest, every patch cut into n x n elements.
struct Computed {
    std::vector<geometry::ElementShape> shapes;
    model::Coefficients coefficients;
};

inline Computed compute(const model::PatchSet& set, const model::Scene& scene, int n, int degree) {
    Computed result;
    result.shapes = shapes_of(set, n, degree);
    const auto occluders = occluders_of(set, scene);
    result.coefficients = coefficients::compute_coefficients(result.shapes, scene, {.degree = degree},
                                                             occluders, {.tolerance = 1e-3}, 1e6);
    return result;
}

} // namespace kinelux::support
