// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/posed_elements.h"

#include <algorithm>

namespace kinelux::motion {

PosedElements::PosedElements(std::span<const geometry::ElementShape> rest, const model::Plan& plan,
                             std::span<const geometry::Pose> poses, std::span<const std::uint8_t> wanted)
    : rest_(rest), index_(rest.size(), none) {
    for (const geometry::ElementShape& element : rest) {
        if (!wanted.empty() && wanted[element.id.value] == 0) continue;
        if (std::find(plan.moving_objects.begin(), plan.moving_objects.end(), element.object) ==
            plan.moving_objects.end())
            continue;
        index_[element.id.value] = moved_.size();
        moved_.push_back(geometry::moved(element, poses[element.object.value]));
    }
}

} // namespace kinelux::motion
