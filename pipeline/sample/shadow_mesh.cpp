// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/shadow_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/sequence.h"
#include "geometry/surface.h"
#include "sample/receivers.h"

namespace kinelux::sample {

namespace {

constexpr std::size_t points_at_once = 64; ///< of one task
constexpr double unshadowed_strictness =
    4.0; ///< times: light without shadow has no noise, and eyes see cells in smooth gradients

using Edge = std::pair<std::uint32_t, std::uint32_t>; ///< numbers of its points, the lower first

Edge edge_of(const model::Triangle& corners, std::size_t e) {
    return std::minmax(corners[e], corners[(e + 1) % 3]);
}

struct EdgeHash {
    std::size_t operator()(const Edge& edge) const { return core::mix(edge.first, edge.second); }
};

using Sides = std::array<std::uint32_t, 3>; ///< numbers of the midpoints of a triangle's edges

/// The middle of an edge: a point that the mesh could get.
struct Midpoint {
    Edge edge;
    std::array<std::uint32_t, 2> around{}; ///< triangles at the edge; the same twice on a border
    bool tested = false, cut = false;
    std::uint32_t point = 0;         ///< its number once the edge is cut
    Vec3 position{0.0}, normal{0.0}; ///< [m], unit; at rest
    Vec2 parameter{0.0};
    double irradiance = 0.0; ///< direct, sum of channels [W/m2 or lx]
    std::vector<Seen> seen;  ///< one per source; empty: as at the ends
};

class Refinement {
public:
    Refinement(const model::DisplayMesh& rest, const model::PatchSet& patches,
               std::span<const geometry::ElementShape> rest_elements, const model::Scene& scene,
               double time_s, std::span<const geometry::Pose> poses, const visibility::Occluders& occluders,
               const DirectLightOptions& direct, const ShadowMeshOptions& options)
        : mesh_(rest),
          patches_(patches),
          elements_(rest_elements),
          poses_(poses),
          light_(moved_sources(rest_elements, scene, poses), scene, time_s, occluders, direct),
          channels_(scene.channels.size()),
          clearance_(occluders.end_offset()),
          options_(options) {}

    ShadowMesh run() {
        light_points();
        mean_ = mean_irradiance();
        while (mark_edges()) cut_triangles();
        double unresolved = 0.0;
        for (const model::Triangle& corners : mesh_.triangles)
            if (differs(corners)) unresolved += area(corners);
        return {std::move(mesh_), unresolved};
    }

private:
    void light_points() {
        std::vector<std::vector<std::uint32_t>> around(mesh_.points.size());
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
            for (const std::uint32_t corner : mesh_.triangles[t]) around[corner].push_back(t);
        irradiance_.resize(mesh_.points.size());
        seen_.resize(mesh_.points.size() * light_.source_count());
        for_all(mesh_.points.size(), [&](std::size_t p) {
            std::vector<double> values(channels_);
            light_.irradiance(
                receiver(mesh_.points[p], mesh_.normals[p], ObjectId{mesh_.point_objects[p]}, around[p]), p,
                values, std::span(seen_).subspan(p * light_.source_count(), light_.source_count()));
            irradiance_[p] = std::accumulate(values.begin(), values.end(), 0.0);
        });
    }

    Receiver receiver(const Vec3& x, const Vec3& normal, ObjectId object,
                      std::span<const std::uint32_t> around) const {
        return moved(receiver_on(mesh_, elements_, x, normal, around, clearance_), poses_[object.value]);
    }

    // Where both ends see the same sources whole and nothing of the others, so does the middle: no ray is cast.
    bool is_unshadowed(const Edge& edge) const {
        const auto from = seen_at(edge.first), to = seen_at(edge.second);
        return std::equal(from.begin(), from.end(), to.begin()) &&
               std::find(from.begin(), from.end(), Seen::Partly) == from.end();
    }

    double mean_irradiance() const {
        double flux = 0.0, all = 0.0;
        for (const model::Triangle& c : mesh_.triangles) {
            const double a = area(c);
            flux += a * (irradiance_[c[0]] + irradiance_[c[1]] + irradiance_[c[2]]) / 3.0;
            all += a;
        }
        return all > 0.0 ? flux / all : 0.0;
    }

    bool too_much(double difference, double value) const {
        return difference > options_.tolerance * std::max(value, mean_);
    }

