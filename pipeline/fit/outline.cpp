// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "fit/segment_map.h"

namespace kinelux::fit {

namespace {

// Beyond this the regions do not add up to the chart: its projected faces overlap.
constexpr double area_agreement = 1e-9;

double total_area(const std::vector<Region>& regions) {
    double area = 0.0;
    for (const Region& region : regions) area += region.area;
    return area;
}

bool adds_up(const std::vector<Region>& regions, double area) {
    return !regions.empty() && std::abs(total_area(regions) - area) <= area_agreement * area;
}

std::vector<Region> cut_regions(const FlatChart& flat, const std::vector<std::array<Vec2, 2>>& segments,
                                double tolerance) {
    SegmentMap map(flat.points, flat.boundary, tolerance);
    for (const std::array<Vec2, 2>& segment : segments) map.insert(segment[0], segment[1]);
    return divide_domain(map.points(), map.boundary(), map.cuts(), {.least_width = tolerance});
}

// The chart as its faces are, where no outline can be made of it.
Region whole_chart(const FlatChart& flat) {
    Region region;
    region.points = flat.points;
    region.loops = chain_loops(flat.points, flat.boundary);
    double largest = 0.0;
    for (const model::Triangle& t : flat.triangles) {
        const Vec2 a = flat.points[t[0]], ab = flat.points[t[1]] - a, ac = flat.points[t[2]] - a;
        const double area = 0.5 * (ab.x * ac.y - ab.y * ac.x);
        if (area <= 0.0) continue; // a sliver whose projection is turned over
        region.triangles.push_back(t);
        region.area += area;
        if (area <= largest) continue;
        largest = area;
        region.inner = a + (ab + ac) / 3.0;
    }
    return region;
}

model::Patch front_patch(const PlacedChart& place, const FlatChart& flat, const Region& region) {
    model::Patch patch;
    patch.object = place.body->object;
    patch.material = place.chart->material;
    patch.surface = flat.surface;
    patch.points = region.points;
    patch.triangles = region.triangles;
    patch.loops = region.loops;
    patch.deviation_max = place.chart->deviation_max;
    patch.deviation_rms = place.chart->deviation_rms;
    return patch;
}

// The same surface seen from behind: axes exchanged, the domain mirrored.
model::Patch back_patch(const model::Patch& front) {
    model::Patch back = front;
    back.surface.axis_u = front.surface.axis_v;
    back.surface.axis_v = front.surface.axis_u;
    back.surface.axis_w = -front.surface.axis_w;
    for (Vec2& p : back.points) std::swap(p.x, p.y);
    for (model::Triangle& t : back.triangles) std::swap(t[1], t[2]);
    for (std::vector<std::uint32_t>& loop : back.loops) std::reverse(loop.begin(), loop.end());
    return back;
}

} // namespace

ChartPatches patches_of_chart(const std::vector<PlacedChart>& charts, std::size_t chart,
                              const FlatChart& flat, const Contacts& contacts, double contact_tolerance) {
    const PlacedChart& place = charts[chart];
    ChartPatches result;
    const double tolerance = std::max(contact_tolerance, 2.0 * place.chart->deviation_max);
    std::vector<Region> regions = cut_regions(flat, contacts.segments(chart, flat, tolerance), tolerance);
    if (!adds_up(regions, flat.area)) {
        regions = {whole_chart(flat)};
        result.kept_whole = true;
    }
    result.divided = regions.size() > 1;

    const std::vector<Cover> covers = contacts.covers(chart, flat, tolerance);
    for (const Region& region : regions) {
        bool front_covered = false, back_covered = false;
        for (const Cover& cover : covers) {
            if (!contacts.lies_in(flat, region.inner, cover.chart)) continue;
            front_covered = front_covered || cover.front;
            back_covered = back_covered || cover.back;
        }
        const auto take_or_leave = [&](bool covered, model::Patch patch) {
            if (covered) {
                ++result.covered;
                result.covered_area += region.area;
            } else {
                result.patches.push_back(std::move(patch));
            }
        };
        const model::Patch front = front_patch(place, flat, region);
        take_or_leave(front_covered, front);
        if (place.chart->two_sided) take_or_leave(back_covered, back_patch(front));
    }
    return result;
}

} // namespace kinelux::fit
