// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "fit/charts.h"
#include "fit/faces.h"
#include "model/patch_set.h"

namespace kinelux::fit {

/// Adds the faces of a chart to the small triangles, two-sided ones twice. Edges longer than `longest_edge` are halved,
/// from both of their sides alike, so that clusters can be as small as they should be.
void add_small_triangles(const Body& body, const Chart& chart, double longest_edge,
                         model::SmallTriangles& small);

} // namespace kinelux::fit
