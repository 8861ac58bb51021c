// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>

#include "geometry/domain_cut.h"
#include "geometry/surface.h"
#include "sample/sampler.h"

namespace kinelux::sample {

namespace {

constexpr double crease_cosine = 0.766;                 ///< 40 degrees: a sharper edge is shown as an edge
constexpr double turn_step_rad = std::numbers::pi / 12; ///< round surfaces are shown with 24 corners at least
constexpr double cell_diagonal = std::numbers::sqrt2; ///< of a square cell: the longest edge of its triangles

using UvKey = std::pair<double, double>;
using PointKey = std::tuple<double, double, double>;

/// Appends triangles and what goes with them.
class Builder {
public:
    explicit Builder(model::DisplayMesh& mesh) : mesh_(mesh) {}

    std::uint32_t add_point(const Vec3& position, const Vec3& normal, const Vec2& uv, ObjectId object) {
        mesh_.points.push_back(position);
        mesh_.normals.push_back(normal);
        mesh_.parameters.push_back(uv);
        mesh_.point_objects.push_back(object.value);
        return static_cast<std::uint32_t>(mesh_.points.size() - 1);
    }
    void add_triangle(const model::Triangle& corners, const geometry::ElementShape& shape,
                      const model::Element& element) {
        mesh_.triangles.push_back(corners);
        mesh_.elements.push_back(shape.id);
        mesh_.objects.push_back(element.object);
        mesh_.materials.push_back(element.material);
        mesh_.patches.push_back(element.patch ? static_cast<std::int32_t>(element.patch->value) : -1);
        mesh_.clusters.push_back(element.cluster ? static_cast<std::int32_t>(element.cluster->value) : -1);
        mesh_.degrees.push_back(static_cast<std::uint8_t>(shape.basis.degree()));
    }

private:
    model::DisplayMesh& mesh_;
};

/// Display steps along u and v of a patch [unit of u and v].
Vec2 display_steps(const model::Patch& patch, double cell_size) {
    const model::Surface& surface = patch.surface;
    const double side = cell_size / cell_diagonal;
    if (surface.type == model::SurfaceType::Plane) return Vec2(side);
    // Metres per unit of u and v, from the edges of the domain's triangles.
    Vec2 low(std::numeric_limits<double>::infinity()), high(-low), speed(0.0);
    for (const Vec2& uv : patch.points) {
        low = glm::min(low, uv);
        high = glm::max(high, uv);
    }
    const Vec2 step = 1e-4 * (high - low);
    for (const Vec2& uv : patch.points)
        for (int axis = 0; axis < 2; ++axis) {
            Vec2 next = uv;
            next[axis] += uv[axis] + step[axis] > high[axis] ? -step[axis] : step[axis];
            const double way =
                glm::distance(geometry::position(surface, next), geometry::position(surface, uv));
            speed[axis] = std::max(speed[axis], way / step[axis]);
        }
    Vec2 result = glm::min(side / glm::max(speed, Vec2(1e-12)), high - low);
    if (surface.type != model::SurfaceType::BSpline) result.x = std::min(result.x, turn_step_rad);
    if (surface.type == model::SurfaceType::Sphere || surface.type == model::SurfaceType::Torus)
        result.y = std::min(result.y, turn_step_rad);
    return result;
}

/// Lines that cut a patch: those where one of its elements ends and another begins, and finer ones between.
std::vector<double> display_lines(const std::vector<std::pair<double, double>>& element_ranges, double step) {
    std::set<double> lows, highs;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& [from, to] : element_ranges) {
        lows.insert(from);
        highs.insert(to);
        low = std::min(low, from);
        high = std::max(high, to);
    }
    std::vector<double> coarse{low};
    const double gap = 1e-6 * (high - low);
    for (const double line : lows)
        if (highs.contains(line) && line > coarse.back() + gap && line < high - gap) coarse.push_back(line);
    coarse.push_back(high);
    std::vector<double> lines{low};
    for (std::size_t i = 0; i + 1 < coarse.size(); ++i) {
        const std::vector<double> fine = geometry::grid_lines(coarse[i], coarse[i + 1], step);
        lines.insert(lines.end(), fine.begin() + 1, fine.end());
    }
    return lines;
}

std::vector<std::pair<double, double>> ranges(std::span<const geometry::ElementShape> elements,
                                              const model::ClusterTree& tree, int axis) {
    std::vector<std::pair<double, double>> result;
    for (const geometry::ElementShape& shape : elements) {
        const model::Element& element = tree.elements[shape.id.value];
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::uint32_t t = 0; t < element.triangle_count; ++t)
            for (const Vec2& uv : tree.domain_triangles[element.first_triangle + t]) {
                low = std::min(low, uv[axis]);
                high = std::max(high, uv[axis]);
            }
        result.emplace_back(low, high);
    }
    return result;
}

