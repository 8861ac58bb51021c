// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/unroll.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "fit/domain.h"
#include "fit/regions.h"
#include "fit/round_surface.h"
#include "geometry/domain_cut.h"
#include "geometry/facet_loops.h"
#include "geometry/surface.h"

namespace kinelux::fit {

namespace {

using model::DomainTriangle;
using model::Surface;
using model::SurfaceType;

constexpr double turn = 2.0 * std::numbers::pi;
// Angles are whole multiples of 2^-44 turns, so that a turn more or less is exact and equal places have equal bits.
constexpr double angle_steps = 17592186044416.0;
constexpr double at_seam = 1e-9;       // of a turn: rounding
constexpr double at_pole = 1e-7;       // of the radius
constexpr double area_agreement = 0.1; // of the area: facets are that much smaller than the surface at most
constexpr double straight = 1e-6;      // of an edge's length
constexpr double bent_share =
    0.1; // of a boundary edge's length: a line in u, v this far off its chord is divided
constexpr int most_divisions = 5;

bool closes_in_v(const Surface& s) { return s.type == SurfaceType::Torus; }

// Parameters in turns where they are angles.
class Parameters {
public:
    explicit Parameters(const Surface& s) : surface_(s), v_unit_(has_angle_v(s) ? turn : 1.0) {}

    Vec2 of(const Vec3& x) const {
        const Vec2 uv = round_parameters(surface_, x);
        return {rounded(uv.x / turn), rounded(uv.y / v_unit_)};
    }
    Vec2 radians(const Vec2& p) const { return {turn * p.x, v_unit_ * p.y}; }
    Vec3 position(const Vec2& p) const { return geometry::position(surface_, radians(p)); }
    const Surface& surface() const { return surface_; }

    /// Parameter v of the pole or tip that x is, if it is one.
    std::optional<double> pole(const Vec3& x) const {
        if (surface_.type != SurfaceType::Sphere && surface_.type != SurfaceType::Cone) return std::nullopt;
        const Vec3 offset = x - surface_.origin;
        const double height = glm::dot(offset, surface_.axis_w);
        if (glm::length(offset - height * surface_.axis_w) > at_pole * surface_.radius) return std::nullopt;
        if (surface_.type == SurfaceType::Sphere) return height > 0.0 ? 0.25 : -0.25;
        return -surface_.radius / std::tan(surface_.half_angle_rad);
    }

private:
    static bool has_angle_v(const Surface& s) {
        return s.type == SurfaceType::Sphere || s.type == SurfaceType::Torus;
    }
    static double rounded(double turns) { return std::round(turns * angle_steps) / angle_steps; }

    const Surface& surface_;
    double v_unit_;
};

// Where a circle is cut open: the middle of the widest gap that a set of arcs leaves, or the start of an arc.
double seam_of(std::vector<std::array<double, 2>> arcs) {
    std::sort(arcs.begin(), arcs.end());
    double reached = 0.0, widest = at_seam;
    for (const auto& arc : arcs) reached = std::max(reached, arc[1] - 1.0); // those that run over the end
    std::optional<double> middle;
    const auto gap = [&](double from, double to) {
        if (to - from <= widest) return;
        widest = to - from;
        middle = 0.5 * (from + to);
    };
    for (const auto& arc : arcs) {
        gap(reached, arc[0]);
        reached = std::max(reached, arc[1]);
    }
    gap(reached, 1.0 + arcs.front()[0]);
    const double seam = middle.value_or(arcs.front()[0]);
    return std::round((seam - std::floor(seam)) * angle_steps) / angle_steps;
}

using Corner = std::optional<Vec2>; // nothing at a pole

// Brings the angles of a face next to each other, lowest in [0, 1).
void gather(std::array<double, 3>& angles, std::size_t count) {
    for (std::size_t k = 1; k < count; ++k) angles[k] += std::round(angles[0] - angles[k]);
    const double low =
        std::floor(*std::min_element(angles.begin(), angles.begin() + static_cast<int>(count)));
    for (std::size_t k = 0; k < count; ++k) angles[k] -= low;
}

// A face in parameters: its corners, and which of them is a pole.
struct FlatFace {
    std::array<Vec2, 3> corners;
    std::optional<std::size_t> pole;
};

class Unrolling {
public:
    Unrolling(const Body& body, const RoundChart& chart) : parameters_(chart.surface) {
        for (const std::uint32_t f : chart.faces) {
            const model::Triangle& t = body.faces[f].corners;
            add({body.points[t[0]], body.points[t[1]], body.points[t[2]]});
        }
    }

