// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "fit/charts.h"
#include "fit/domain.h"
#include "fit/faces.h"

namespace kinelux::fit {

/// A chart where it lies in the scene.
struct PlacedChart {
    const Body* body = nullptr;
    const Chart* chart = nullptr;
    std::optional<MotionId> motion; ///< charts touch for good only if they move together
    bool emits = false;
    bool patch = false;       ///< becomes a patch, not small triangles
    Vec3 low{0.0}, high{0.0}; ///< axis-aligned bounds [m]
};

/// Another chart in the same plane that takes the place of what it covers.
struct Cover {
    std::size_t chart = 0;
    bool front = false; ///< covers the front side,
    bool back = false;  ///< the back side
};

/// Finds where charts of a scene touch and cross each other.
class Contacts {
public:
    explicit Contacts(const std::vector<PlacedChart>& charts);

    /// Segments in which faces of other charts touch or cross a chart's plane, near its domain.
    /// @param tolerance  a corner this near to the plane lies in it [m]
    std::vector<std::array<Vec2, 2>> segments(std::size_t chart, const FlatChart& flat,
                                              double tolerance) const;

    /// Charts in the same plane that take precedence: the smaller, then the emitting, then the earlier one.
    std::vector<Cover> covers(std::size_t chart, const FlatChart& flat, double tolerance) const;

    /// Whether a point of a chart's plane lies in another chart of that plane.
    bool lies_in(const FlatChart& flat, const Vec2& point, std::size_t other) const;

private:
    std::vector<std::size_t> near(std::size_t chart, double tolerance) const;

    const std::vector<PlacedChart>& charts_;
    std::vector<std::size_t> by_low_x_;
};

} // namespace kinelux::fit
