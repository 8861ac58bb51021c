// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/visible_polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// What is visible is kept as a sum of regions with integer weights: at first the target, once. Subtracting a blocker B
// from a sum of regions R adds -weight times (R and B) for each R. Every such section has a convex partner, by whose half
// planes the other one is cut, so that nothing but cuts by lines is needed: no case is degenerate, and errors are of the
// size of rounding. The sum stays small because regions that lie wholly in B cancel, and so do sections that are all of B.

namespace kinelux::visibility {

namespace {

constexpr double edge_on =
    1e-10; ///< height of x over a blocker's plane, of the target's reach, that counts as none
constexpr double touching =
    1e-10; ///< height over the target's plane, of its reach, that counts as lying in it
constexpr double hidden_share = 1e-12; ///< of the target's area: less than this is nothing
constexpr double covered_share = 1e-9; ///< of a shaft's section: a slit so narrow lets nothing through
constexpr double convex_slack = 1e-12; ///< sine of a turn that counts as none

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

// Half plane to the left of the line from p to q.
auto left_of(const Vec2& p, const Vec2& q) {
    return [p, edge = q - p](const Vec2& y) { return cross(edge, y - p); };
}

bool contains(std::span<const Vec2> convex, std::span<const Vec2> points) {
    for (std::size_t i = 0; i < convex.size(); ++i) {
        const auto left = left_of(convex[i], convex[i + 1 < convex.size() ? i + 1 : 0]);
        for (const Vec2& p : points)
            if (left(p) < 0.0) return false;
    }
    return true;
}

// Cuts the cutter's loop by all sides of a convex window.
void keep_within(LoopCutter<Vec2>& cutter, std::span<const Vec2> window) {
    for (std::size_t i = 0; i < window.size() && !cutter.loop().empty(); ++i) {
        const Vec2& next = window[i + 1 < window.size() ? i + 1 : 0];
        if (next != window[i]) cutter.keep(left_of(window[i], next));
    }
}

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
    for (std::size_t loop = 0; loop < target.size(); ++loop) {
        for (const Vec3& p : target[loop]) loops_.points.emplace_back(seen(p));
        loops_.ends.push_back(static_cast<std::uint32_t>(loops_.points.size()));
    }
    target_is_window_ = loops_.size() == 1 && is_convex(loops_[0], convex_slack);
    add_region(0, 1, target_is_window_);
    target_area_ = 0.0;
    for (std::size_t loop = 0; loop < loops_.size(); ++loop) target_area_ += twice_area(loops_[loop]);
    make_cone();
}

// The half spaces through x and the sides of the window, which is the target or a rectangle around it. What lies in all
// of them is seen within the window: projections stay bounded however near to x a blocker comes.
void VisiblePolygon::make_cone() {
    const Region& target = regions_[0];
    if (target_is_window_)
        window_.assign(loops_.points.begin(), loops_.points.end());
    else
        window_ = {target.low, {target.high.x, target.low.y}, target.high, {target.low.x, target.high.y}};
    cone_.clear();
    for (std::size_t i = 0; i < window_.size(); ++i) {
        const Vec2& p = window_[i];
        const Vec2 edge = window_[i + 1 < window_.size() ? i + 1 : 0] - p;
        if (edge != Vec2(0.0)) cone_.emplace_back(-edge.y * height_, edge.x * height_, -cross(edge, p));
    }
    const Vec2 farthest = glm::max(glm::abs(target.low), glm::abs(target.high));
    reach_ = std::sqrt(glm::dot(farthest, farthest) + height_ * height_);
}

// What is seen of loops before the target and within the cone, in the target's plane. False when nothing.
bool VisiblePolygon::project(const Loops3& loops, double turn, Loops2& projected) {
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
        const std::size_t first = projected.points.size();
        for (const Vec3& p : cutter_.loop()) projected.points.push_back(height_ / p.z * Vec2(p));
        if (turn < 0.0)
            std::reverse(projected.points.begin() + static_cast<std::ptrdiff_t>(first),
                         projected.points.end());
        projected.ends.push_back(static_cast<std::uint32_t>(projected.points.size()));
    }
    return !projected.empty();
}

void VisiblePolygon::add_region(std::uint32_t first_loop, int weight, bool convex) {
    Region region{.first_loop = first_loop, .weight = weight, .convex = convex};
    region.loop_count = static_cast<std::uint32_t>(loops_.size()) - first_loop;
    const std::size_t first = first_loop == 0 ? 0 : loops_.ends[first_loop - 1];
    region.low = region.high = loops_.points[first];
    for (std::size_t i = first; i < loops_.points.size(); ++i) {
        region.low = glm::min(region.low, loops_.points[i]);
        region.high = glm::max(region.high, loops_.points[i]);
    }
    regions_.push_back(region);
}

