// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/visible_polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// What is visible is kept as a sum of regions with integer weights: at first the target, once. Subtracting a blocker B
// from a sum of regions R adds -weight times (R and B) for each R. Of two sets one is always cut by the lines that bound
// the other, so that no case is degenerate and errors are of the size of rounding. The lines are those of the blockers
// themselves, never of sections, whose sides may be so short that rounding turns them. The sum stays small because regions
// that lie wholly in B cancel, and so do sections that are all of B.

namespace kinelux::visibility {

namespace {

constexpr double edge_on =
    1e-10; ///< height of x over a blocker's plane, of the target's reach, that counts as none
constexpr double touching =
    1e-10; ///< height over the target's plane, of its reach, that counts as lying in it
constexpr double hidden_share = 1e-12; ///< of the target's area: less than this is nothing
constexpr double covered_share = 1e-9; ///< of a shaft's section: a slit so narrow lets nothing through
constexpr double convex_slack = 1e-12; ///< sine of a turn that counts as none

constexpr double on_line = 1e-13;   ///< distance, of the target's reach, that counts as none
constexpr double short_side = 1e-3; ///< of the reach: the direction of a shorter side is put to the test

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

// The lowest and the highest of the points' heights over a plane.
struct HeightRange {
    double low = std::numeric_limits<double>::infinity(), high = -low;
};

HeightRange heights_over(const HalfSpace& plane, std::span<const Vec3> points, std::span<double> heights) {
    HeightRange range;
    for (std::size_t i = 0; i < points.size(); ++i) {
        heights[i] = plane.distance(points[i]);
        range.low = std::min(range.low, heights[i]);
        range.high = std::max(range.high, heights[i]);
    }
    return range;
}

// Whether the hull of points in a blocker's plane lies in the blocker, but for a small share of its area.
bool fills_hull(const PlanarBlocker& blocker, std::span<const Vec3> points) {
    const Vec3& normal = blocker.plane.normal;
    const ShaftEnd hull = shaft_end(points, normal);
    if (!hull.planar()) return false;
    const std::span<const Vec3> corners(hull.points.data(), hull.count);
    LoopCutter<Vec3> cutter;
    double filled = 0.0;
    for (std::size_t loop = 0; loop < blocker.loops.size(); ++loop) {
        cutter.begin(blocker.loops[loop]);
        for (std::size_t i = 0; i < corners.size() && !cutter.loop().empty(); ++i) {
            const Vec3 inwards = glm::cross(normal, corners[(i + 1) % corners.size()] - corners[i]);
            cutter.keep([&](const Vec3& p) { return glm::dot(inwards, p - corners[i]); });
        }
        filled += glm::dot(normal, twice_vector_area(cutter.loop()));
    }
    return filled >= (1.0 - covered_share) * glm::dot(normal, twice_vector_area(corners));
}

} // namespace

bool covers_all(const PlanarBlocker& blocker, const Shaft& shaft) {
    constexpr std::size_t most_points = 16; // more than an end of a shaft has
    std::array<double, most_points> heights_a, heights_b;
    const auto a = shaft.points_a(), b = shaft.points_b();
    const HeightRange range_a = heights_over(blocker.plane, a, heights_a);
    const HeightRange range_b = heights_over(blocker.plane, b, heights_b);
    const double touch = shaft.touching();
    const bool parts =
        (range_a.low >= -touch && range_b.high <= touch) || (range_a.high <= touch && range_b.low >= -touch);
    if (shaft.empty() || !parts) return false;
    // The section is the hull of the points where the segments between corners cross the plane.
    std::vector<Vec3> crossings;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) {
            const double between = heights_a[i] - heights_b[j];
            if (std::abs(between) > touch) {
                crossings.push_back(a[i] + heights_a[i] / between * (b[j] - a[i]));
            } else { // the whole segment lies in the plane
                crossings.push_back(a[i]);
                crossings.push_back(b[j]);
            }
        }
    return fills_hull(blocker, crossings);
}