    // Tests the edges that are new and longer than the least; returns whether any edge is to be cut.
    bool mark_edges() {
        number_edges();
        std::vector<Midpoint*> fresh;
        for (Midpoint& middle : midpoints_)
            if (!middle.tested && length(middle.edge) > options_.smallest_edge) fresh.push_back(&middle);
        for_all(fresh.size(), [&](std::size_t i) { test(*fresh[i]); });
        const bool any = std::any_of(fresh.begin(), fresh.end(), [](const Midpoint* m) { return m->cut; });
        if (any) mark_longest_edges();
        return any;
    }

    void number_edges() {
        sides_.assign(mesh_.triangles.size(), {});
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
            for (std::size_t e = 0; e < 3; ++e) {
                const Edge edge = edge_of(mesh_.triangles[t], e);
                const auto [entry, added] =
                    numbers_.try_emplace(edge, static_cast<std::uint32_t>(midpoints_.size()));
                if (added) midpoints_.push_back({.edge = edge, .around = {t, t}});
                Midpoint& middle = midpoints_[entry->second];
                if (!middle.tested) middle.around[1] = t;
                sides_[t][e] = entry->second;
            }
    }

    void test(Midpoint& middle) const {
        const auto [a, b] = middle.edge;
        const std::uint32_t t = middle.around[0];
        const model::Triangle& corners = mesh_.triangles[t];
        const std::uint32_t third = corners[0] + corners[1] + corners[2] - a - b;
        middle.parameter = 0.5 * (mesh_.parameters[a] + mesh_.parameters[b]);
        middle.position = 0.5 * (mesh_.points[a] + mesh_.points[b]);
        middle.normal = glm::normalize(mesh_.normals[a] + mesh_.normals[b]);
        if (mesh_.patches[t] >= 0) {
            const model::Surface& surface =
                patches_.patches[static_cast<std::size_t>(mesh_.patches[t])].surface;
            const auto jet = geometry::evaluate_towards(surface, middle.parameter, mesh_.parameters[third]);
            middle.position = jet.position;
            middle.normal = jet.normal;
        }
        const std::size_t sides = middle.around[0] == middle.around[1] ? 1 : 2;
        const Receiver here =
            receiver(middle.position, middle.normal, mesh_.objects[t], std::span(middle.around).first(sides));
        std::vector<double> values(channels_);
        if (is_unshadowed(middle.edge)) {
            light_.irradiance_unshadowed(here, seen_at(a), values);
        } else {
            middle.seen.resize(light_.source_count());
            light_.irradiance(here, core::mix(core::mix(irradiance_.size(), a), b), values, middle.seen);
        }
        middle.irradiance = std::accumulate(values.begin(), values.end(), 0.0);
        middle.tested = true;
        const double linear = 0.5 * (irradiance_[a] + irradiance_[b]);
        const double strictness = middle.seen.empty() ? unshadowed_strictness : 1.0;
        middle.cut =
            too_much(strictness * std::abs(middle.irradiance - linear), std::max(linear, middle.irradiance));
    }

    // A triangle that is cut is cut at its longest edge first, so its neighbour there is cut as well, and so on.
    void mark_longest_edges() {
        for (bool changed = true; changed;) {
            changed = false;
            for (const Sides& sides : sides_) {
                if (std::none_of(sides.begin(), sides.end(), [&](auto m) { return midpoints_[m].cut; }))
                    continue;
                Midpoint& longest = midpoints_[longest_of(sides)];
                changed = changed || !longest.cut;
                longest.cut = true;
            }
        }
    }

    void cut_triangles() {
        const model::DisplayMesh old = mesh_;
        for (Midpoint& middle : midpoints_)
            if (middle.cut && middle.point == 0) {
                middle.point = static_cast<std::uint32_t>(mesh_.points.size());
                mesh_.points.push_back(middle.position);
                mesh_.normals.push_back(middle.normal);
                mesh_.parameters.push_back(middle.parameter);
                mesh_.point_objects.push_back(mesh_.point_objects[middle.edge.first]);
                irradiance_.push_back(middle.irradiance);
                const std::vector<Seen> seen(seen_at(middle.edge.first).begin(),
                                             seen_at(middle.edge.first).end());
                const std::vector<Seen>& here = middle.seen.empty() ? seen : middle.seen;
                seen_.insert(seen_.end(), here.begin(), here.end());
            }
        mesh_.triangles.clear();
        std::vector<std::size_t> parents;
        for (std::size_t t = 0; t < old.triangles.size(); ++t) {
            bisect(old.triangles[t]);
            parents.resize(mesh_.triangles.size(), t);
        }
        const auto inherit = [&](auto& values, const auto& from) {
            values.clear();
            for (const std::size_t parent : parents) values.push_back(from[parent]);
        };
        inherit(mesh_.elements, old.elements);
        inherit(mesh_.objects, old.objects);
        inherit(mesh_.materials, old.materials);
        inherit(mesh_.patches, old.patches);
        inherit(mesh_.clusters, old.clusters);
        inherit(mesh_.degrees, old.degrees);
    }

