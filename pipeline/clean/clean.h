// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/scene.h"

namespace kinelux::clean {

struct CleanOptions {
    double merge_tolerance =
        1e-7; ///< points nearer than this times the object's size become one [1], 0..1e-3
    double stitch_tolerance =
        1e-5; ///< cracks and T-junctions narrower than this times the object's size are closed [1], 0..1e-2
};

/// What was done to one object; every count is faces or points of that object.
struct CleanReport {
    std::string object;
    std::uint64_t faces_in = 0, faces_out = 0;
    std::uint64_t points_in = 0, points_out = 0;
    std::uint64_t merged_points = 0;   ///< exact and near duplicates
    std::uint64_t duplicate_faces = 0; ///< removed: same corners, same direction
    std::uint64_t opposite_faces =
        0; ///< pairs with the same corners and opposite direction, made one two-sided face
    std::uint64_t degenerate_faces =
        0; ///< removed: no area; where one closed a gap its neighbour was divided
    std::uint64_t joined_points = 0, divided_edges = 0; ///< at borders, to close cracks and T-junctions
    double stitched_within = 0.0;                       ///< what moved most for it [m]
    std::uint64_t flipped_faces = 0;      ///< turned to agree with their neighbours or to face outwards
    std::uint64_t non_manifold_edges = 0; ///< kept, with their points doubled
    std::uint64_t boundary_edges = 0;     ///< after cleaning
    double gap_length = 0.0;              ///< of the edges along which its parts are open, slits aside [m]
    std::uint64_t self_intersections = 0; ///< pairs of faces, kept, listed only
    std::uint64_t crossing_faces = 0;     ///< faces that are in any of those pairs
    std::uint64_t two_sided_faces = 0;
    std::uint32_t parts = 0, closed_parts = 0; ///< connected components
    double area_in = 0.0, area_out = 0.0;      ///< [m2]
    double volume_out = 0.0;                   ///< of the closed parts [m3]
    std::vector<std::string> notes;            ///< sentences for the user
};

struct CleanResult {
    model::Scene scene; ///< same objects in the same order, meshes repaired, two_sided filled in
    std::vector<CleanReport> reports; ///< one per object
};

/// Repairs the meshes of a scene: merges points, drops duplicate and degenerate faces, turns the faces of each connected
/// part to agree, and decides the sides of each face:
///   Sides::Front  the front; a part with such faces faces the way most of their area does in the file
///   Sides::Both   both
///   Sides::Auto   open parts both; closed parts the outside, or the inside if they hold a lamp or other geometry or are
///                 all there is in the scene (a room)
/// Faces back to back become one two-sided face. Materials, names and the order of objects survive. Bodies whose motion
/// never changes their pose come to rest there, and bodies that keep their distance follow one motion (settle_motions):
/// every later stage relies on that. Never
/// removes area in silence: reports carry area before and after.
/// @throws GeometryError  an object has no face left, or a coordinate is not finite (names object and face)
CleanResult clean_scene(model::Scene scene, const CleanOptions& options);

} // namespace kinelux::clean