    /// The whole domain as triangles, counter-clockwise, in turns.
    std::vector<DomainTriangle> domain() const {
        const Vec2 seam{seam_along(0), closes_in_v(parameters_.surface()) ? seam_along(1) : 0.0};
        std::vector<DomainTriangle> result;
        for (const FlatFace& face : faces_) {
            FlatFace moved = face;
            place(moved, 0, seam.x);
            if (closes_in_v(parameters_.surface())) place(moved, 1, seam.y);
            for (DomainTriangle t : triangles_of(moved)) {
                if (parameters_.surface().orientation < 0.0) std::swap(t[1], t[2]);
                cut_open(t, seam, result);
            }
        }
        return result;
    }

private:
    using Points = std::array<Vec3, 3>;

    void add(const Points& points) {
        const Surface& s = parameters_.surface();
        if (s.type == SurfaceType::Sphere) {
            for (const double side : {1.0, -1.0})
                if (const auto pole = pole_inside(points, side * s.axis_w)) {
                    for (std::size_t k = 0; k < 3; ++k) add_plain({points[k], points[(k + 1) % 3], *pole});
                    return;
                }
        }
        add_plain(points);
    }

    // The pole that a face hides, if none of its corners is one.
    std::optional<Vec3> pole_inside(const Points& points, const Vec3& direction) const {
        const Surface& s = parameters_.surface();
        for (const Vec3& x : points)
            if (parameters_.pole(x)) return std::nullopt;
        const Vec3 a = points[0] - s.origin, b = points[1] - s.origin, c = points[2] - s.origin;
        const double whole = glm::dot(a, glm::cross(b, c));
        if (whole == 0.0 || glm::dot(a + b + c, direction) <= 0.0) return std::nullopt;
        for (const double part :
             {glm::dot(direction, glm::cross(b, c)), glm::dot(a, glm::cross(direction, c)),
              glm::dot(a, glm::cross(b, direction))})
            if (part * whole < -at_seam * std::abs(whole) * s.radius) return std::nullopt;
        return s.origin + s.radius * direction;
    }

    void add_plain(const Points& points) {
        FlatFace face;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto pole = parameters_.pole(points[k]);
            if (pole && face.pole) return; // an edge that is a pole: no area
            if (pole) face.pole = k;
            face.corners[k] = pole ? Vec2{0.0, *pole} : parameters_.of(points[k]);
        }
        // The pole last.
        if (face.pole) {
            std::rotate(face.corners.begin(), face.corners.begin() + static_cast<int>((*face.pole + 1) % 3),
                        face.corners.end());
            face.pole = 2;
        }
        faces_.push_back(face);
    }

    static std::size_t corners_with_angle(const FlatFace& face) { return face.pole ? 2 : 3; }

    double seam_along(int axis) const {
        std::vector<std::array<double, 2>> arcs;
        for (const FlatFace& face : faces_) {
            std::array<double, 3> angles{face.corners[0][axis], face.corners[1][axis], face.corners[2][axis]};
            const std::size_t count = corners_with_angle(face);
            gather(angles, count);
            const auto [low, high] =
                std::minmax_element(angles.begin(), angles.begin() + static_cast<int>(count));
            arcs.push_back({*low, *high});
        }
        return seam_of(std::move(arcs));
    }