void VisiblePolygon::subtract(const PlanarBlocker& blocker) {
    // From the plane's back its loops are seen to turn the other way.
    const double turn = glm::dot(blocker.plane.normal, x_ - blocker.loops.points[0]);
    if (std::abs(turn) <= edge_on * reach_) return;
    other_.clear();
    if (!project(blocker.loops, turn, other_)) return;
    other_convex_ = blocker.convex || (other_.size() == 1 && is_convex(other_[0], convex_slack));
    const std::size_t before = regions_.size();
    int whole = 0;
    for (std::size_t r = 0; r < before; ++r) {
        const int weight = regions_[r].weight;
        if (weight == 0) continue;
        const auto first_loop = static_cast<std::uint32_t>(loops_.size());
        switch (meet(r, blocker, turn)) {
        case Meeting::None: break;
        case Meeting::WholeOther: whole -= weight; break;
        case Meeting::WholeRegion: regions_[r].weight = 0; break;
        case Meeting::Part: add_region(first_loop, -weight, regions_[r].convex && other_convex_); break;
        }
    }
    if (whole == 0) return;
    const auto first_loop = static_cast<std::uint32_t>(loops_.size());
    for (std::size_t loop = 0; loop < other_.size(); ++loop) loops_.add(other_[loop]);
    add_region(first_loop, whole, other_convex_);
}

// The section of a region with the projected blocker; a part of both is left at the end of loops_.
VisiblePolygon::Meeting VisiblePolygon::meet(std::size_t region, const PlanarBlocker& blocker, double turn) {
    if (region == 0 && target_is_window_) return Meeting::WholeOther;
    const Region& r = regions_[region];
    if (r.convex) return cut_other(region);
    if (other_convex_) return cut_region(region, other_[0]);
    piece_.clear();
    project(blocker.pieces, turn, piece_);
    Meeting result = Meeting::None;
    for (std::size_t piece = 0; piece < piece_.size(); ++piece)
        if (cut_region(region, piece_[piece]) != Meeting::None) result = Meeting::Part;
    return result;
}

// Cuts the blocker by a convex region.
VisiblePolygon::Meeting VisiblePolygon::cut_other(std::size_t region) {
    const std::uint32_t first = regions_[region].first_loop;
    if (other_convex_ && contains(other_[0], loops_[first])) return Meeting::WholeRegion;
    const std::size_t points = loops_.points.size(), loops = loops_.size();
    bool whole = true;
    for (std::size_t loop = 0; loop < other_.size(); ++loop) {
        flat_cutter_.begin(other_[loop]);
        keep_within(flat_cutter_, loops_[first]);
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

// Cuts a region by a convex window in the blocker.
VisiblePolygon::Meeting VisiblePolygon::cut_region(std::size_t region, std::span<const Vec2> window) {
    const std::size_t loops = loops_.size();
    for (std::uint32_t loop = 0; loop < regions_[region].loop_count; ++loop) {
        flat_cutter_.begin(loops_[regions_[region].first_loop + loop]);
        keep_within(flat_cutter_, window);
        if (flat_cutter_.loop().size() >= 3) loops_.add(flat_cutter_.loop());
    }
    return loops_.size() > loops ? Meeting::Part : Meeting::None;
}

const Loops3& VisiblePolygon::visible_loops() {
    double area = 0.0;
    for (const Region& region : regions_)
        for (std::uint32_t loop = 0; loop < region.loop_count; ++loop)
            area += region.weight * twice_area(loops_[region.first_loop + loop]);
    if (area <= hidden_share * target_area_) return visible_;
    const auto in_space = [this](const Vec2& p) {
        return x_ + p.x * axis_u_ + p.y * axis_v_ - height_ * normal_;
    };
    for (const Region& region : regions_)
        for (int copy = 0; copy < std::abs(region.weight); ++copy)
            for (std::uint32_t l = 0; l < region.loop_count; ++l) {
                const std::span<const Vec2> loop = loops_[region.first_loop + l];
                for (std::size_t i = 0; i < loop.size(); ++i)
                    visible_.points.push_back(in_space(loop[region.weight > 0 ? i : loop.size() - 1 - i]));
                visible_.ends.push_back(static_cast<std::uint32_t>(visible_.points.size()));
            }
    return visible_;
}

} // namespace kinelux::visibility