const Loops3& VisiblePolygon::from(const Vec3& x, const Loops3& target, const Vec3& normal,
                                   std::span<const PlanarBlocker> blockers) {
    visible_.clear();
    if (target.empty()) return visible_;
    look_at(x, target, normal);
    if (!(height_ > 0.0) || !(target_area_ > 0.0)) return visible_;
    for (const PlanarBlocker& blocker : blockers) subtract(blocker);
    return regions_.size() == 1 && regions_[0].weight == 1 ? target : visible_loops();
}

// A left-handed frame at x: the target's axes, and depth from x towards its plane.
Vec3 VisiblePolygon::seen(const Vec3& p) const {
    const Vec3 r = p - x_;
    return {glm::dot(axis_u_, r), glm::dot(axis_v_, r), -glm::dot(normal_, r)};
}

void VisiblePolygon::look_at(const Vec3& x, const Loops3& target, const Vec3& normal) {
    x_ = x;
    normal_ = normal;
    const std::span<const Vec3> outer = target[0];
    // Along the longest edge: axis-aligned numbers for axis-aligned targets.
    Vec3 edge(0.0);
    for (std::size_t i = 0; i < outer.size(); ++i) {
        const Vec3 other = outer[i + 1 < outer.size() ? i + 1 : 0] - outer[i];
        if (glm::dot(other, other) > glm::dot(edge, edge)) edge = other;
    }
    axis_u_ = glm::normalize(edge);
    axis_v_ = glm::cross(normal, axis_u_);
    height_ = glm::dot(normal, x - outer[0]);
    loops_.clear();
    regions_.clear();
    lines_.clear();
    members_.clear();
    target_area_ = 0.0;
    for (std::size_t loop = 0; loop < target.size(); ++loop) {
        for (const Vec3& p : target[loop]) loops_.points.emplace_back(seen(p));
        loops_.ends.push_back(static_cast<std::uint32_t>(loops_.points.size()));
        target_area_ += twice_area(loops_[loop]);
    }
    add_region(0, 1, {});
    Vec2 low = loops_.points[0], high = low;
    for (const Vec2& p : loops_.points) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const Vec2 farthest = glm::max(glm::abs(low), glm::abs(high));
    reach_ = std::sqrt(glm::dot(farthest, farthest) + height_ * height_);
    target_is_window_ = loops_.size() == 1 && is_convex(loops_[0], convex_slack);
    make_cone(low, high);
}

// The half spaces through x and the sides of the window, which is the target or a rectangle around it. What lies in all
// of them is seen within the window: projections stay bounded however near to x a blocker comes.
void VisiblePolygon::make_cone(const Vec2& low, const Vec2& high) {
    const std::array<Vec2, 4> box{low, {high.x, low.y}, high, {low.x, high.y}};
    const std::span<const Vec2> window = target_is_window_ ? loops_[0] : std::span<const Vec2>(box);
    cone_.clear();
    for (std::size_t i = 0; i < window.size(); ++i) {
        const Vec2& p = window[i];
        const Vec2 edge = window[i + 1 < window.size() ? i + 1 : 0] - p;
        const double length = glm::length(edge);
        // Where a short side, turned by rounding, would cut off another corner, its neighbours bound the window.
        const auto cut_off = [&](const Vec2& q) { return cross(edge, q - p) < -on_line * reach_ * length; };
        if (length == 0.0 ||
            (length < short_side * reach_ && std::any_of(window.begin(), window.end(), cut_off)))
            continue;
        cone_.emplace_back(-edge.y * height_, edge.x * height_, -cross(edge, p));
    }
}

// Leaves in other_ what is seen of loops before the target and within the cone. False when nothing.
bool VisiblePolygon::project(const Loops3& loops, double turn) {
    other_.clear();
    for (std::size_t loop = 0; loop < loops.size(); ++loop) {
        seen_.clear();
        for (const Vec3& p : loops[loop]) seen_.push_back(seen(p));
        cutter_.begin(seen_);
        for (const Vec3& inwards : cone_) {
            cutter_.keep([&](const Vec3& p) { return glm::dot(inwards, p); });
            if (cutter_.loop().empty()) break;
        }
        cutter_.keep([this](const Vec3& p) { return height_ - p.z; });
        const auto lies_in_plane = [this](const Vec3& p) { return height_ - p.z <= touching * reach_; };
        if (std::all_of(cutter_.loop().begin(), cutter_.loop().end(), lies_in_plane)) continue;
        const std::size_t first = other_.points.size();
        for (const Vec3& p : cutter_.loop()) other_.points.push_back(height_ / p.z * Vec2(p));
        if (turn < 0.0)
            std::reverse(other_.points.begin() + static_cast<std::ptrdiff_t>(first), other_.points.end());
        other_.ends.push_back(static_cast<std::uint32_t>(other_.points.size()));
    }
    return !other_.empty();
}

