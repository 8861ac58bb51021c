// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/vec.h"

namespace kinelux::motion {

/// The predefined axes of the publication: through the 6 faces, 12 edges and 8 corners of a cube; opposite directions
/// share one.
constexpr std::size_t axis_count = 13;

/// The axes as unit vectors. @cite Biri et al. 2003, section 3.2.2 and figure 3
const std::array<Vec3, axis_count>& predefined_axes();

/// A walk that follows a path by moves along the predefined axes. What a move leaves behind is not forgotten: the next
/// one sets out from where the walk stands, not from the path.
class Staircase {
public:
    /// Follows the path to its next point by moves along the axis nearest to what is left, each as long as what is left
    /// reaches along it.
    /// @param target      displacement of the body since the walk began [m]
    /// @param moves       at most, >= 1; the publication makes one per frame
    /// @param negligible  no move for what is shorter [m], > 0
    void follow(const Vec3& target, int moves, double negligible);

    /// Signed way along each axis, opposite moves cancelling [m].
    std::span<const double, axis_count> steps() const { return steps_; }
    /// Where the walk stands: the sum of steps times axes [m].
    const Vec3& position() const { return position_; }
    /// Sum of the absolute steps [m]; at least the length of position().
    double length() const;

private:
    std::array<double, axis_count> steps_{};
    Vec3 position_{0.0};
};

} // namespace kinelux::motion
