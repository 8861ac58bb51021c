// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/intersections.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include "core/parallel.h"

namespace kinelux::clean {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::size_t>;

struct Shapes {
    std::vector<Kernel::Point_3> points;
    std::span<const model::Triangle> triangles;

    Kernel::Triangle_3 triangle(std::size_t f) const {
        const model::Triangle& t = triangles[f];
        return {points[t[0]], points[t[1]], points[t[2]]};
    }
};

// Corners of two faces, the common ones first and in the same order.
struct Pair {
    std::array<std::uint32_t, 3> a, b;
    std::size_t common = 0;
};

Pair pair_of(const Shapes& shapes, std::size_t f, std::size_t g) {
    Pair pair{shapes.triangles[f], shapes.triangles[g], 0};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto at =
            std::find(pair.b.begin() + static_cast<std::ptrdiff_t>(pair.common), pair.b.end(), pair.a[i]);
        if (at == pair.b.end()) continue;
        std::swap(pair.a[pair.common], pair.a[i]);
        std::iter_swap(pair.b.begin() + static_cast<std::ptrdiff_t>(pair.common), at);
        ++pair.common;
    }
    return pair;
}

bool intersect(const Shapes& shapes, std::size_t f, std::size_t g) {
    const Pair pair = pair_of(shapes, f, g);
    const auto& p = shapes.points;
    if (pair.common == 0) return CGAL::do_intersect(shapes.triangle(f), shapes.triangle(g));
    // At a common corner: do the faces meet elsewhere, then the side opposite to it of one meets the other.
    if (pair.common == 1) {
        const Kernel::Segment_3 side_a(p[pair.a[1]], p[pair.a[2]]), side_b(p[pair.b[1]], p[pair.b[2]]);
        return CGAL::do_intersect(side_a, shapes.triangle(g)) ||
               CGAL::do_intersect(side_b, shapes.triangle(f));
    }
    // At a common edge they overlap only when folded onto each other.
    if (pair.common == 2) {
        const auto &u = p[pair.a[0]], &v = p[pair.a[1]], &x = p[pair.a[2]], &y = p[pair.b[2]];
        return CGAL::coplanar(u, v, x, y) && CGAL::coplanar_orientation(u, v, x, y) == CGAL::POSITIVE;
    }
    return false;
}

// Pairs whose boxes meet are tested once this many have been gathered, which bounds the memory they take.
constexpr std::size_t pairs_at_a_time = 1U << 20U;
// Pairs one task tests.
constexpr std::size_t pairs_per_task = 1024;

// Gathers pairs of faces and tests them on all threads.
class PairTester {
public:
    explicit PairTester(const Shapes& shapes) : shapes_(shapes), marked_(shapes.triangles.size(), 0) {}

    void add(std::size_t f, std::size_t g) {
        pairs_.push_back({static_cast<std::uint32_t>(f), static_cast<std::uint32_t>(g)});
        if (pairs_.size() == pairs_at_a_time) test();
    }

    SelfIntersections result() {
        test();
        for (std::uint32_t f = 0; f < marked_.size(); ++f) {
            if (marked_[f] != 0) found_.faces.push_back(f);
        }
        return std::move(found_);
    }

private:
    void test() {
        std::vector<std::uint8_t> met(pairs_.size(), 0);
        core::parallel_for((pairs_.size() + pairs_per_task - 1) / pairs_per_task, [&](std::size_t task) {
            const std::size_t end = std::min(pairs_.size(), (task + 1) * pairs_per_task);
            for (std::size_t i = task * pairs_per_task; i < end; ++i)
                met[i] = intersect(shapes_, pairs_[i][0], pairs_[i][1]) ? 1 : 0;
        });
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            if (met[i] == 0) continue;
            ++found_.pairs;
            marked_[pairs_[i][0]] = marked_[pairs_[i][1]] = 1;
        }
        pairs_.clear();
    }

    const Shapes& shapes_;
    std::vector<std::array<std::uint32_t, 2>> pairs_;
    std::vector<std::uint8_t> marked_;
    SelfIntersections found_;
};

} // namespace

SelfIntersections find_self_intersections(std::span<const Vec3> points,
                                          std::span<const model::Triangle> triangles) {
    Shapes shapes;
    for (const Vec3& x : points) shapes.points.emplace_back(x.x, x.y, x.z);
    shapes.triangles = triangles;
    std::vector<Box> boxes;
    for (std::size_t f = 0; f < triangles.size(); ++f) boxes.emplace_back(shapes.triangle(f).bbox(), f);
    PairTester tester(shapes);
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(),
                                  [&](const Box& a, const Box& b) { tester.add(a.info(), b.info()); });
    return tester.result();
}

} // namespace kinelux::clean
