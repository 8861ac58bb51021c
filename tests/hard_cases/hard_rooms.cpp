// SPDX-License-Identifier: GPL-3.0-or-later
#include "hard_rooms.h"

#include <utility>

#include "support/closed_forms.h"
#include "support/planar_patches.h"
#include "support/shapes.h"

namespace kinelux::hard_cases {

namespace {

using model::Patch;
using support::Facing;
using support::rectangle;

constexpr double quadrature = 3e-3;   ///< three times the tolerance asked for
constexpr double hidden_share = 6e-3; ///< the same where things stand between

HardRoom room(std::string name, std::vector<Patch> patches, double bound) {
    HardRoom result{.name = std::move(name), .bound = bound};
    result.set.patches = std::move(patches);
    result.tree = support::whole_patch_elements(result.set);
    result.row_sums.assign(result.set.patches.size(), 1.0);
    return result;
}

std::vector<Patch> cube() { return support::box(Vec3(0), Vec3(1), Facing::Inwards); }

void append(std::vector<Patch>& patches, const std::vector<Patch>& more) {
    patches.insert(patches.end(), more.begin(), more.end());
}

HardRoom degree_six() {
    HardRoom result = room("cube, degree 6", cube(), quadrature);
    result.degree = 6;
    return result;
}

// The floor of a cube in two pieces at x = at, its wall at y = 0 in two at x = 1/3.
HardRoom divided(std::string name, double at) {
    std::vector<Patch> patches = cube();
    patches.erase(patches.begin());
    append(patches,
           {rectangle(Vec3(0), {at, 0, 0}, {0, 1, 0}), rectangle({at, 0, 0}, {1 - at, 0, 0}, {0, 1, 0})});
    return room(std::move(name), std::move(patches), quadrature);
}

// Everything counts both copies of the ceiling: their rows sum to 1 and what a surface sees of the second one.
HardRoom duplicated() {
    std::vector<Patch> patches = cube();
    patches.push_back(patches[1]);
    HardRoom result = room("cube, ceiling twice", std::move(patches), quadrature);
    const double facing = support::parallel_equal_rectangles(1, 1, 1),
                 beside = support::perpendicular_rectangles_common_edge(1, 1, 1);
    result.row_sums = {1 + facing, 1, 1 + beside, 1 + beside, 1 + beside, 1 + beside, 1};
    return result;
}

// A lamp of 0.4 x 0.3 x 0.1 on a table top that is the room's floor: what of either is in contact exchanges nothing.
HardRoom lamp_on_table() {
    std::vector<Patch> patches = cube();
    append(patches, support::box(Vec3(0.3, 0.4, 0), Vec3(0.7, 0.7, 0.1), Facing::Outwards));
    HardRoom result = room("lamp lying on a table", std::move(patches), hidden_share);
    result.row_sums[0] = 1.0 - 0.4 * 0.3;
    result.row_sums[6] = 0.0;
    return result;
}

// Between slabs: what leaves the gap of 1e-3 between them is little, but all of it must be found.
HardRoom slab_above_floor() {
    std::vector<Patch> patches = cube();
    append(patches, support::box(Vec3(0.2, 0.2, 1e-3), Vec3(0.8, 0.8, 0.1), Facing::Outwards));
    return room("slab 1e-3 above the floor", std::move(patches), hidden_share);
}

// Clusters exchange light between ready nodes, few of which are near the plate: the rule's error is not the tolerance's.
constexpr double by_nodes = 2e-2;

// A small square plate in the middle of a cube whose twelve triangles are one cluster.
HardRoom cluster_around_plate() {
    HardRoom result = room("cluster around a plate",
                           {rectangle({0.4, 0.4, 0.5}, {0.2, 0, 0}, {0, 0.2, 0}),
                            rectangle({0.4, 0.4, 0.5}, {0, 0.2, 0}, {0.2, 0, 0})},
                           by_nodes);
    model::Cluster cluster{.normal_spread_deg = 180.0};
    for (const Patch& patch : cube()) {
        const auto first = static_cast<std::uint32_t>(result.set.small.points.size());
        for (const Vec2& p : patch.points)
            result.set.small.points.push_back(patch.surface.origin + p.x * patch.surface.axis_u +
                                              p.y * patch.surface.axis_v);
        for (const auto& t : patch.triangles) {
            cluster.triangles.push_back(static_cast<std::uint32_t>(result.set.small.triangles.size()));
            result.set.small.triangles.push_back({first + t[0], first + t[1], first + t[2]});
            result.set.small.objects.emplace_back(0);
            result.set.small.materials.emplace_back(0);
        }
    }
    result.tree.clusters = {cluster};
    model::Element element;
    element.cluster = ClusterId(0);
    result.tree.elements.push_back(element);
    result.row_sums.push_back(1.0);
    return result;
}

} // namespace

std::vector<HardRoom> hard_rooms() {
    return {degree_six(),
            divided("cube, T-junctions", 1.0 / 3.0),
            divided("cube, a sliver of 1e4 in its floor", 1e-4),
            duplicated(),
            lamp_on_table(),
            slab_above_floor(),
            cluster_around_plate()};
}

} // namespace kinelux::hard_cases
