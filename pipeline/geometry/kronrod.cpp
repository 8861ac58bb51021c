// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/kronrod.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace kinelux::geometry {

namespace {

// Half of a symmetric rule, from the outermost node to the middle one; every second node is of the Gauss rule.
template <std::size_t Half>
struct HalfRule {
    std::array<double, Half> nodes, weights, gauss_weights;
};

template <std::size_t Half>
struct WholeRule {
    std::array<double, 2 * Half - 1> nodes, weights, gauss_weights;

    explicit WholeRule(const HalfRule<Half>& half) {
        for (std::size_t i = 0; i < Half; ++i) {
            const std::size_t mirrored = 2 * Half - 2 - i;
            nodes[i] = -half.nodes[i];
            nodes[mirrored] = half.nodes[i];
            weights[i] = weights[mirrored] = half.weights[i];
            gauss_weights[i] = gauss_weights[mirrored] = half.gauss_weights[i];
        }
    }
};

} // namespace

const KronrodRule& kronrod_7() {
    static const WholeRule<4> whole(
        {{0.960491268708020283, 0.774596669241483377, 0.434243749346802558, 0.0},
         {0.104656226026467265, 0.268488089868333441, 0.401397414775962223, 0.450916538658474142},
         {0.0, 5.0 / 9.0, 0.0, 8.0 / 9.0}});
    static const KronrodRule rule{whole.nodes, whole.weights, whole.gauss_weights};
    return rule;
}

const KronrodRule& kronrod_15() {
    static const WholeRule<8> whole(
        {{0.991455371120812640, 0.949107912342758525, 0.864864423359769073, 0.741531185599394440,
          0.586087235467691130, 0.405845151377397167, 0.207784955007898468, 0.0},
         {0.022935322010529225, 0.063092092629978553, 0.104790010322250184, 0.140653259715525919,
          0.169004726639267903, 0.190350578064785410, 0.204432940075298892, 0.209482141084727828},
         {0.0, 0.129484966168869693, 0.0, 0.279705391489276668, 0.0, 0.381830050505118945, 0.0,
          0.417959183673469388}});
    static const KronrodRule rule{whole.nodes, whole.weights, whole.gauss_weights};
    return rule;
}

double kronrod_error(double difference, double size) {
    constexpr double caution = 200.0, power = 1.5, rounding = 10.0 * std::numeric_limits<double>::epsilon();
    constexpr double least = 0.2; // of the difference: at kinks the Kronrod rule gains no more than that
    if (!(size > 0.0)) return difference;
    const double estimate = size * std::pow(caution * difference / size, power);
    return std::max({std::min(difference, estimate), least * difference, rounding * size});
}

} // namespace kinelux::geometry
