// SPDX-License-Identifier: GPL-3.0-or-later
#include "curved_pairs.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "core/sequence.h"
#include "kernel/facet_sum.h"
#include "kernel/near_pair.h"
#include "kernel/surface_cells.h"
#include "kernel/transport.h"
#include "support/curved.h"
#include "support/planar_patches.h"
#include "support/point_integral.h"

namespace kinelux::validation {

namespace {

using geometry::ElementShape;
using geometry::SurfaceNode;
using model::SurfaceType;

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

// The shortest turn that takes one direction to another.
Quat turn_between(const Vec3& from, const Vec3& to) {
    const Vec3 axis = glm::cross(from, to);
    const double cosine = glm::dot(from, to);
    if (cosine < -0.999999) {
        const Vec3 helper = std::abs(from.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        const Vec3 across = glm::normalize(glm::cross(from, helper));
        return {0.0, across.x, across.y, across.z};
    }
    return glm::normalize(Quat(1.0 + cosine, axis.x, axis.y, axis.z));
}

model::Surface random_surface(Dice& dice, ElementKind kind) {
    static constexpr std::array types{SurfaceType::Cylinder, SurfaceType::Cone,     SurfaceType::Sphere,
                                      SurfaceType::Torus,    SurfaceType::Bilinear, SurfaceType::BSpline};
    model::Surface s =
        support::tilted_surface(types[static_cast<std::size_t>(kind)], dice.below(3) == 0 ? 1.0 : -1.0);
    s.minor_radius = dice.between(0.2, 0.6);
    s.half_angle_rad = dice.between(-0.6, 0.6);
    for (Vec3& corner : s.corners) corner.z += dice.between(-0.4, 0.4);
    if (s.type != SurfaceType::BSpline) return s;
    s.bspline = {.degree_u = 2, .degree_v = 2, .count_u = 4, .count_v = 3};
    s.bspline.knots_u = {0, 0, 0, 0.5, 1, 1, 1};
    s.bspline.knots_v = {0, 0, 0, 1, 1, 1};
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 4; ++i) {
            s.bspline.poles.emplace_back(i / 3.0, j / 2.0, dice.between(-0.3, 0.3));
            s.bspline.weights.push_back(dice.between(0.7, 1.3));
        }
    return s;
}

struct Part {
    Vec2 low, high;
};

// A part of a surface, and the part beyond its side of largest u.
std::array<Part, 2> random_parts(Dice& dice, const model::Surface& surface) {
    const bool unit = surface.type == SurfaceType::Bilinear || surface.type == SurfaceType::BSpline;
    const bool round_v = surface.type == SurfaceType::Sphere || surface.type == SurfaceType::Torus;
    const double u0 = unit ? 0.0 : dice.between(0.0, 4.0), span = unit ? 0.5 : dice.between(0.3, 1.2);
    const double v0 = unit ? 0.0 : round_v ? dice.between(-1.2, 0.3) : dice.between(-0.8, 0.0);
    const double height = unit ? 1.0 : dice.between(0.3, 0.9);
    return {Part{{u0, v0}, {u0 + span, v0 + height}},
            Part{{u0 + span, v0}, {u0 + span + (unit ? 0.5 : dice.between(0.3, 1.2)), v0 + height}}};
}

// A body of small triangles: a bumpy sheet, or triangles thrown about; as one cluster or two halves with a common edge.
struct SmallBody {
    model::SmallTriangles small;
    std::size_t half = 0; ///< triangles in the first half
};

SmallBody random_body(Dice& dice) {
    SmallBody body;
    const auto add = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
        const auto first = static_cast<std::uint32_t>(body.small.points.size());
        for (const Vec3& point : {p, q, r}) body.small.points.push_back(point);
        body.small.triangles.push_back({first, first + 1, first + 2});
        body.small.objects.emplace_back();
        body.small.materials.emplace_back();
    };
    if (dice.below(4) == 0) {
        const int count = 6 + dice.below(30);
        for (int t = 0; t < count; ++t) {
            const Vec3 p(dice.between(-0.5, 0.5), dice.between(-0.5, 0.5), dice.between(-0.2, 0.2));
            const Vec3 n = glm::normalize(Vec3(0, 0, 1) + 0.8 * dice.direction());
            const Vec3 u = 0.15 * glm::normalize(glm::cross(n, dice.direction())), v = glm::cross(n, u);
            add(p, p + u, p + 0.4 * u + v);
        }
        body.half = static_cast<std::size_t>(count / 2);
        return body;
    }
    const int n = 2 + dice.below(7);
    const double bump = dice.between(0.02, 0.15), bowl = dice.between(-0.6, 0.6);
    std::vector<Vec3> grid;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
            const double x = static_cast<double>(i) / n - 0.5, y = static_cast<double>(j) / n - 0.5;
            grid.emplace_back(x, y, bowl * (x * x + y * y) + bump * dice.between(-1.0, 1.0) / n);
        }
    for (int i = 0; i < n; ++i) {
        if (i == n / 2) body.half = body.small.triangles.size();
        for (int j = 0; j < n; ++j) {
            const auto at = [&](int di, int dj) {
                const int point = (i + di) * (n + 1) + j + dj;
                return grid[static_cast<std::size_t>(point)];
            };
            add(at(0, 0), at(1, 0), at(1, 1));
            add(at(0, 0), at(1, 1), at(0, 1));
        }
    }
    return body;
}