// The lines that bound what a convex polygon hides: its sides, and where its plane meets the target's, behind which it is
// no longer before the target.
void VisiblePolygon::add_lines(std::span<const Vec3> seen_loop, double turn, const Vec3& plane_normal) {
    const auto add = [&](const Vec3& inwards) {
        const double length = std::hypot(inwards.x, inwards.y);
        // Parallel to the target's plane a line is nowhere: all of the plane is on one side, far away.
        const double scale = 1.0 / std::max(length, std::numeric_limits<double>::min());
        lines_.push_back({scale * Vec2(inwards), scale * inwards.z * height_});
    };
    const double side = turn > 0.0 ? 1.0 : -1.0;
    for (std::size_t i = 0; i < seen_loop.size(); ++i)
        add(side * glm::cross(seen_loop[i], seen_loop[i + 1 < seen_loop.size() ? i + 1 : 0]));
    add(-side * Vec3(glm::dot(axis_u_, plane_normal) * height_, glm::dot(axis_v_, plane_normal) * height_,
                     turn - glm::dot(normal_, plane_normal) * height_));
}

void VisiblePolygon::add_region(std::uint32_t first_loop, int weight, Range windows) {
    regions_.push_back({.loops = {first_loop, static_cast<std::uint32_t>(loops_.size()) - first_loop},
                        .weight = weight,
                        .windows = windows});
}

// The part of a region that the blocker hides; convex where both are.
void VisiblePolygon::add_section(std::uint32_t first_loop, const Region& region) {
    Range windows{static_cast<std::uint32_t>(members_.size()), 0};
    if (region.windows.count > 0 && other_lines_.count > 0) {
        for (std::uint32_t m = 0; m < region.windows.count; ++m)
            members_.push_back(members_[region.windows.first + m]);
        members_.push_back(other_lines_);
        windows.count = region.windows.count + 1;
    }
    add_region(first_loop, -region.weight, windows);
}

void VisiblePolygon::subtract(const PlanarBlocker& blocker) {
    // From the plane's back its loops are seen to turn the other way.
    const double turn = glm::dot(blocker.plane.normal, x_ - blocker.loops.points[0]);
    if (std::abs(turn) <= edge_on * reach_ || !project(blocker.loops, turn)) return;
    other_lines_ = {static_cast<std::uint32_t>(lines_.size()), 0};
    if (blocker.convex) add_lines(seen_, turn, blocker.plane.normal);
    other_lines_.count = static_cast<std::uint32_t>(lines_.size()) - other_lines_.first;
    const std::size_t before = regions_.size();
    int whole = 0;
    for (std::size_t r = 0; r < before; ++r) {
        const Region region = regions_[r];
        if (region.weight == 0) continue;
        const auto first_loop = static_cast<std::uint32_t>(loops_.size());
        switch (r == 0 && target_is_window_ ? Meeting::WholeOther : meet(region, blocker, turn)) {
        case Meeting::None: break;
        case Meeting::WholeOther: whole -= region.weight; break;
        case Meeting::WholeRegion: regions_[r].weight = 0; break;
        case Meeting::Part: add_section(first_loop, region); break;
        }
    }
    if (whole == 0) return;
    const auto first_loop = static_cast<std::uint32_t>(loops_.size());
    for (std::size_t loop = 0; loop < other_.size(); ++loop) loops_.add(other_[loop]);
    const Range windows{static_cast<std::uint32_t>(members_.size()), other_lines_.count > 0 ? 1u : 0u};
    if (windows.count > 0) members_.push_back(other_lines_);
    add_region(first_loop, whole, windows);
}

