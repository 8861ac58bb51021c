// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "geometry/pose.h"
#include "model/scene.h"
#include "model/surface_field.h"
#include "sample/sampler.h"

namespace kinelux::sample {

/// The facet of an element that is nearest to a point; on a plane, where any gives the parameters, the largest.
const geometry::Facet& facet_at(const geometry::ElementShape& element, const Vec3& x);

/// A receiver on a display mesh. Its shadow rays start a little inside the triangles around it, so that a corner of a
/// wall is not on both sides of the next one, and, on a bent surface, above the planes of these triangles and of the
/// facets of their clusters, or the chords of their curved patches, which are what casts shadows: so none of them is
/// in the way.
/// @param x, normal   [m], unit; at rest
/// @param around      triangles of the mesh that meet there; none: rays start at the point
/// @param clearance   least height over its own bent surface [m]: Occluders::end_offset()
Receiver receiver_on(const model::DisplayMesh& mesh, std::span<const geometry::ElementShape> rest_elements,
                     const Vec3& x, const Vec3& normal, std::span<const std::uint32_t> around,
                     double clearance);

/// The receiver where its object is in a pose.
Receiver moved(const Receiver& rest, const geometry::Pose& pose);

/// Elements that emit, where their objects are. @param poses  one per object
std::vector<geometry::ElementShape> moved_sources(std::span<const geometry::ElementShape> rest_elements,
                                                  const model::Scene& scene,
                                                  std::span<const geometry::Pose> poses);

} // namespace kinelux::sample
