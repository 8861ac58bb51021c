// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "model/patch_set.h"
#include "model/scene.h"

namespace kinelux::fit {

struct FitOptions {
    double distance_tolerance =
        1e-4; ///< of the scene's size: a face may be this far from its patch [1], 0..0.1
    double normal_tolerance_deg = 5.0; ///< a face may be turned this far against its patch [deg], 0..45
    double min_patch_area =
        1e-4; ///< of the scene's area: smaller round patches, and facets of curved surfaces, stay triangles [1], 0..1
    double round_face_turn_deg =
        24.0; ///< faces of a round patch turn this far from one to the next at most; 0: no round patches [deg], 0..30
    double contact_tolerance =
        1e-5; ///< of the scene's size: what is this near to a patch touches it [1], 0..1e-2
    double small_triangle_edge =
        0.05; ///< of the scene's size: longer edges of small triangles are halved [1], > 0
};

struct FitResult {
    model::PatchSet patches;
    std::uint64_t faces_in_patches = 0, faces_left_small = 0; ///< of the clean meshes
    std::uint64_t contact_cuts =
        0; ///< patches divided along lines where another body of the same motion touches
    std::uint64_t covered_patches =
        0; ///< left out: a smaller surface lies in the same plane, in front of them
    std::uint64_t overlapping =
        0; ///< charts whose faces overlap each other: taken as they are, without contact cuts
    double covered_area = 0.0;       ///< of the patches left out [m2]
    std::uint64_t round_patches = 0; ///< cylinders, cones, spheres and tori among the patches
    double deviation_max = 0.0;      ///< of corners of faces from their patches, over all patches [m]
    double chord_max = 0.0; ///< of centroids of faces from the round patches that take their place [m]
    double area_in = 0.0,
           area_out = 0.0; ///< clean meshes (two-sided faces twice) and patches + small triangles [m2];
                           ///< they differ by covered_area, by what projection onto planes takes and by what
                           ///< arcs are longer than their chords
};

/// Gathers the faces of each object into planar charts by region growing and fits a plane to each; a chart becomes a
/// trimmed patch (outer loop and holes exactly along the mesh edges, projected). Of charts that are facets of curved
/// surfaces, faces that lie on one cylinder, cone, sphere or torus become a trimmed patch of it; what else is curved stays
/// small triangles.
/// Patches are divided along the lines where other bodies at rest relative to them touch or cross them, so that the
/// covered and the open part never share an element; a patch below a smaller one in the same plane that faces the same
/// way (a lamp's panel in a ceiling) loses what is covered. The scene's size is the diagonal of the bounds of what is
/// at rest.
/// @throws GeometryError  no face has area
FitResult fit_patches(const model::Scene& clean_scene, const FitOptions& options);

} // namespace kinelux::fit
