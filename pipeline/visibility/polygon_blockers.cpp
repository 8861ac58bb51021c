// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/polygon_blockers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "core/error.h"
#include "visibility/convex_pieces.h"

namespace kinelux::visibility {

namespace {

constexpr std::uint32_t leaf_size = 4;     ///< polygons that are cheaper to test one by one than to divide
constexpr double same_area = 1e-9;         ///< relative difference of areas that rounding makes
constexpr double same_place = 1e-9;        ///< the same of positions, of the polygon's size
constexpr double rounding = 1e-15;         ///< of coordinates far from the origin
constexpr double convex_slack = 1e-12;     ///< sine of a turn that counts as none
constexpr std::size_t deepest_stack = 128; ///< of the search; the tree's depth is about log2 of its size

// The copies of a sheet are sought among polygons that lie equally far along a direction that no model is built along.
const Vec3 odd_direction = glm::normalize(Vec3(0.4711, 0.6180, 0.3183));

void require_in_range(const Body& body, std::uint32_t index, const Outline& outline) {
    bool good = outline.first_triangle + std::size_t{outline.triangle_count} <= body.triangles.size();
    for (const auto& loop : outline.loops)
        for (const std::uint32_t point : loop) good = good && point < body.points.size();
    if (!good)
        throw core::GeometryError("body " + std::to_string(index) +
                                  " has an outline that names points or triangles it has not");
}

double half_surface(const Vec3& low, const Vec3& high) {
    const Vec3 d = high - low;
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

Vec3 mean(std::span<const Vec3> points) {
    return std::accumulate(points.begin(), points.end(), Vec3(0.0)) / static_cast<double>(points.size());
}

bool same_points(std::span<const Vec3> a, std::span<const Vec3> b, double tolerance) {
    return a.size() == b.size() && std::all_of(a.begin(), a.end(), [&](const Vec3& p) {
               return std::any_of(b.begin(), b.end(),
                                  [&](const Vec3& q) { return glm::distance(p, q) <= tolerance; });
           });
}

} // namespace

std::span<const Vec3> PolygonBlockers::Set::points_of(const PolygonBlocker& polygon) const {
    const std::size_t first = polygon.first_loop == 0 ? 0 : loops.ends[polygon.first_loop - 1];
    const std::size_t last = loops.ends[polygon.first_loop + polygon.loop_count - 1];
    return std::span(loops.points).subspan(first, last - first);
}

void PolygonBlockers::Set::measure(PolygonBlocker& polygon) const {
    polygon.box_low = polygon.box_high = loops[polygon.first_loop][0];
    for (const Vec3& p : points_of(polygon)) {
        polygon.box_low = glm::min(polygon.box_low, p);
        polygon.box_high = glm::max(polygon.box_high, p);
    }
}

// The loops are there already. False, and they are gone again, where they enclose nothing.
bool PolygonBlockers::Set::finish_polygon(PolygonBlocker polygon) {
    Vec3 twice(0.0);
    for (std::size_t loop = polygon.first_loop; loop < loops.size(); ++loop)
        twice += twice_vector_area(loops[loop]);
    const double length = glm::length(twice);
    polygon.loop_count = static_cast<std::uint32_t>(loops.size()) - polygon.first_loop;
    if (!(length > 0.0)) {
        loops.ends.resize(polygon.first_loop);
        loops.points.resize(loops.ends.empty() ? 0 : loops.ends.back());
        return false;
    }
    polygon.area = 0.5 * length;
    polygon.plane.normal = twice / length;
    polygon.plane.offset = glm::dot(polygon.plane.normal, mean(points_of(polygon)));
    polygon.convex =
        polygon.loop_count == 1 && is_convex(loops[polygon.first_loop], polygon.plane.normal, convex_slack);
    measure(polygon);
    polygons.push_back(polygon);
    return true;
}

void PolygonBlockers::Set::add_triangle(const Body& body, std::uint32_t index,
                                        const model::Triangle& triangle) {
    const auto first = static_cast<std::uint32_t>(loops.size());
    loops.add(std::array{body.points[triangle[0]], body.points[triangle[1]], body.points[triangle[2]]});
    finish_polygon({.body = index, .fine = true, .first_loop = first});
}

void PolygonBlockers::Set::add_outline(const Body& body, std::uint32_t index, const Outline& outline) {
    const auto triangles = std::span(body.triangles).subspan(outline.first_triangle, outline.triangle_count);
    double twice_area = 0.0;
    for (const model::Triangle& t : triangles)
        twice_area += glm::length(
            glm::cross(body.points[t[1]] - body.points[t[0]], body.points[t[2]] - body.points[t[0]]));
    const auto first = static_cast<std::uint32_t>(loops.size());
    for (const auto& loop : outline.loops) {
        for (const std::uint32_t point : loop) loops.points.push_back(body.points[point]);
        loops.ends.push_back(static_cast<std::uint32_t>(loops.points.size()));
    }
    if (loops.size() == first || !finish_polygon({.body = index, .first_loop = first})) return;
    PolygonBlocker& polygon = polygons.back();
    if (std::abs(2.0 * polygon.area - twice_area) > same_area * twice_area) {
        // Loops that do not go round what the triangles cover, as of a chart that overlaps itself: rays see the triangles.
        polygons.pop_back();
        loops.ends.resize(first);
        loops.points.resize(first == 0 ? 0 : loops.ends.back());
        for (const model::Triangle& t : triangles) add_triangle(body, index, t);
        return;
    }
    if (polygon.convex) return;
    const Loops3 convex = convex_pieces(body.points, triangles, polygon.plane.normal);
    polygon.first_piece = static_cast<std::uint32_t>(pieces.size());
    polygon.piece_count = static_cast<std::uint32_t>(convex.size());
    for (std::size_t piece = 0; piece < convex.size(); ++piece) pieces.add(convex[piece]);
}

void PolygonBlockers::Set::add_body(const Body& body, std::uint32_t index) {
    std::uint32_t next = 0;
    for (const Outline& outline : body.outlines) {
        require_in_range(body, index, outline);
        for (; next < outline.first_triangle; ++next) add_triangle(body, index, body.triangles[next]);
        add_outline(body, index, outline);
        next = outline.first_triangle + outline.triangle_count;
    }
    for (; next < body.triangles.size(); ++next) add_triangle(body, index, body.triangles[next]);
}

// A face with two sides is there twice, back to back; the first copy stays. Loops of the others stay where they are.
void PolygonBlockers::Set::keep_one_of_each_sheet() {
    std::vector<std::pair<double, std::uint32_t>> along(polygons.size());
    for (std::uint32_t i = 0; i < polygons.size(); ++i)
        along[i] = {glm::dot(odd_direction, mean(points_of(polygons[i]))), i};
    std::sort(along.begin(), along.end());
    std::vector<bool> copy(polygons.size(), false);
    for (std::size_t k = 0; k < along.size(); ++k) {
        const PolygonBlocker& first = polygons[along[k].second];
        const double tolerance =
            same_place * glm::distance(first.box_low, first.box_high) + rounding * glm::length(first.box_low);
        for (std::size_t m = k + 1; m < along.size() && along[m].first <= along[k].first + tolerance; ++m) {
            const PolygonBlocker& second = polygons[along[m].second];
            if (first.body == second.body && first.loop_count == second.loop_count &&
                std::abs(first.area - second.area) <= same_area * first.area &&
                glm::dot(first.plane.normal, second.plane.normal) < 0.0 &&
                same_points(points_of(first), points_of(second), tolerance))
                copy[std::max(along[k].second, along[m].second)] = true;
        }
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < polygons.size(); ++i)
        if (!copy[i]) polygons[kept++] = polygons[i];
    polygons.resize(kept);
}

void PolygonBlockers::Set::build_tree() {
    nodes.clear();
    order.resize(polygons.size());
    std::iota(order.begin(), order.end(), 0u);
    if (!order.empty()) build_node(0, order.size());
}

void PolygonBlockers::Set::measure(Node& node, std::uint32_t index) const {
    if (node.count == 0) {
        const Node &first = nodes[index + 1], &second = nodes[node.first];
        node.low = glm::min(first.low, second.low);
        node.high = glm::max(first.high, second.high);
        node.largest_area = std::max(first.largest_area, second.largest_area);
        return;
    }
    node.low = Vec3(std::numeric_limits<double>::infinity());
    node.high = -node.low;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
        const PolygonBlocker& polygon = polygons[order[k]];
        node.low = glm::min(node.low, polygon.box_low);
        node.high = glm::max(node.high, polygon.box_high);
        node.largest_area = std::max(node.largest_area, polygon.area);
    }
}

std::uint32_t PolygonBlockers::Set::build_node(std::size_t first, std::size_t last) {
    const auto index = static_cast<std::uint32_t>(nodes.size());
    nodes.emplace_back();
    Node node;
    if (last - first <= leaf_size) {
        node.first = static_cast<std::uint32_t>(first);
        node.count = static_cast<std::uint32_t>(last - first);
    } else {
        const std::size_t middle = split(first, last);
        build_node(first, middle);
        node.first = build_node(middle, last);
    }
    measure(node, index);
    nodes[index] = node;
    return index;
}

// Sorts by centre along the longest side of the centres' box and cuts where the sum of surface times number of the two
// halves is least; large polygons, such as walls, so end up apart from small ones. Both halves keep an eighth at least,
// which bounds the depth.
std::size_t PolygonBlockers::Set::split(std::size_t first, std::size_t last) {
    const auto centre = [&](std::uint32_t i) { return polygons[i].box_low + polygons[i].box_high; };
    Vec3 low = centre(order[first]), high = low;
    for (std::size_t k = first; k < last; ++k) {
        low = glm::min(low, centre(order[k]));
        high = glm::max(high, centre(order[k]));
    }
    const Vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(first),
              order.begin() + static_cast<std::ptrdiff_t>(last), [&](std::uint32_t a, std::uint32_t b) {
                  const double ca = centre(a)[axis], cb = centre(b)[axis];
                  return ca != cb ? ca < cb : a < b;
              });
    const std::size_t count = last - first;
    std::vector<double> costs(count, 0.0);
    const auto sweep = [&](std::size_t k, std::size_t members, Vec3& l, Vec3& h) {
        l = glm::min(l, polygons[order[first + k]].box_low);
        h = glm::max(h, polygons[order[first + k]].box_high);
        return half_surface(l, h) * static_cast<double>(members);
    };
    Vec3 l(std::numeric_limits<double>::infinity()), h = -l;
    for (std::size_t k = 0; k + 1 < count; ++k) costs[k + 1] += sweep(k, k + 1, l, h);
    l = Vec3(std::numeric_limits<double>::infinity()), h = -l;
    for (std::size_t k = count - 1; k > 0; --k) costs[k] += sweep(k, count - k, l, h);
    const auto least = static_cast<std::ptrdiff_t>(std::max<std::size_t>(1, count / 8));
    return first + static_cast<std::size_t>(std::min_element(costs.begin() + least, costs.end() - least) -
                                            costs.begin());
}

