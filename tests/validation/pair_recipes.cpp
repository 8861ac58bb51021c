// SPDX-License-Identifier: GPL-3.0-or-later
#include "pair_recipes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "core/sequence.h"
#include "support/planar_patches.h"

namespace kinelux::validation {

namespace {

using Outline = std::vector<Vec2>; // counter-clockwise, seen whole from its first corner

constexpr double degree = std::numbers::pi / 180.0;

// Random numbers of one pair.
class Dice {
public:
    explicit Dice(std::uint64_t seed) : random_(seed) {}
    double between(double low, double high) { return low + (high - low) * random_.next(); }
    double decades(double low, double high) { return std::pow(10.0, between(low, high)); }
    int below(int count) { return std::min(count - 1, static_cast<int>(between(0.0, count))); }
    Vec3 direction() {
        const double z = between(-1.0, 1.0), angle = between(0.0, 2.0 * std::numbers::pi);
        const double r = std::sqrt(1.0 - z * z);
        return {r * std::cos(angle), r * std::sin(angle), z};
    }

private:
    core::Random random_;
};

// A flat element before it is given a basis: an outline, or a rectangle with a hole.
struct Flat {
    Outline outline;
    bool framed = false;
    Vec2 hole_low{0.0}, hole_high{0.0};
};

// Places a plane's coordinates in space.
struct Frame {
    Vec3 origin{0.0}, u{1.0, 0.0, 0.0}, v{0.0, 1.0, 0.0};
    Vec3 operator()(const Vec2& p) const { return origin + p.x * u + p.y * v; }
};

struct Layout {
    Flat a, b;
    Frame frame_a, frame_b;
    std::string what;
};

// A polygon with the edge from (0,0) to (length,0) and all else above it.
Outline with_base(Dice& dice, double length) {
    const double depth = length * dice.between(0.4, 2.0);
    switch (dice.below(4)) {
    case 0: return {{0, 0}, {length, 0}, {length, depth}, {0, depth}};
    case 1: return {{0, 0}, {length, 0}, {length * dice.between(-0.3, 1.3), depth}};
    case 2:
        return {{0, 0},
                {length, 0},
                {length * dice.between(0.7, 1.4), depth * dice.between(0.6, 1.2)},
                {length * dice.between(-0.4, 0.3), depth}};
    default: { // an L whose inner corner sees all of it
        const double w = length * dice.between(0.3, 0.6), d = depth * dice.between(0.3, 0.6);
        return {{w, d}, {w, depth}, {0, depth}, {0, 0}, {length, 0}, {length, d}};
    }
    }
}

Flat plain(Outline outline) { return {std::move(outline)}; }

Flat framed(Dice& dice, double length) {
    Flat flat{{{0, 0}, {length, 0}, {length, length}, {0, length}}, true};
    const double rim = dice.between(0.05, 0.3);
    flat.hole_low = Vec2(rim, rim * dice.between(0.5, 1.0));
    flat.hole_high = Vec2(1.0 - rim * dice.between(0.5, 1.0), 1.0 - rim);
    return flat;
}

Outline shifted(Outline outline, const Vec2& by) {
    for (Vec2& p : outline) p += by;
    return outline;
}

Flat shifted(Flat flat, const Vec2& by) {
    flat.outline = shifted(std::move(flat.outline), by);
    return flat;
}

// The plane through the x axis that stands at an angle over the plane z = 0, facing it; its v axis leads away from the
// axis. Seen from its front, x runs to the left, so an outline over it is mirrored.
Frame hinged(double angle) { return {Vec3(0.0), Vec3(-1, 0, 0), Vec3(0, std::cos(angle), std::sin(angle))}; }

Outline mirrored(Outline outline) {
    for (Vec2& p : outline) p.x = -p.x;
    std::reverse(outline.begin() + 1, outline.end());
    return outline;
}

Flat mirrored(Flat flat) {
    if (flat.framed) {
        const Vec2 shift(-flat.outline[1].x, 0.0);
        return shifted(std::move(flat), shift);
    }
    flat.outline = mirrored(std::move(flat.outline));
    return flat;
}

double lowest(const Flat& flat, const Frame& frame, const Frame& plane) {
    const Vec3 normal = glm::normalize(glm::cross(plane.u, plane.v));
    double low = std::numeric_limits<double>::infinity();
    for (const Vec2& p : flat.outline) low = std::min(low, glm::dot(frame(p) - plane.origin, normal));
    return low;
}

double highest(const Flat& flat, const Frame& frame, const Frame& plane) {
    const Frame flipped{plane.origin, plane.v, plane.u};
    return -lowest(flat, frame, flipped);
}

Frame random_frame(Dice& dice, const Vec3& origin) {
    const Vec3 w = dice.direction();
    const Vec3 u = glm::normalize(glm::cross(w, dice.direction()));
    return {origin, u, glm::cross(w, u)};
}

// Tries placements of b until both lie as wanted to each other's plane: wholly in front, or cut by it.
enum class Wanted : std::uint8_t { InFront, Cut };
void place_apart(Dice& dice, Layout& layout, double low, double high, Wanted wanted) {
    for (int attempt = 0; attempt < 10000; ++attempt) {
        const double distance = dice.between(low, high);
        const Vec3 direction = dice.direction();
        layout.frame_b = random_frame(dice, Vec3(0.5, 0.5, 0.0) + (0.5 + distance) * direction);
        const double la = lowest(layout.a, layout.frame_a, layout.frame_b);
        const double lb = lowest(layout.b, layout.frame_b, layout.frame_a);
        const double ha = highest(layout.a, layout.frame_a, layout.frame_b);
        const double hb = highest(layout.b, layout.frame_b, layout.frame_a);
        const double enough = 0.05;
        const bool facing = ha > enough && hb > enough;
        if (wanted == Wanted::InFront && la > enough * low && lb > enough * low) break;
        if (wanted == Wanted::Cut && facing && (la < -enough || lb < -enough)) break;
    }
    layout.what = fmt::format("origin of b {:.3f} {:.3f} {:.3f}", layout.frame_b.origin.x,
                              layout.frame_b.origin.y, layout.frame_b.origin.z);
}

void place_hinged(Dice& dice, Layout& layout) {
    const double angle = dice.between(5.0, 170.0);
    layout.b = mirrored(std::move(layout.b));
    layout.frame_b = hinged(angle * degree);
    layout.what = fmt::format("angle {:.2f}", angle);
}

Vec2 middle(const Flat& flat) {
    Vec2 sum(0.0);
    for (const Vec2& p : flat.outline) sum += p / static_cast<double>(flat.outline.size());
    return sum;
}

// One over the other: congruent, on a common edge line, or with both middles no further than `size` / 2 apart.
void place_facing(Dice& dice, Layout& layout, double size) {
    const double gap = dice.decades(-9.0, -1.0) * size;
    const double turn = dice.below(3) == 0 ? 0.0 : dice.between(0.0, 2.0 * std::numbers::pi);
    const double tilt = dice.below(3) == 0 ? gap * dice.between(0.0, 0.5) : 0.0;
    const double c = std::cos(turn), s = std::sin(turn);
    layout.frame_b = {Vec3(0.0), Vec3(-c, s, 0.0), Vec3(s, c, tilt)};
    const int place = dice.below(4);
    if (place == 0) layout.b = mirrored(layout.a);
    const Vec2 shift{dice.between(-0.5, 0.5), dice.between(-0.5, 0.5)};
    const Vec2 centre_b(layout.frame_b(middle(layout.b)));
    if (place != 0) layout.frame_b.origin = Vec3(middle(layout.a) - centre_b + size * shift, 0.0);
    if (place == 1) layout.frame_b.origin.y = 0.0;
    layout.frame_b.origin.z = gap;
    layout.what = fmt::format("gap {:.2e} turn {:.2f} tilt {:.1e} place {}", gap, turn, tilt, place);
}

Layout hinge_layout(Dice& dice) {
    const double length = 1.0;
    Layout layout{plain(with_base(dice, length)), plain(with_base(dice, length)), {}, {}, {}};
    place_hinged(dice, layout);
    return layout;
}

Layout part_edge_layout(Dice& dice) {
    Layout layout{plain(with_base(dice, 1.0)), plain(with_base(dice, dice.between(0.3, 1.2))), {}, {}, {}};
    const double start = dice.below(4) == 0 ? 0.0 : dice.between(-0.4, 0.8);
    layout.b = shifted(std::move(layout.b), Vec2(start, 0.0));
    place_hinged(dice, layout);
    layout.what += fmt::format(" start {:.3f}", start);
    return layout;
}

Layout vertex_layout(Dice& dice) {
    const auto corner = [&] {
        const Vec2 p{dice.between(-1.0, 0.9), dice.between(0.2, 1.0)};
        const Vec2 q{p.x - dice.between(0.5, 1.2), p.y * dice.between(0.5, 1.0) + 0.1};
        return Outline{{0, 0}, p, q};
    };
    Layout layout{plain(corner()), plain(corner()), {}, {}, {}};
    place_hinged(dice, layout);
    return layout;
}

Layout hinge_gap_layout(Dice& dice) {
    Layout layout = hinge_layout(dice);
    const double gap = dice.decades(-9.0, -2.0), way = dice.between(0.0, 1.0);
    const Vec3 up(0, 0, 1), normal_b = glm::cross(layout.frame_b.u, layout.frame_b.v);
    layout.frame_b.origin += gap * glm::normalize(way * up - (1.0 - way) * normal_b);
    layout.what += fmt::format(" gap {:.2e}", gap);
    return layout;
}

Layout crossing_layout(Dice& dice) {
    Layout layout = hinge_layout(dice);
    layout.frame_b.origin += Vec3{dice.between(-0.3, 0.3), dice.between(0.05, 0.6), -dice.between(0.0, 0.4)};
    return layout;
}

// A special element a, and b in one of three places.
Layout special_layout(Dice& dice, Flat a, double size) {
    Layout layout{std::move(a), plain(with_base(dice, dice.between(0.5, 1.5))), {}, {}, {}};
    switch (dice.below(3)) {
    case 0: place_apart(dice, layout, 0.1, 1.5, Wanted::InFront); break;
    case 1: place_hinged(dice, layout); break;
    default: place_facing(dice, layout, size);
    }
    return layout;
}

Layout sliver_layout(Dice& dice) {
    const double width = dice.decades(-3.0, -1.5);
    const bool triangle = dice.below(2) == 0;
    Outline outline = triangle ? Outline{{0, 0}, {1, 0}, {dice.between(0.0, 1.0), width}}
                               : Outline{{0, 0}, {1, 0}, {1, width}, {0, width}};
    if (dice.below(3) == 0) // hinged along its short side
        for (Vec2& p : outline) p = Vec2(width - p.y, p.x);
    Layout layout = special_layout(dice, plain(std::move(outline)), 1.0);
    layout.what += fmt::format(" width {:.2e}", width);
    return layout;
}

Layout tiny_huge_layout(Dice& dice) {
    const double size = dice.decades(-3.0, -1.0);
    Layout layout{plain(with_base(dice, 1.0)), plain(with_base(dice, size)), {}, {}, {}};
    const Vec2 at(dice.between(0.1, 0.8), 0.0);
    switch (dice.below(3)) {
    case 0: // somewhere above a, turned
        do
            layout.frame_b =
                random_frame(dice, Vec3{at.x, dice.between(0.1, 0.3), size * dice.decades(0.0, 1.5)});
        while (lowest(layout.b, layout.frame_b, layout.frame_a) < 0.1 * size ||
               highest(layout.a, layout.frame_a, layout.frame_b) < 0.1);
        break;
    case 1: // its base on a's edge
        layout.b = shifted(std::move(layout.b), at);
        place_hinged(dice, layout);
        break;
    default: place_facing(dice, layout, size);
    }
    layout.what += fmt::format(" size {:.2e}", size);
    return layout;
}

Layout layout_of(PairClass kind, Dice& dice) {
    Layout layout{plain(with_base(dice, 1.0)), plain(with_base(dice, dice.between(0.5, 1.5))), {}, {}, {}};
    switch (kind) {
    case PairClass::Distant: place_apart(dice, layout, 3.0, 8.0, Wanted::InFront); return layout;
    case PairClass::Close: place_apart(dice, layout, 0.2, 1.5, Wanted::InFront); return layout;
    case PairClass::Horizon: place_apart(dice, layout, 0.8, 3.0, Wanted::Cut); return layout;
    case PairClass::Facing: place_facing(dice, layout, 1.0); return layout;
    case PairClass::Hinge: return hinge_layout(dice);
    case PairClass::PartEdge: return part_edge_layout(dice);
    case PairClass::Vertex: return vertex_layout(dice);
    case PairClass::HingeGap: return hinge_gap_layout(dice);
    case PairClass::Crossing: return crossing_layout(dice);
    case PairClass::Sliver: return sliver_layout(dice);
    case PairClass::TinyHuge: return tiny_huge_layout(dice);
    case PairClass::Frame: return special_layout(dice, framed(dice, 1.0), 1.0);
    }
    return layout;
}

model::Patch patch_of(const Flat& flat, const Frame& frame) {
    if (flat.framed) {
        const Vec3 corner = frame(flat.outline[0]);
        return support::frame_patch(corner, frame(flat.outline[1]) - corner, frame(flat.outline[3]) - corner,
                                    flat.hole_low, flat.hole_high);
    }
    std::vector<Vec3> corners;
    for (const Vec2& p : flat.outline) corners.push_back(frame(p));
    return support::polygon_patch(corners);
}

Frame placed(const Frame& frame, const Frame& place, double scale) {
    const Vec3 w = glm::cross(place.u, place.v);
    const auto turn = [&](const Vec3& x) { return x.x * place.u + x.y * place.v + x.z * w; };
    return {place.origin + scale * turn(frame.origin), scale * turn(frame.u), scale * turn(frame.v)};
}

Dice dice_of(const PairRecipe& recipe) {
    return Dice(core::mix(recipe.seed, static_cast<std::uint64_t>(recipe.kind)));
}

} // namespace

TestPair make_pair(const PairRecipe& recipe, const Placement& placement) {
    Dice dice = dice_of(recipe);
    const Layout layout = layout_of(recipe.kind, dice);
    const Frame place{placement.origin, placement.axis_u, placement.axis_v};
    model::PatchSet set;
    set.patches = {patch_of(layout.a, placed(layout.frame_a, place, placement.scale)),
                   patch_of(layout.b, placed(layout.frame_b, place, placement.scale))};
    auto shapes = geometry::element_shapes(set, support::whole_patch_elements(set), recipe.degree, 0);
    return {std::move(shapes[0]), std::move(shapes[1]), layout.what};
}

TestPair make_pair(const PairRecipe& recipe) {
    Dice dice = dice_of(recipe);
    layout_of(recipe.kind, dice); // the placement's numbers follow the layout's
    const double scale = dice.decades(-2.0, 2.0);
    const double offset = scale * dice.between(0.0, 3.0);
    const Frame place = random_frame(dice, offset * dice.direction());
    return make_pair(recipe, Placement{scale, place.u, place.v, place.origin});
}

PairRecipe series_recipe(std::uint64_t index, std::uint64_t seed) {
    Dice dice(core::mix(seed, index));
    const int high = dice.below(10);
    return {static_cast<PairClass>(index % pair_class_names.size()), core::mix(seed, index),
            high == 0 ? 4 + dice.below(3) : dice.below(4)};
}

} // namespace kinelux::validation
