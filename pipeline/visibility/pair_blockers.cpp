// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/pair_blockers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kinelux::visibility {

namespace {

constexpr double convex_slack = 1e-12; ///< sine of a turn that counts as none

// What a polygon that hides everything is expected to have of the area of the smaller end, as seen along the shaft. A
// guess that is too large only leaves a hidden pair to other means.
constexpr double least_cover = 0.5;
// So many large polygons are looked at when there are more than asked for: of those that could hide all, the tree's order
// brings one soon or never.
constexpr int most_looks = 8;

double area_along(std::span<const Vec3> points, const Vec3& direction) {
    return 0.5 * std::abs(glm::dot(direction, twice_vector_area(points)));
}

// Area that a polygon needs to hide everything, as far as it can be said [m2].
double least_covering_area(const Shaft& shaft, const ShaftEnd& a, const ShaftEnd& b) {
    const Vec3 way = b.box_low + b.box_high - a.box_low - a.box_high;
    const double length = glm::length(way);
    if (!a.planar() || !b.planar() || !(length > shaft.touching())) return 0.0;
    return least_cover *
           std::min(area_along(shaft.points_a(), way / length), area_along(shaft.points_b(), way / length));
}

} // namespace

Sight PairBlockers::between(const ShaftEnd& a, const ShaftEnd& b, const PolygonBlockers& polygons,
                            Among among, std::size_t most) {
    count_ = 0;
    const Shaft shaft(a, b);
    if (shaft.empty()) return Sight::Clear;
    const double covering_area = least_covering_area(shaft, a, b);
    bool hidden = false;
    int looks = 0; // once there are too many, only what may hide all is of interest
    polygons.visit(shaft, among, [&](std::uint32_t polygon) {
        if (take(polygon, polygons, shaft)) {
            hidden = polygons[polygon].area >= covering_area && covers_all(blockers_[count_ - 1], shaft);
            if (count_ > most) {
                --count_;
                ++looks;
            }
        }
        if (hidden || looks > most_looks || (looks > 0 && covering_area == 0.0))
            return std::numeric_limits<double>::infinity();
        return looks > 0 ? covering_area : 0.0;
    });
    if (hidden) return Sight::Hidden;
    if (looks > 0) return Sight::Many;
    if (count_ == 0) return Sight::Clear;
    // Sections of convex polygons stay convex: the others come last.
    std::stable_partition(blockers_.begin(), blockers_.begin() + static_cast<std::ptrdiff_t>(count_),
                          [](const PlanarBlocker& blocker) { return blocker.convex; });
    return Sight::Few;
}

bool PairBlockers::any_between(const ShaftEnd& a, const ShaftEnd& b, const PolygonBlockers& polygons,
                               Among among, std::span<const std::uint8_t> counts) {
    count_ = 0;
    const Shaft shaft(a, b);
    if (shaft.empty()) return false;
    polygons.visit(shaft, among, [&](std::uint32_t polygon) {
        const std::uint32_t body = polygons[polygon].body;
        if (body < counts.size() && counts[body] == 0) return 0.0;
        return take(polygon, polygons, shaft) ? std::numeric_limits<double>::infinity() : 0.0;
    });
    const bool found = count_ > 0;
    count_ = 0;
    return found;
}

// Adds a polygon where a part of it lies in the shaft.
bool PairBlockers::take(std::uint32_t polygon, const PolygonBlockers& polygons, const Shaft& shaft) {
    if (blockers_.size() == count_) blockers_.emplace_back();
    PlanarBlocker& blocker = blockers_[count_];
    const PolygonBlocker& whole = polygons[polygon];
    blocker.loops.clear();
    blocker.pieces.clear();
    for (std::uint32_t loop = 0; loop < whole.loop_count; ++loop)
        blocker.loops.add(polygons.loop_of(polygon, loop));
    blocker.plane = whole.plane;
    blocker.convex = whole.convex;
    blocker.fine = whole.fine;
    if (!cut_by_shaft(blocker, shaft)) return false;
    if (!blocker.convex) {
        // Of a wall with many windows only those before the pair are of interest.
        if (cut_.points.size() < blocker.loops.points.size()) std::swap(blocker.loops, cut_);
        blocker.convex =
            blocker.loops.size() == 1 && is_convex(blocker.loops[0], blocker.plane.normal, convex_slack);
        if (!blocker.convex) add_pieces(polygon, polygons, shaft);
    }
    ++count_;
    return true;
}

// Leaves in cut_ what the shaft holds of the blocker; false when that has no area.
bool PairBlockers::cut_by_shaft(const PlanarBlocker& blocker, const Shaft& shaft) {
    cut_.clear();
    double area = 0.0;
    for (std::size_t loop = 0; loop < blocker.loops.size(); ++loop) {
        cutter_.begin(blocker.loops[loop]);
        for (const HalfSpace& half_space : shaft.half_spaces()) {
            cutter_.keep([&](const Vec3& p) { return half_space.distance(p); });
            if (cutter_.loop().empty()) break;
        }
        if (cutter_.loop().size() < 3) continue;
        cut_.add(cutter_.loop());
        area += glm::dot(blocker.plane.normal, twice_vector_area(cutter_.loop()));
    }
    return area > shaft.touching() * shaft.touching();
}

void PairBlockers::add_pieces(std::uint32_t polygon, const PolygonBlockers& polygons, const Shaft& shaft) {
    PlanarBlocker& blocker = blockers_[count_];
    for (std::uint32_t piece = 0; piece < polygons[polygon].piece_count; ++piece) {
        const std::span<const Vec3> points = polygons.piece_of(polygon, piece);
        if (!shaft.misses(points, polygons[polygon].plane)) blocker.pieces.add(points);
    }
    if (blocker.pieces.size() != 1) return;
    std::swap(blocker.loops, blocker.pieces);
    blocker.pieces.clear();
    blocker.convex = true;
}

} // namespace kinelux::visibility