void add_patch(Builder& builder, std::span<const geometry::ElementShape> elements, const model::Patch& patch,
               const model::ClusterTree& tree, double cell_size) {
    const Vec2 steps = display_steps(patch, cell_size);
    const std::vector<double> u_lines = display_lines(ranges(elements, tree, 0), steps.x);
    const std::vector<double> v_lines = display_lines(ranges(elements, tree, 1), steps.y);
    std::map<UvKey, std::uint32_t> numbers; // equal corners are one point
    for (const geometry::ElementShape& shape : elements) {
        const model::Element& element = tree.elements[shape.id.value];
        const std::span domain(tree.domain_triangles.data() + element.first_triangle, element.triangle_count);
        for (const geometry::DomainCell& cell : geometry::cut_domain(domain, u_lines, v_lines))
            for (const model::DomainTriangle& piece : cell.triangles) {
                const Vec2 inside = (piece[0] + piece[1] + piece[2]) / 3.0;
                model::Triangle corners{};
                for (std::size_t c = 0; c < 3; ++c) {
                    const auto [entry, added] = numbers.try_emplace({piece[c].x, piece[c].y}, 0u);
                    if (added) {
                        const geometry::SurfaceJet jet =
                            geometry::evaluate_towards(patch.surface, piece[c], inside);
                        entry->second = builder.add_point(jet.position, jet.normal, piece[c], patch.object);
                    }
                    corners[c] = entry->second;
                }
                if (patch.surface.orientation < 0.0) std::swap(corners[1], corners[2]);
                builder.add_triangle(corners, shape, element);
            }
    }
}

using Corners = std::array<Vec3, 3>;

// Cuts every edge longer than the limit in the middle until there is none: what happens to an edge depends on the edge
// alone, so neighbours stay conforming.
void subdivide(const Corners& corners, double longest, std::vector<Corners>& result) {
    std::array<bool, 3> cut{};
    Corners middle{};
    int count = 0;
    for (std::size_t e = 0; e < 3; ++e) {
        const Vec3 &a = corners[e], &b = corners[(e + 1) % 3];
        cut[e] = glm::distance(a, b) > longest;
        middle[e] = 0.5 * (a + b);
        count += cut[e] ? 1 : 0;
    }
    if (count == 0) {
        result.push_back(corners);
        return;
    }
    if (count == 3) {
        subdivide({corners[0], middle[0], middle[2]}, longest, result);
        subdivide({middle[0], corners[1], middle[1]}, longest, result);
        subdivide({middle[2], middle[1], corners[2]}, longest, result);
        subdivide(middle, longest, result);
        return;
    }
    // One or two edges: turn so that edge 0 is cut and, of two, edge 1 is the other.
    std::size_t e = 0;
    while (!cut[e] || (count == 2 && !cut[(e + 1) % 3])) ++e;
    const Vec3 &a = corners[e], &b = corners[(e + 1) % 3], &c = corners[(e + 2) % 3];
    const Vec3 &ab = middle[e], &bc = middle[(e + 1) % 3];
    if (count == 1) {
        subdivide({a, ab, c}, longest, result);
        subdivide({ab, b, c}, longest, result);
    } else {
        subdivide({ab, b, bc}, longest, result);
        subdivide({a, ab, bc}, longest, result);
        subdivide({a, bc, c}, longest, result);
    }
}