ElementShape cluster_of(const SmallBody& body, std::size_t first, std::size_t last, int degree) {
    model::PatchSet set;
    set.small = body.small;
    model::ClusterTree tree;
    model::Cluster cluster;
    for (std::size_t t = first; t < last; ++t) cluster.triangles.push_back(static_cast<std::uint32_t>(t));
    tree.clusters = {cluster};
    model::Element element;
    element.cluster = ClusterId(0);
    tree.elements = {element};
    return geometry::element_shapes(set, tree, 0, degree).front();
}

ElementShape element_of(const model::Patch& patch, int degree) {
    model::PatchSet set;
    set.patches = {patch};
    return geometry::element_shapes(set, support::whole_patch_elements(set), degree, 0).front();
}

model::Patch random_polygon(Dice& dice) {
    const double w = dice.between(0.4, 1.5), h = dice.between(0.4, 1.5);
    const std::vector<Vec3> corners{{0, 0, 0}, {w, 0, 0}, {w * dice.between(0.5, 1.2), h, 0}, {0, h, 0}};
    return support::polygon_patch(corners);
}

ElementShape random_element(Dice& dice, ElementKind kind) {
    if (kind == ElementKind::Planar) return element_of(random_polygon(dice), dice.below(4));
    if (kind == ElementKind::Cluster) {
        const SmallBody body = random_body(dice);
        return cluster_of(body, 0, body.small.triangles.size(), dice.below(8) == 0 ? 1 : 0);
    }
    const model::Surface surface = random_surface(dice, kind);
    const Part part = random_parts(dice, surface)[0];
    return element_of(support::surface_patch(surface, part.low, part.high), dice.below(4));
}

CurvedPair neighbours(Dice& dice, ElementKind kind) {
    if (kind == ElementKind::Cluster) {
        const SmallBody body = random_body(dice);
        return {cluster_of(body, 0, body.half, 0),
                cluster_of(body, body.half, body.small.triangles.size(), 0)};
    }
    const model::Surface surface = random_surface(dice, kind);
    const auto parts = random_parts(dice, surface);
    const int degree = dice.below(4);
    return {element_of(support::surface_patch(surface, parts[0].low, parts[0].high), degree),
            element_of(support::surface_patch(surface, parts[1].low, parts[1].high), degree)};
}

// A node of an element, or a corner of it with the normal of a node.
SurfaceNode random_point(Dice& dice, const ElementShape& shape, bool corner) {
    const auto& nodes = shape.rules.back().nodes;
    SurfaceNode point = nodes[static_cast<std::size_t>(dice.below(static_cast<int>(nodes.size())))];
    const auto& facet =
        shape.facets[static_cast<std::size_t>(dice.below(static_cast<int>(shape.facets.size())))];
    if (corner) point.position = facet.corners[static_cast<std::size_t>(dice.below(3))];
    return point;
}

double size_of(const ElementShape& shape) { return std::sqrt(shape.area); }

// Moves an element to a place in front of another one.
ElementShape placed(Dice& dice, const ElementShape& a, const ElementShape& rest, Place place) {
    const bool touching = place == Place::Touching;
    const SurfaceNode at = random_point(dice, a, false), from = random_point(dice, rest, touching);
    const double size = std::min(size_of(a), size_of(rest));
    const double gap = touching              ? 0.0
                       : place == Place::Far ? size * dice.between(2.0, 6.0)
                                             : size * dice.decades(-1.7, 0.0);
    const Vec3 sideways = touching ? Vec3(0.0) : 0.5 * gap * dice.direction();
    const Vec3 facing = glm::normalize(-at.normal + dice.between(0.0, 1.2) * dice.direction());
    geometry::Pose pose;
    pose.rotation = turn_between(from.normal, facing);
    pose.translation = at.position + gap * at.normal + sideways - pose.rotation * from.position;
    return geometry::moved(rest, pose);
}

