// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/element_shape.h"

namespace kinelux::kernel {

/// What clear_far_block reads of an element, close together in memory; made once per element, which must outlive it.
struct FlatEnd {
    explicit FlatEnd(const geometry::ElementShape& element);

    const geometry::ElementShape* shape;
    bool planar;
    Vec3 normal{0.0};    ///< unit, to the front
    double offset = 0.0; ///< of the plane along it [m]
    /// Per rule the nodes' x, y, z [m] and weights [m2], each `stride` numbers one after another from `start` on; weights beyond `count` are 0.
    struct Rule {
        std::size_t start = 0, count = 0, stride = 0;
    };
    std::array<Rule, geometry::rule_levels> rules;
    std::vector<double> nodes;
};

/// The block of two flat elements, each wholly in front of the other, that are far enough apart for ready rules and have
/// nothing between: what transport() makes of them, without its searches and its memory. On a plane cos(x, y) r is the
/// other point's height over it, so that of a pair of nodes only r^4 is left to compute.
/// @param tolerance  as TransportOptions::tolerance
/// @param values     size(a) x size(b), row-major, overwritten where there is a result [1]
/// @return  the estimated error of the values [1]; nothing where the pair is not of that kind
std::optional<double> clear_far_block(const FlatEnd& a, const FlatEnd& b, double tolerance,
                                      std::span<double> values);

/// The same of two flat elements with constant functions that are close, touch, or cross each other's horizon: by the
/// double contour integral. @param value  0 where they do not see each other [1]
std::optional<double> clear_near_block(const geometry::ElementShape& a, const geometry::ElementShape& b,
                                       double tolerance, double& value);

} // namespace kinelux::kernel
