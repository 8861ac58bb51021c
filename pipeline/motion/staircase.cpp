// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/staircase.h"

#include <cmath>

namespace kinelux::motion {

namespace {

std::array<Vec3, axis_count> make_axes() {
    constexpr std::array<std::array<int, 3>, axis_count> directions{{{1, 0, 0},
                                                                     {0, 1, 0},
                                                                     {0, 0, 1},
                                                                     {1, 1, 0},
                                                                     {1, -1, 0},
                                                                     {1, 0, 1},
                                                                     {1, 0, -1},
                                                                     {0, 1, 1},
                                                                     {0, 1, -1},
                                                                     {1, 1, 1},
                                                                     {1, 1, -1},
                                                                     {1, -1, 1},
                                                                     {1, -1, -1}}};
    std::array<Vec3, axis_count> axes;
    for (std::size_t a = 0; a < axis_count; ++a)
        axes[a] = glm::normalize(Vec3(directions[a][0], directions[a][1], directions[a][2]));
    return axes;
}

} // namespace

const std::array<Vec3, axis_count>& predefined_axes() {
    static const std::array<Vec3, axis_count> axes = make_axes();
    return axes;
}

void Staircase::follow(const Vec3& target, int moves, double negligible) {
    const auto& axes = predefined_axes();
    for (int move = 0; move < moves; ++move) {
        const Vec3 left = target - position_;
        if (!(glm::length(left) > negligible)) return;
        std::size_t nearest = 0;
        for (std::size_t a = 1; a < axis_count; ++a)
            if (std::abs(glm::dot(left, axes[a])) > std::abs(glm::dot(left, axes[nearest]))) nearest = a;
        const double step = glm::dot(left, axes[nearest]);
        steps_[nearest] += step;
        position_ += step * axes[nearest];
    }
}

double Staircase::length() const {
    double sum = 0.0;
    for (const double step : steps_) sum += std::abs(step);
    return sum;
}

} // namespace kinelux::motion
