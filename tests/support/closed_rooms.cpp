// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/closed_rooms.h"

#include <cmath>
#include <iterator>
#include <numbers>

#include "support/planar_patches.h"
#include "support/shapes.h"

namespace kinelux::support {

namespace {

std::vector<Vec2> regular(int corners) {
    std::vector<Vec2> result;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / corners;
        result.emplace_back(std::cos(angle), std::sin(angle));
    }
    return result;
}

model::Patch level(std::span<const Vec2> outline, double height) {
    std::vector<Vec3> corners;
    corners.reserve(outline.size());
    for (const Vec2& p : outline) corners.emplace_back(p, height);
    return polygon_patch(corners);
}

ClosedRoom room(std::string name, std::vector<model::Patch> patches, double longest_edge) {
    model::PatchSet set;
    set.patches = std::move(patches);
    return {std::move(name), std::move(set), longest_edge};
}

ClosedRoom box_room(std::string name, const Vec3& size) {
    return room(std::move(name), box(Vec3(0), size, Facing::Inwards),
                std::max(size.x, std::max(size.y, size.z)));
}

} // namespace

std::vector<model::Patch> prism(std::span<const Vec2> outline, double height) {
    // From above the ceiling runs clockwise, from its own first corner again.
    std::vector<Vec2> above(outline.rbegin(), outline.rend());
    above.insert(above.begin(), above.back());
    above.pop_back();
    std::vector<model::Patch> patches{level(outline, 0.0), level(above, height)};
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec3 from(outline[i], 0.0), to(outline[(i + 1) % outline.size()], 0.0);
        patches.push_back(rectangle(from, {0, 0, height}, to - from));
    }
    return patches;
}

std::vector<model::Patch> pyramid(std::span<const Vec2> base, const Vec3& apex) {
    std::vector<model::Patch> patches{level(base, 0.0)};
    for (std::size_t i = 0; i < base.size(); ++i) {
        const Vec2 &from = base[i], &to = base[(i + 1) % base.size()];
        patches.push_back(polygon_patch(std::vector<Vec3>{Vec3(to, 0.0), Vec3(from, 0.0), apex}));
    }
    return patches;
}

std::vector<ClosedRoom> closed_rooms() {
    std::vector<ClosedRoom> rooms;
    rooms.push_back(box_room("cube", {1, 1, 1}));
    rooms.push_back(box_room("box 1 x 1.5 x 0.8", {1, 1.5, 0.8}));
    rooms.push_back(box_room("corridor 20 x 2 x 2.5", {20, 2, 2.5}));
    rooms.push_back(box_room("flat box 1 x 1 x 0.001", {1, 1, 1e-3}));
    const std::vector<Vec2> triangle = regular(3), square = regular(4), hexagon = regular(6);
    rooms.push_back(
        room("regular tetrahedron", pyramid(triangle, {0, 0, std::numbers::sqrt2}), std::numbers::sqrt3));
    const std::vector<Vec2> scalene{{0, 0}, {2, 0}, {0.3, 0.9}};
    rooms.push_back(room("skew tetrahedron", pyramid(scalene, {1.6, 1.1, 0.5}), 2.0));
    rooms.push_back(room("square pyramid", pyramid(square, {0, 0, 1}), std::numbers::sqrt2));
    rooms.push_back(room("triangular prism", prism(triangle, 1.0), std::numbers::sqrt3));
    rooms.push_back(room("hexagonal prism", prism(hexagon, 0.7), 1.0));
    const std::vector<Vec2> ell{{1, 1}, {1, 2}, {0, 2}, {0, 0}, {2, 0}, {2, 1}};
    rooms.push_back(room("L-shaped room", prism(ell, 1.0), 2.0));
    rooms.push_back(box_room("cube with a box in it", {1, 1, 1}));
    const auto inner = box(Vec3(0.3, 0.25, 0.2), Vec3(0.7, 0.6, 0.5), Facing::Outwards);
    rooms.back().set.patches.insert(rooms.back().set.patches.end(), inner.begin(), inner.end());
    return rooms;
}

} // namespace kinelux::support
