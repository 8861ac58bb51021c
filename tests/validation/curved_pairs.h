// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/element_shape.h"

namespace kinelux::validation {

/// What an element is made of.
enum class ElementKind : std::uint8_t { Cylinder, Cone, Sphere, Torus, Bilinear, BSpline, Cluster, Planar };
constexpr std::array<std::string_view, 8> element_kind_names{"cylinder", "cone",    "sphere",  "torus",
                                                             "bilinear", "bspline", "cluster", "planar"};

/// How two elements lie to each other.
enum class Place : std::uint8_t {
    Far,       ///< 1.5 to 6 sizes apart
    Near,      ///< 0.02 to 1 size apart
    Touching,  ///< a corner of one on the other
    Neighbour, ///< two parts of one surface, or of one body of small triangles, with a common edge
    Itself,
};
constexpr std::array<std::string_view, 5> place_names{"far", "near", "touching", "neighbour", "itself"};

/// A pair of which one element at least is not planar.
struct CurvedRecipe {
    ElementKind a = ElementKind::Cylinder, b = ElementKind::Planar; ///< neighbours: of a's kind
    Place place = Place::Far;
    std::uint64_t seed = 1;
};

/// The `index`-th recipe of a series: kinds and places in turn.
CurvedRecipe curved_recipe(std::uint64_t index, std::uint64_t seed);

struct CurvedPair {
    geometry::ElementShape a, b;
    bool itself = false; ///< b is a
};
CurvedPair make_curved_pair(const CurvedRecipe& recipe);

/// One block of kernel::transport beside its reference; all norms Frobenius, relative to the block (at least to 1e-3 of
/// the largest that elements of such areas can have).
struct CurvedJudgement {
    CurvedRecipe recipe;
    int degree_a = 0, degree_b = 0;
    double error = 0.0, estimate = 0.0;
    double uncertainty =
        0.0; ///< of the reference: difference between the integrals from either side, or its estimate
             ///< where the element faces itself
    double norm = 0.0;                             ///< not relative [1]
    double seconds = 0.0, reference_seconds = 0.0; ///< of wall time
    double proved_error() const { return error > uncertainty ? error - uncertainty : 0.0; }
};
CurvedJudgement judge_curved(const CurvedRecipe& recipe, double tolerance);

/// A table by kinds and places, and the worst pairs.
std::string curved_report(std::span<const CurvedJudgement> judgements, double tolerance, std::size_t worst);

} // namespace kinelux::validation