// The section of a region with the projected blocker; where it is a part of both it is left at the end of loops_.
VisiblePolygon::Meeting VisiblePolygon::meet(const Region& region, const PlanarBlocker& blocker,
                                             double turn) {
    if (other_lines_.count > 0 && holds(other_lines_, region)) return Meeting::WholeRegion;
    if (region.windows.count > 0) return cut_other(region);
    if (other_lines_.count > 0) return cut_region(region, other_lines_);
    Meeting result = Meeting::None;
    for (std::size_t piece = 0; piece < blocker.pieces.size(); ++piece) {
        seen_.clear();
        for (const Vec3& p : blocker.pieces[piece]) seen_.push_back(seen(p));
        const auto first = static_cast<std::uint32_t>(lines_.size());
        add_lines(seen_, turn, blocker.plane.normal);
        const Range lines{first, static_cast<std::uint32_t>(lines_.size()) - first};
        if (cut_region(region, lines) != Meeting::None) result = Meeting::Part;
    }
    return result;
}

bool VisiblePolygon::holds(Range lines, const Region& region) const {
    for (std::uint32_t loop = 0; loop < region.loops.count; ++loop)
        for (const Vec2& p : loops_[region.loops.first + loop])
            for (std::uint32_t line = 0; line < lines.count; ++line)
                if (lines_[lines.first + line].distance(p) < -on_line * reach_) return false;
    return true;
}

// Cuts the loop at hand. Points as good as on a line are on it, so that equal sides of two blockers cancel.
void VisiblePolygon::keep_within(Range lines) {
    for (std::uint32_t line = 0; line < lines.count && !flat_cutter_.loop().empty(); ++line)
        flat_cutter_.keep([this, &l = lines_[lines.first + line]](const Vec2& p) {
            const double distance = l.distance(p);
            return std::abs(distance) <= on_line * reach_ ? 0.0 : distance;
        });
}

// Cuts the blocker by the lines of a region.
VisiblePolygon::Meeting VisiblePolygon::cut_other(const Region& region) {
    const std::size_t points = loops_.points.size(), loops = loops_.size();
    bool whole = true;
    for (std::size_t loop = 0; loop < other_.size(); ++loop) {
        flat_cutter_.begin(other_[loop]);
        for (std::uint32_t m = 0; m < region.windows.count; ++m)
            keep_within(members_[region.windows.first + m]);
        whole = whole && flat_cutter_.whole();
        if (flat_cutter_.loop().size() >= 3) loops_.add(flat_cutter_.loop());
    }
    if (whole) {
        loops_.points.resize(points);
        loops_.ends.resize(loops);
        return Meeting::WholeOther;
    }
    return loops_.size() > loops ? Meeting::Part : Meeting::None;
}

// Cuts a region by lines of the blocker.
VisiblePolygon::Meeting VisiblePolygon::cut_region(const Region& region, Range lines) {
    const std::size_t loops = loops_.size();
    for (std::uint32_t loop = 0; loop < region.loops.count; ++loop) {
        flat_cutter_.begin(loops_[region.loops.first + loop]);
        keep_within(lines);
        if (flat_cutter_.loop().size() >= 3) loops_.add(flat_cutter_.loop());
    }
    return loops_.size() > loops ? Meeting::Part : Meeting::None;
}

const Loops3& VisiblePolygon::visible_loops() {
    double area = 0.0;
    for (const Region& region : regions_)
        for (std::uint32_t loop = 0; loop < region.loops.count; ++loop)
            area += region.weight * twice_area(loops_[region.loops.first + loop]);
    if (area <= hidden_share * target_area_) return visible_;
    const auto in_space = [this](const Vec2& p) {
        return x_ + p.x * axis_u_ + p.y * axis_v_ - height_ * normal_;
    };
    for (const Region& region : regions_)
        for (int copy = 0; copy < std::abs(region.weight); ++copy)
            for (std::uint32_t l = 0; l < region.loops.count; ++l) {
                const std::span<const Vec2> loop = loops_[region.loops.first + l];
                for (std::size_t i = 0; i < loop.size(); ++i)
                    visible_.points.push_back(in_space(loop[region.weight > 0 ? i : loop.size() - 1 - i]));
                visible_.ends.push_back(static_cast<std::uint32_t>(visible_.points.size()));
            }
    return visible_;
}

} // namespace kinelux::visibility