// False when the visitor wants no more.
bool PolygonBlockers::Set::visit(const Shaft& shaft, std::uint32_t number_offset, double& least_area,
                                 const Visitor& visitor) const {
    if (nodes.empty()) return true;
    std::array<std::uint32_t, deepest_stack> stack;
    std::size_t waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
        const std::uint32_t index = stack[--waiting];
        const Node& node = nodes[index];
        if (node.largest_area < least_area || shaft.misses(node.low, node.high)) continue;
        if (node.count == 0) {
            stack[waiting++] = node.first;
            stack[waiting++] = index + 1;
            continue;
        }
        for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
            const PolygonBlocker& polygon = polygons[order[k]];
            if (polygon.area < least_area || shaft.misses(polygon.box_low, polygon.box_high) ||
                shaft.misses(points_of(polygon), polygon.plane))
                continue;
            least_area = visitor(order[k] + number_offset);
            if (std::isinf(least_area)) return false;
        }
    }
    return true;
}

PolygonBlockers::PolygonBlockers(std::span<const Body> bodies) : bodies_(bodies.size()) {
    for (std::uint32_t b = 0; b < bodies.size(); ++b)
        (bodies[b].moves ? moving_ : resting_).add_body(bodies[b], b);
    for (Set* set : {&resting_, &moving_}) {
        set->keep_one_of_each_sheet();
        set->build_tree();
    }
    rest_points_ = moving_.loops.points;
    rest_pieces_ = moving_.pieces.points;
    for (const PolygonBlocker& polygon : moving_.polygons) rest_planes_.push_back(polygon.plane);
}