    void bisect(const model::Triangle& corners) {
        const Midpoint* longest = nullptr;
        std::size_t side = 0;
        for (std::size_t e = 0; e < 3; ++e) {
            const auto found = numbers_.find(edge_of(corners, e));
            if (found == numbers_.end() || !midpoints_[found->second].cut) continue;
            if (longest != nullptr && !shorter(longest->edge, midpoints_[found->second].edge)) continue;
            longest = &midpoints_[found->second];
            side = e;
        }
        if (longest == nullptr) {
            mesh_.triangles.push_back(corners);
            return;
        }
        const std::uint32_t a = corners[side], b = corners[(side + 1) % 3], c = corners[(side + 2) % 3];
        bisect({a, longest->point, c});
        bisect({longest->point, b, c});
    }

    double length(const Edge& edge) const {
        return glm::distance(mesh_.points[edge.first], mesh_.points[edge.second]);
    }
    // Edges of equal length in the order of their points, so that both triangles of an edge agree.
    bool shorter(const Edge& a, const Edge& b) const {
        return std::pair(length(a), a) < std::pair(length(b), b);
    }
    std::uint32_t longest_of(const Sides& sides) const {
        return *std::max_element(sides.begin(), sides.end(), [&](std::uint32_t a, std::uint32_t b) {
            return shorter(midpoints_[a].edge, midpoints_[b].edge);
        });
    }
    std::span<const Seen> seen_at(std::uint32_t point) const {
        return std::span(seen_).subspan(point * light_.source_count(), light_.source_count());
    }
    // In shadow. Half the difference of its ends is the most by which a field that only rises or falls along an edge can differ
    // from its mean there.
    bool differs(const model::Triangle& corners) const {
        for (std::size_t e = 0; e < 3; ++e) {
            const Edge edge = edge_of(corners, e);
            const double a = irradiance_[edge.first], b = irradiance_[edge.second];
            if (length(edge) <= options_.smallest_edge && !is_unshadowed(edge) &&
                too_much(0.5 * std::abs(a - b), std::max(a, b)))
                return true;
        }
        return false;
    }
    double area(const model::Triangle& c) const {
        return 0.5 * glm::length(glm::cross(mesh_.points[c[1]] - mesh_.points[c[0]],
                                            mesh_.points[c[2]] - mesh_.points[c[0]]));
    }
    template <class Function>
    static void for_all(std::size_t count, const Function& function) {
        core::parallel_for((count + points_at_once - 1) / points_at_once, [&](std::size_t task) {
            for (std::size_t i = task * points_at_once; i < std::min(count, (task + 1) * points_at_once); ++i)
                function(i);
        });
    }

    model::DisplayMesh mesh_;
    const model::PatchSet& patches_;
    std::span<const geometry::ElementShape> elements_;
    std::span<const geometry::Pose> poses_;
    DirectLight light_;
    std::size_t channels_;
    double clearance_;
    ShadowMeshOptions options_;
    std::vector<double> irradiance_; ///< direct, one per point, sum of channels
    std::vector<Seen> seen_;         ///< by point, then source
    std::vector<Midpoint> midpoints_;
    std::unordered_map<Edge, std::uint32_t, EdgeHash> numbers_; ///< into midpoints_
    std::vector<Sides> sides_;                                  ///< one per triangle
    double mean_ = 0.0;
};

} // namespace

ShadowMesh shadow_mesh(const model::DisplayMesh& rest, const model::PatchSet& patches,
                       std::span<const geometry::ElementShape> rest_elements, const model::Scene& scene,
                       double time_s, std::span<const geometry::Pose> poses,
                       const visibility::Occluders& occluders, const DirectLightOptions& direct,
                       const ShadowMeshOptions& options) {
    return Refinement(rest, patches, rest_elements, scene, time_s, poses, occluders, direct, options).run();
}

} // namespace kinelux::sample