/// The pieces of an object's clusters, with area-weighted normals at their corners.
class ClusterPieces {
public:
    void add(std::size_t shape, const geometry::Facet& facet, double cell_size) {
        std::vector<Corners> pieces;
        subdivide(facet.corners, cell_size, pieces);
        for (const Corners& corners : pieces) {
            const double area =
                0.5 * glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
            for (const Vec3& x : corners) normals_at_[key(x)].push_back(area * facet.normal);
            pieces_.push_back({shape, corners, facet.normal});
        }
    }

    void build(Builder& builder, std::span<const geometry::ElementShape> elements,
               const model::ClusterTree& tree) const {
        std::map<std::pair<std::size_t, PointKey>, std::vector<Numbered>> numbered; // by cluster and place
        for (const Piece& piece : pieces_) {
            const geometry::ElementShape& shape = elements[piece.shape];
            model::Triangle corners{};
            for (std::size_t c = 0; c < 3; ++c) {
                std::vector<Numbered>& here = numbered[{piece.shape, key(piece.corners[c])}];
                auto same = std::find_if(here.begin(), here.end(), [&](const Numbered& n) {
                    return glm::dot(n.facet_normal, piece.normal) >= crease_cosine;
                });
                if (same == here.end())
                    same = here.insert(
                        here.end(),
                        {piece.normal,
                         builder.add_point(piece.corners[c], smooth_normal(piece.corners[c], piece.normal),
                                           Vec2(0.0), shape.object)});
                corners[c] = same->point;
            }
            builder.add_triangle(corners, shape, tree.elements[shape.id.value]);
        }
    }

private:
    struct Piece {
        std::size_t shape;
        Corners corners;
        Vec3 normal;
    };
    struct Numbered {
        Vec3 facet_normal;
        std::uint32_t point;
    };

    static PointKey key(const Vec3& x) { return {x.x, x.y, x.z}; }

    Vec3 smooth_normal(const Vec3& x, const Vec3& normal) const {
        Vec3 sum(0.0);
        for (const Vec3& other : normals_at_.at(key(x)))
            if (glm::dot(other, normal) >= crease_cosine * glm::length(other)) sum += other;
        return glm::length(sum) > 0.0 ? glm::normalize(sum) : normal;
    }

    std::vector<Piece> pieces_;
    std::map<PointKey, std::vector<Vec3>> normals_at_; ///< times the area
};

} // namespace

model::DisplayMesh display_mesh(std::span<const geometry::ElementShape> elements,
                                const model::PatchSet& patches, const model::ClusterTree& tree,
                                double cell_size) {
    model::DisplayMesh mesh;
    Builder builder(mesh);
    // Elements are sorted by object, then patch, then cluster.
    for (std::size_t e = 0; e < elements.size();) {
        const model::Element& element = tree.elements[elements[e].id.value];
        std::size_t end = e;
        if (element.patch) {
            while (end < elements.size() && tree.elements[elements[end].id.value].patch == element.patch)
                ++end;
            add_patch(builder, elements.subspan(e, end - e), patches.patches[element.patch->value], tree,
                      cell_size);
        } else {
            ClusterPieces pieces;
            for (;
                 end < elements.size() && elements[end].object == element.object && !elements[end].from_patch;
                 ++end)
                for (const geometry::Facet& facet : elements[end].facets) pieces.add(end, facet, cell_size);
            pieces.build(builder, elements, tree);
        }
        e = end;
    }
    return mesh;
}

} // namespace kinelux::sample
