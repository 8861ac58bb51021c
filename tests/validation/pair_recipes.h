// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/vec.h"
#include "geometry/element_shape.h"

namespace kinelux::validation {

/// How two flat elements lie to each other.
enum class PairClass : std::uint8_t {
    Distant,  ///< two to eight sizes apart
    Close,    ///< a tenth to one size apart
    Hinge,    ///< a common edge, 5 to 170 degrees
    PartEdge, ///< edges on one line that overlap in part (T-junctions)
    Vertex,   ///< one common corner
    Facing,   ///< parallel or nearly so, gaps from 1e-9 to 1e-1, partly overlapping
    HingeGap, ///< a hinge that gapes by 1e-9 to 1e-2
    Horizon,  ///< apart, each or one crossing the other's plane
    Crossing, ///< interpenetrating
    Sliver,   ///< one element 30 to 1000 times as long as wide; close, hinged or facing
    TinyHuge, ///< sizes 10 to 1000 apart; close, touching or facing
    Frame,    ///< one element with a hole; close, hinged or facing
};
constexpr std::array<std::string_view, 12> pair_class_names{"distant",  "close",  "hinge",     "part-edge",
                                                            "vertex",   "facing", "hinge-gap", "horizon",
                                                            "crossing", "sliver", "tiny-huge", "frame"};

/// Everything a random pair is made from.
struct PairRecipe {
    PairClass kind = PairClass::Distant;
    std::uint64_t seed = 1;
    int degree = 0; ///< of both bases, 0..6
};

/// Where a pair stands: scale, then turn, then shift. Elements as the kinds describe them measure about 1 m.
struct Placement {
    double scale = 1.0;
    Vec3 axis_u{1.0, 0.0, 0.0}, axis_v{0.0, 1.0, 0.0}; ///< images of the axes x and y, orthonormal
    Vec3 origin{0.0};                                  ///< of the origin [m]
};

/// A pair in some place.
struct TestPair {
    geometry::ElementShape a, b;
    std::string what; ///< the kind's own figures: angle, gap, shapes
};

TestPair make_pair(const PairRecipe& recipe, const Placement& placement);

/// Turned, shifted and scaled at random.
TestPair make_pair(const PairRecipe& recipe);

/// The `index`-th recipe of a series: classes in turn, degrees 0 to 3 nine times of ten, else 4 to 6.
PairRecipe series_recipe(std::uint64_t index, std::uint64_t seed);

} // namespace kinelux::validation