    // Angles of one face next to each other, the lowest in [seam, seam + 1).
    static void place(FlatFace& face, int axis, double seam) {
        std::array<double, 3> angles{};
        const std::size_t count = corners_with_angle(face);
        for (std::size_t k = 0; k < count; ++k) {
            angles[k] = face.corners[k][axis] - seam;
            const double whole = std::round(angles[k]);
            if (std::abs(angles[k] - whole) < at_seam) angles[k] = whole;
        }
        gather(angles, count);
        for (std::size_t k = 0; k < count; ++k) face.corners[k][axis] = angles[k] + seam;
    }

    // A face with a pole is a quadrilateral in parameters.
    static std::vector<DomainTriangle> triangles_of(const FlatFace& face) {
        const auto& [a, b, c] = face.corners;
        if (!face.pole) return {{a, b, c}};
        const Vec2 over_a{a.x, c.y}, over_b{b.x, c.y};
        return {{a, b, over_b}, {a, over_b, over_a}};
    }

    // Cuts a triangle at the seams it runs over and moves what is beyond by a turn. Beside poles a triangle may lie
    // turned over in u, v: it counts as negative, so that what its neighbours overlap cancels.
    void cut_open(DomainTriangle t, const Vec2& seam, std::vector<DomainTriangle>& result) const {
        const Vec2 ab = t[1] - t[0], ac = t[2] - t[0];
        const bool turned = ab.x * ac.y - ab.y * ac.x < 0.0;
        if (turned) std::swap(t[1], t[2]);
        const auto lines = [&](int axis) {
            const double low = std::min({t[0][axis], t[1][axis], t[2][axis]});
            const double high = std::max({t[0][axis], t[1][axis], t[2][axis]});
            std::vector<double> at{low, high};
            if (low < seam[axis] + 1.0 && high > seam[axis] + 1.0) at = {low, seam[axis] + 1.0, high};
            return at;
        };
        const std::vector<double> u_lines = lines(0), v_lines = lines(1);
        if (u_lines.front() == u_lines.back() || v_lines.front() == v_lines.back()) return;
        const bool v_closes = closes_in_v(parameters_.surface());
        for (const geometry::DomainCell& cell :
             geometry::cut_domain(std::span(&t, 1), u_lines,
                                  v_closes ? v_lines : std::vector{v_lines.front(), v_lines.back()}))
            for (DomainTriangle piece : cell.triangles) {
                for (Vec2& p : piece) {
                    if (cell.column > 0) p.x -= 1.0;
                    if (v_closes && cell.row > 0) p.y -= 1.0;
                }
                if (turned) std::swap(piece[1], piece[2]);
                result.push_back(piece);
            }
    }