// Whether nodes of b lie on both sides of the tangent planes of a's nearest nodes.
bool cross(const ElementShape& a, const ElementShape& b) {
    bool front = false, behind = false;
    for (const SurfaceNode& y : b.rules.back().nodes) {
        const auto& xs = a.rules.back().nodes;
        const auto nearest = std::min_element(xs.begin(), xs.end(), [&](auto& p, auto& q) {
            return glm::distance(p.position, y.position) < glm::distance(q.position, y.position);
        });
        (glm::dot(nearest->normal, y.position - nearest->position) > 0.0 ? front : behind) = true;
    }
    return front && behind;
}

// The inner integral of a reference over flat facets: each is cut at the point's horizon and integrated in its plane.
class FlatReference : public kernel::PointGather {
public:
    explicit FlatReference(const ElementShape& b) : b_(b), pieces_(support::flat_pieces(b)) {}
    void gather(const SurfaceNode& x, std::span<double> values) override {
        std::fill(values.begin(), values.end(), 0.0);
        const Vec3 helper = std::abs(x.normal.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        support::Plane horizon;
        horizon.origin = x.position;
        horizon.normal = x.normal;
        horizon.axis_u = glm::normalize(glm::cross(helper, x.normal));
        horizon.axis_v = glm::cross(x.normal, horizon.axis_u);
        for (const support::FlatPiece& piece : pieces_) {
            if (!(piece.plane.height(x.position) > 0.0)) continue;
            const support::FlatPiece front = support::in_front(piece, horizon);
            if (!front.parts.empty())
                support::PointIntegral(front, b_.basis).add(x.position, x.normal, values);
        }
    }

private:
    const ElementShape& b_;
    std::vector<support::FlatPiece> pieces_;
};

double norm(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

// G from one side, outer x inner, by adaptive Gauss products on every facet.
kernel::OuterResult reference_from(const ElementShape& outer, const ElementShape& inner, bool itself,
                                   double tolerance, double scale) {
    std::unique_ptr<kernel::PointGather> gather;
    if (inner.surface)
        gather = std::make_unique<kernel::SurfaceCells>(inner, tolerance * scale / size_of(outer),
                                                        itself ? kernel::SurfaceCells::Points::OnTheSurface
                                                               : kernel::SurfaceCells::Points::Anywhere);
    else
        gather = std::make_unique<FlatReference>(inner);
    std::vector<kernel::OuterPiece> pieces;
    for (const geometry::Facet& facet : outer.facets)
        pieces.push_back({&facet, {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}});
    const kernel::OuterOptions options{
        .tolerance = tolerance, .floor = scale, .most_points = 20000 + 18 * pieces.size()};
    return kernel::integrate_outer(outer, pieces, inner.basis.size(), *gather, options);
}

// Of this thread [s].
double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

} // namespace

CurvedRecipe curved_recipe(std::uint64_t index, std::uint64_t seed) {
    CurvedRecipe recipe;
    recipe.seed = core::mix(seed, index);
    Dice dice(core::mix(recipe.seed, 1));
    recipe.a = static_cast<ElementKind>(index % 7);
    recipe.b = dice.below(2) == 0 ? ElementKind::Planar : static_cast<ElementKind>(dice.below(7));
    constexpr std::array places{Place::Far,  Place::Near,     Place::Near,      Place::Near,
                                Place::Near, Place::Touching, Place::Neighbour, Place::Itself};
    recipe.place = places[(index / 7) % places.size()];
    return recipe;
}

CurvedPair make_curved_pair(const CurvedRecipe& recipe) {
    Dice dice(recipe.seed);
    CurvedPair pair;
    if (recipe.place == Place::Neighbour) {
        pair = neighbours(dice, recipe.a);
    } else {
        pair.a = random_element(dice, recipe.a);
        pair.itself = recipe.place == Place::Itself;
        if (pair.itself) {
            pair.b = pair.a;
            return pair;
        }
        const ElementShape rest = random_element(dice, recipe.b);
        constexpr int most_tries = 20;
        for (int attempt = 0; attempt < most_tries; ++attempt) {
            pair.b = placed(dice, pair.a, rest, recipe.place);
            if (recipe.place == Place::Touching || !cross(pair.a, pair.b)) break;
        }
    }
    pair.b.id = ElementId(1);
    return pair;
}

CurvedJudgement judge_curved(const CurvedRecipe& recipe, double tolerance) {
    static const visibility::Occluders nothing{std::vector<visibility::Body>()};
    const CurvedPair pair = make_curved_pair(recipe);
    const ElementShape &a = pair.a, &b = pair.itself ? pair.a : pair.b;
    CurvedJudgement judgement{.recipe = recipe, .degree_a = a.basis.degree(), .degree_b = b.basis.degree()};
    double start = processor_time();
    const auto block = kernel::transport(a, b, nothing, {.tolerance = tolerance, .occlusion = false});
    judgement.seconds = processor_time() - start;
    start = processor_time();
    constexpr double finer = 0.1;
    constexpr double negligible = 1e-3;
    const double floor = negligible * std::sqrt(std::min(a.area, b.area) / std::max(a.area, b.area));
    const double guess = std::max(floor, norm(block.values));
    const auto from_a = reference_from(a, b, pair.itself, finer * tolerance, guess);
    const auto from_b = reference_from(b, a, pair.itself, finer * tolerance, guess);
    judgement.reference_seconds = processor_time() - start;
    const std::size_t na = a.basis.size(), nb = b.basis.size();
    double error2 = 0.0, disagreement2 = 0.0;
    for (std::size_t k = 0; k < na; ++k)
        for (std::size_t l = 0; l < nb; ++l) {
            const double p = from_a.values[k * nb + l], q = from_b.values[l * na + k];
            const double value = block.values.empty() ? 0.0 : block.values[k * nb + l];
            error2 += std::pow(value - 0.5 * (p + q), 2.0);
            disagreement2 += std::pow(p - q, 2.0);
        }
    judgement.norm = norm(from_a.values);
    const double scale = 1.0 / std::max(judgement.norm, floor);
    judgement.error = scale * std::sqrt(error2);
    judgement.estimate = scale * block.error;
    // An element that faces itself has but one side: there the reference's own estimate says more.
    judgement.uncertainty = scale * std::max(std::sqrt(disagreement2), pair.itself ? from_a.error : 0.0);
    return judgement;
}

std::string curved_report(std::span<const CurvedJudgement> judgements, double tolerance, std::size_t worst) {
    std::string text = fmt::format("{:<10} {:<10} {:>5} {:>7} {:>7} {:>9} {:>9} {:>8} {:>8}\n", "a", "place",
                                   "pairs", "within", "honest", "err/tol50", "max", "ms/block", "ms/ref");
    const auto row = [&](std::string_view kind, std::string_view place, const auto& wanted) {
        std::vector<double> ratios;
        std::size_t within = 0, honest = 0;
        double seconds = 0.0, reference = 0.0;
        for (const CurvedJudgement& j : judgements) {
            if (!wanted(j)) continue;
            ratios.push_back(j.error / tolerance);
            within += j.proved_error() <= tolerance ? 1u : 0u;
            honest += 3.0 * j.estimate >= j.proved_error() ? 1u : 0u;
            seconds += j.seconds;
            reference += j.reference_seconds;
        }
        if (ratios.empty()) return;
        std::sort(ratios.begin(), ratios.end());
        const double n = static_cast<double>(ratios.size());
        text += fmt::format("{:<10} {:<10} {:>5} {:>7} {:>7} {:>9.2e} {:>9.2e} {:>8.3f} {:>8.1f}\n", kind,
                            place, ratios.size(), within, honest, ratios[ratios.size() / 2], ratios.back(),
                            1e3 * seconds / n, 1e3 * reference / n);
    };
    for (std::size_t kind = 0; kind < 7; ++kind)
        row(element_kind_names[kind], "",
            [&](auto& j) { return static_cast<std::size_t>(j.recipe.a) == kind; });
    for (std::size_t place = 0; place < place_names.size(); ++place)
        row("", place_names[place],
            [&](auto& j) { return static_cast<std::size_t>(j.recipe.place) == place; });
    row("all", "", [](auto&) { return true; });
    std::vector<const CurvedJudgement*> order;
    for (const CurvedJudgement& j : judgements) order.push_back(&j);
    std::sort(order.begin(), order.end(),
              [](auto* p, auto* q) { return p->proved_error() > q->proved_error(); });
    order.resize(std::min(worst, order.size()));
    for (const CurvedJudgement* j : order)
        text += fmt::format("  {} {} {} degrees {} {} seed {:#x}: error {:.1e} estimate {:.1e} norm {:.2e} "
                            "reference +-{:.0e} {:.1f} ms\n",
                            element_kind_names[static_cast<std::size_t>(j->recipe.a)],
                            element_kind_names[static_cast<std::size_t>(j->recipe.b)],
                            place_names[static_cast<std::size_t>(j->recipe.place)], j->degree_a, j->degree_b,
                            j->recipe.seed, j->error, j->estimate, j->norm, j->uncertainty, 1e3 * j->seconds);
    return text;
}

} // namespace kinelux::validation
