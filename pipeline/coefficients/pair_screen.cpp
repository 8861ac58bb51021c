// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/pair_screen.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/parallel.h"
#include "kernel/transport.h"

namespace kinelux::coefficients {

namespace {

using geometry::ElementShape;

constexpr std::size_t most_polygons = 4096; ///< 1.5 KiB of masks per element
constexpr int most_candidates = 24;         ///< polygons that are looked at one by one
constexpr double touching = 1e-9;   ///< of an element's radius: what reaches less far over a plane touches it
constexpr double one_plane = 1e-12; ///< 1 - cosine of two normals that are the same

std::size_t corner_count(const ElementShape& element) { return 3 * element.facets.size(); }
const Vec3& corner(const ElementShape& element, std::size_t k) {
    return element.facets[k / 3].corners[k % 3];
}

} // namespace

PairScreen::PairScreen(std::span<const ElementShape> elements, const visibility::PolygonBlockers* polygons)
    : elements_(elements) {
    for (const ElementShape& element : elements) {
        Bound bound{Vec3(0.0), 0.0, element.centre, element.radius, 0, element.planar};
        if (element.planar) {
            bound.normal = element.facets[0].normal;
            bound.offset = glm::dot(bound.normal, element.facets[0].corners[0]);
        }
        bounds_.push_back(bound);
    }
    number_planes();
    if (polygons == nullptr) return;
    screens_ = polygons->resting() <= most_polygons;
    if (screens_) add_polygons(*polygons);
}

// Each element is compared with the first of its plane, so that rounding does not add up.
void PairScreen::number_planes() {
    std::size_t first = 0;
    for (std::size_t i = 0; i < bounds_.size(); ++i) {
        const bool same = bounds_[i].planar && bounds_[first].planar &&
                          1.0 - glm::dot(bounds_[i].normal, bounds_[first].normal) < one_plane &&
                          !kernel::may_exchange(elements_[first], elements_[i]) &&
                          !kernel::may_exchange(elements_[i], elements_[first]);
        if (!same) first = i;
        bounds_[i].plane = static_cast<std::uint32_t>(first);
    }
}

void PairScreen::add_polygons(const visibility::PolygonBlockers& polygons) {
    const auto count = static_cast<std::uint32_t>(polygons.resting());
    for (std::uint32_t p = 0; p < count; ++p) {
        Sieve sieve{polygons[p].plane, static_cast<std::uint32_t>(borders_.size()), 0};
        if (polygons[p].convex) {
            const std::span<const Vec3> loop = polygons.loop_of(p, 0);
            for (std::size_t k = 0; k < loop.size(); ++k) {
                const Vec3 inwards =
                    glm::cross(sieve.plane.normal, loop[k + 1 < loop.size() ? k + 1 : 0] - loop[k]);
                const double length = glm::length(inwards);
                if (length > 0.0) borders_.push_back({inwards / length, glm::dot(inwards / length, loop[k])});
            }
            sieve.border_count = static_cast<std::uint32_t>(borders_.size()) - sieve.first_border;
        }
        sieves_.push_back(sieve);
    }
    words_ = (sieves_.size() + 63) / 64;
    for (auto* mask : {&before_, &behind_, &in_front_}) mask->assign(words_ * elements_.size(), 0);
    core::parallel_for(elements_.size(), [&](std::size_t i) { set_masks(i, polygons); });
}

void PairScreen::set_masks(std::size_t element, const visibility::PolygonBlockers& polygons) {
    const ElementShape& shape = elements_[element];
    const Bound& bound = bounds_[element];
    const double touch = touching * bound.radius;
    for (std::uint32_t p = 0; p < sieves_.size(); ++p) {
        const double height = sieves_[p].plane.distance(bound.centre);
        double lowest = height - bound.radius, highest = height + bound.radius;
        if (bound.planar && lowest < 0.0 && highest > 0.0) {
            lowest = highest = sieves_[p].plane.distance(corner(shape, 0));
            for (std::size_t k = 1; k < corner_count(shape); ++k) {
                lowest = std::min(lowest, sieves_[p].plane.distance(corner(shape, k)));
                highest = std::max(highest, sieves_[p].plane.distance(corner(shape, k)));
            }
        }
        bool in_front = !bound.planar;
        for (std::uint32_t loop = 0; loop < polygons[p].loop_count && !in_front; ++loop)
            for (const Vec3& point : polygons.loop_of(p, loop))
                in_front = in_front || glm::dot(bound.normal, point) - bound.offset > touch;
        const std::uint64_t bit = std::uint64_t{1} << (p % 64);
        const std::size_t word = element * words_ + p / 64;
        if (lowest >= -touch) before_[word] |= bit;
        if (highest <= touch) behind_[word] |= bit;
        if (in_front) in_front_[word] |= bit;
    }
}

bool PairScreen::may_exchange(std::size_t i, std::size_t j) const {
    const Bound &a = bounds_[i], &b = bounds_[j];
    if (a.planar && b.planar) {
        if (a.plane == b.plane) return false;
        const double over_a = glm::dot(a.normal, b.centre) - a.offset,
                     over_b = glm::dot(b.normal, a.centre) - b.offset;
        if (over_a <= -b.radius || over_b <= -a.radius) return false;
        if (over_a > 2.0 * b.radius && over_b > 2.0 * a.radius) return true;
    }
    return kernel::may_exchange(elements_[i], elements_[j]);
}

Screened PairScreen::look(std::size_t i, std::size_t j) const {
    const Bound &a = bounds_[i], &b = bounds_[j];
    if (a.planar && b.planar) {
        if (a.plane == b.plane) return Screened::Apart;
        const double over_a = glm::dot(a.normal, b.centre) - a.offset,
                     over_b = glm::dot(b.normal, a.centre) - b.offset;
        if (over_a <= -b.radius || over_b <= -a.radius) return Screened::Apart;
    }
    return screens_ ? look_through(i, j) : Screened::Undecided;
}

Screened PairScreen::look_through(std::size_t i, std::size_t j) const {
    Screened result = Screened::Clear;
    int candidates = 0;
    for (std::size_t w = 0; w < words_; ++w) {
        const std::size_t a = i * words_ + w, b = j * words_ + w;
        std::uint64_t between =
            in_front_[a] & in_front_[b] & ~(before_[a] & before_[b]) & ~(behind_[a] & behind_[b]);
        for (; between != 0; between &= between - 1) {
            if (++candidates > most_candidates) return Screened::Undecided;
            const auto p = 64 * w + static_cast<std::size_t>(std::countr_zero(between));
            switch (cover(sieves_[p], i, j)) {
            case Cover::All: return Screened::Hidden;
            case Cover::Unknown: result = Screened::Undecided; break;
            case Cover::None: break;
            }
        }
    }
    return result;
}

// By bounding spheres: what lies between them is no further from the line of their centres than the larger radius.
PairScreen::Cover PairScreen::cover(const Sieve& polygon, std::size_t i, std::size_t j) const {
    const Bound &a = bounds_[i], &b = bounds_[j];
    const double ha = polygon.plane.distance(a.centre), hb = polygon.plane.distance(b.centre);
    const double rise = ha - hb, radius = std::max(a.radius, b.radius);
    if (polygon.border_count == 0 || rise == 0.0) return Cover::Unknown;
    const double turn = rise > 0.0 ? 1.0 : -1.0;
    bool inside = std::abs(ha) >= a.radius && std::abs(hb) >= b.radius && ha * hb < 0.0;
    for (std::uint32_t k = 0; k < polygon.border_count; ++k) {
        const Border& border = borders_[polygon.first_border + k];
        const double da = glm::dot(border.inwards, a.centre) - border.offset,
                     db = glm::dot(border.inwards, b.centre) - border.offset;
        // The distance of the line of centres from the border's, times the length of their projection along it.
        const double moment = turn * (db * ha - da * hb);
        const double reach2 = radius * radius * (rise * rise + (da - db) * (da - db));
        if (moment * moment >= reach2) {
            if (moment < 0.0) return Cover::None;
        } else {
            inside = false;
        }
    }
    if (inside) return Cover::All;
    return a.planar && b.planar ? cover_by_corners(polygon, i, j) : Cover::Unknown;
}

// A segment from x to y, on either side of the plane, crosses it (d_y h_x - d_x h_y) / (h_x - h_y) inside of a border; h
// and d are distances from the plane and from the border.
PairScreen::Cover PairScreen::cover_by_corners(const Sieve& polygon, std::size_t i, std::size_t j) const {
    constexpr std::size_t most_corners = 12;
    struct Place {
        double h, d;
    };
    std::array<Place, most_corners> xs, ys;
    const ElementShape &a = elements_[i], &b = elements_[j];
    const std::size_t na = corner_count(a), nb = corner_count(b);
    if (na > most_corners || nb > most_corners) return Cover::Unknown;
    double lowest_a = INFINITY, highest_a = -INFINITY, lowest_b = INFINITY, highest_b = -INFINITY;
    for (std::size_t k = 0; k < na; ++k) {
        xs[k].h = polygon.plane.distance(corner(a, k));
        lowest_a = std::min(lowest_a, xs[k].h);
        highest_a = std::max(highest_a, xs[k].h);
    }
    for (std::size_t k = 0; k < nb; ++k) {
        ys[k].h = polygon.plane.distance(corner(b, k));
        lowest_b = std::min(lowest_b, ys[k].h);
        highest_b = std::max(highest_b, ys[k].h);
    }
    const bool downwards = lowest_a > 0.0 && highest_b < 0.0, upwards = highest_a < 0.0 && lowest_b > 0.0;
    if (!downwards && !upwards) return Cover::Unknown;
    const double turn = downwards ? 1.0 : -1.0;
    bool inside = true;
    for (std::uint32_t e = 0; e < polygon.border_count; ++e) {
        const Border& border = borders_[polygon.first_border + e];
        for (std::size_t k = 0; k < na; ++k)
            xs[k].d = turn * (glm::dot(border.inwards, corner(a, k)) - border.offset);
        for (std::size_t k = 0; k < nb; ++k)
            ys[k].d = turn * (glm::dot(border.inwards, corner(b, k)) - border.offset);
        double least = INFINITY, most = -INFINITY;
        for (std::size_t k = 0; k < na; ++k)
            for (std::size_t l = 0; l < nb; ++l) {
                const double moment = ys[l].d * xs[k].h - xs[k].d * ys[l].h;
                least = std::min(least, moment);
                most = std::max(most, moment);
            }
        const double touch = touching * std::max(a.radius, b.radius) * (highest_a - lowest_b);
        if (most <= std::abs(touch)) return Cover::None;
        inside = inside && least >= -std::abs(touch);
    }
    return inside ? Cover::All : Cover::Unknown;
}

} // namespace kinelux::coefficients