void PolygonBlockers::set_poses(std::span<const geometry::Pose> poses) {
    if (poses.size() != bodies_)
        throw core::GeometryError(std::to_string(poses.size()) + " poses were given for " +
                                  std::to_string(bodies_) + " bodies");
    const auto place = [](const geometry::Pose& pose, const std::vector<Vec3>& rest, Loops3& loops,
                          std::uint32_t first, std::uint32_t count) {
        const std::size_t begin = first == 0 ? 0 : loops.ends[first - 1];
        const std::size_t end = count == 0 ? begin : loops.ends[first + count - 1];
        for (std::size_t i = begin; i < end; ++i) loops.points[i] = pose.point(rest[i]);
    };
    for (std::size_t i = 0; i < moving_.polygons.size(); ++i) {
        PolygonBlocker& polygon = moving_.polygons[i];
        const geometry::Pose& pose = poses[polygon.body];
        place(pose, rest_points_, moving_.loops, polygon.first_loop, polygon.loop_count);
        place(pose, rest_pieces_, moving_.pieces, polygon.first_piece, polygon.piece_count);
        polygon.plane.normal = pose.direction(rest_planes_[i].normal);
        polygon.plane.offset = glm::dot(polygon.plane.normal, mean(moving_.points_of(polygon)));
        moving_.measure(polygon);
    }
    // Children come after their parents.
    for (std::size_t n = moving_.nodes.size(); n-- > 0;)
        moving_.measure(moving_.nodes[n], static_cast<std::uint32_t>(n));
}