    Parameters parameters_;
    std::vector<FlatFace> faces_;
};

// Points and boundary edges of a triangulated domain whose pieces share corners to the last bit.
struct Outline {
    std::vector<Vec2> points;
    std::vector<Edge> edges;
};

Outline outline_of(const std::vector<DomainTriangle>& domain) {
    Outline outline;
    std::map<std::pair<double, double>, std::uint32_t> numbers;
    std::map<Edge, int> open; // directed edges that no other runs back along
    const auto number = [&](const Vec2& p) {
        const auto [at, fresh] =
            numbers.try_emplace({p.x, p.y}, static_cast<std::uint32_t>(outline.points.size()));
        if (fresh) outline.points.push_back(p);
        return at->second;
    };
    for (const DomainTriangle& t : domain) {
        const std::array<std::uint32_t, 3> corners{number(t[0]), number(t[1]), number(t[2])};
        for (std::size_t k = 0; k < 3; ++k) {
            const Edge edge{corners[k], corners[(k + 1) % 3]};
            const auto back = open.find({edge[1], edge[0]});
            if (back == open.end()) {
                ++open[edge];
            } else if (--back->second == 0) {
                open.erase(back);
            }
        }
    }
    for (const auto& [edge, count] : open)
        for (int i = 0; i < count; ++i) outline.edges.push_back(edge);
    return outline;
}

// Loops without the points between which they run straight, and with points where a straight line in parameters would
// leave the mesh's edge.
class Loops {
public:
    Loops(const Parameters& parameters, const Outline& outline) : parameters_(parameters) {
        for (const std::vector<std::uint32_t>& loop : chain_loops(outline.points, outline.edges)) {
            std::vector<Vec3> corners;
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const Vec2 a = outline.points[loop[i]], b = outline.points[loop[(i + 1) % loop.size()]];
                corners.emplace_back(a.x, a.y, 0.0);
                divide(a, b, most_divisions, corners);
            }
            const std::vector<std::size_t> kept = geometry::turning_points(corners, straight);
            if (kept.size() < 3) continue;
            const auto first = static_cast<std::uint32_t>(points.size());
            const auto count = static_cast<std::uint32_t>(kept.size());
            for (const std::size_t i : kept) points.emplace_back(corners[i].x, corners[i].y);
            for (std::uint32_t i = 0; i < count; ++i) edges.push_back({first + i, first + (i + 1) % count});
        }
    }

    std::vector<Vec2> points;
    std::vector<Edge> edges;

private:
    // Adds the points between the ends of a mesh's edge.
    void divide(const Vec2& a, const Vec2& b, int left, std::vector<Vec3>& between) const {
        const Vec3 from = parameters_.position(a), to = parameters_.position(b);
        const double length = glm::distance(from, to);
        if (left == 0 || !(length > at_pole * parameters_.surface().radius))
            return; // the second: along a pole
        const Vec2 straight_middle = 0.5 * (a + b);
        Vec2 middle = parameters_.of(0.5 * (from + to));
        middle.x += std::round(straight_middle.x - middle.x);
        if (closes_in_v(parameters_.surface())) middle.y += std::round(straight_middle.y - middle.y);
        const double off = glm::distance(parameters_.position(middle), parameters_.position(straight_middle));
        if (!(off > bent_share * length) || std::abs(a.x - b.x) > 0.5) return;
        divide(a, middle, left - 1, between);
        between.emplace_back(middle.x, middle.y, 0.0);
        divide(middle, b, left - 1, between);
    }

    const Parameters& parameters_;
};

model::Patch patch_of(const Body& body, const RoundChart& chart, const Region& region) {
    model::Patch patch;
    patch.object = body.object;
    patch.material = chart.material;
    patch.surface = chart.surface;
    patch.points = region.points;
    patch.triangles = region.triangles;
    patch.loops = region.loops;
    patch.deviation_max = chart.deviation_max;
    patch.deviation_rms = chart.deviation_rms;
    return patch;
}

} // namespace

std::vector<model::Patch> patches_of_round_chart(const Body& body, const RoundChart& chart) {
    const Parameters parameters(chart.surface);
    const Outline outline = outline_of(Unrolling(body, chart).domain());
    Loops loops(parameters, outline);
    for (Vec2& p : loops.points) p = parameters.radians(p);
    std::vector<model::Patch> patches;
    if (loops.edges.empty()) return patches;
    double area = 0.0;
    for (const Region& region : divide_domain(loops.points, loops.edges, {}, {})) {
        patches.push_back(patch_of(body, chart, region));
        area += geometry::area(patches.back());
    }
    if (!(std::abs(area - chart.area) <= area_agreement * chart.area)) return {};
    if (!chart.two_sided) return patches;
    const std::size_t fronts = patches.size();
    for (std::size_t p = 0; p < fronts; ++p) {
        patches.push_back(patches[p]);
        patches.back().surface.orientation = -patches[p].surface.orientation;
    }
    return patches;
}

} // namespace kinelux::fit
