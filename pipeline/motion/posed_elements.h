// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "model/plan.h"

namespace kinelux::motion {

/// The elements of moving bodies in their place at one time; all others stay as they are at rest.
class PosedElements {
public:
    /// @param rest    in order of ElementId; must outlive this
    /// @param poses   world_from_rest, one per object
    /// @param wanted  one per element: 0 = is not asked for, may stay at rest; empty: all are
    PosedElements(std::span<const geometry::ElementShape> rest, const model::Plan& plan,
                  std::span<const geometry::Pose> poses, std::span<const std::uint8_t> wanted = {});

    const geometry::ElementShape& operator[](std::size_t element) const {
        return index_[element] == none ? rest_[element] : moved_[index_[element]];
    }
    std::span<const geometry::ElementShape> moving() const { return moved_; }

private:
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    std::span<const geometry::ElementShape> rest_;
    std::vector<std::size_t> index_;
    std::vector<geometry::ElementShape> moved_;
};

} // namespace kinelux::motion