const PolygonBlockers::Set& PolygonBlockers::set_of(std::uint32_t& polygon) const {
    const auto resting = static_cast<std::uint32_t>(resting_.polygons.size());
    if (polygon < resting) return resting_;
    polygon -= resting;
    return moving_;
}

const PolygonBlocker& PolygonBlockers::operator[](std::uint32_t polygon) const {
    const Set& set = set_of(polygon);
    return set.polygons[polygon];
}

std::span<const Vec3> PolygonBlockers::loop_of(std::uint32_t polygon, std::size_t loop) const {
    const Set& set = set_of(polygon);
    return set.loops[set.polygons[polygon].first_loop + loop];
}

std::span<const Vec3> PolygonBlockers::piece_of(std::uint32_t polygon, std::size_t piece) const {
    const Set& set = set_of(polygon);
    return set.pieces[set.polygons[polygon].first_piece + piece];
}

void PolygonBlockers::visit(const Shaft& shaft, Among among, const Visitor& visitor) const {
    if (shaft.empty()) return;
    double least_area = 0.0;
    if (among != Among::Moving && !resting_.visit(shaft, 0, least_area, visitor)) return;
    if (among != Among::Resting)
        moving_.visit(shaft, static_cast<std::uint32_t>(resting_.polygons.size()), least_area, visitor);
}

void PolygonBlockers::find(const Shaft& shaft, Among among, std::size_t most,
                           std::vector<std::uint32_t>& found) const {
    found.clear();
    visit(shaft, among, [&](std::uint32_t polygon) {
        found.push_back(polygon);
        return found.size() > most ? std::numeric_limits<double>::infinity() : 0.0;
    });
}

} // namespace kinelux::visibility
