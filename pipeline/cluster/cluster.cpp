// SPDX-License-Identifier: GPL-3.0-or-later
#include "cluster/cluster.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>

#include <glm/common.hpp>

#include "cluster/patch_grid.h"
#include "cluster/triangle_groups.h"
#include "core/error.h"
#include "geometry/surface.h"

namespace kinelux::cluster {

namespace {

struct Bounds {
    Vec3 low{std::numeric_limits<double>::infinity()};
    Vec3 high{-std::numeric_limits<double>::infinity()};

    void add(const Vec3& x) {
        low = glm::min(low, x);
        high = glm::max(high, x);
    }
    double longest_edge() const {
        const Vec3 size = high - low;
        return std::max({size.x, size.y, size.z});
    }
};

// Corners of a domain say little about a surface that closes on itself: points inside its triangles count as well.
void add_domain(Bounds& bounds, const model::Patch& patch) {
    for (const Vec2& uv : patch.points) bounds.add(geometry::position(patch.surface, uv));
    if (patch.surface.type == model::SurfaceType::Plane) return;
    constexpr int steps = 16; // per edge of a triangle
    for (const model::Triangle& t : patch.triangles) {
        const Vec2 &p = patch.points[t[0]], a = patch.points[t[1]] - p, b = patch.points[t[2]] - p;
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; i + j <= steps; ++j)
                bounds.add(geometry::position(patch.surface,
                                              p + (static_cast<double>(i) * a + static_cast<double>(j) * b) /
                                                      static_cast<double>(steps)));
    }
}

// Bounds of all patches and small triangles whose object is wanted.
template <class Wanted>
Bounds bounds_of(const model::PatchSet& patches, const Wanted& wanted) {
    Bounds bounds;
    for (const model::Patch& patch : patches.patches) {
        if (!wanted(patch.object)) continue;
        add_domain(bounds, patch);
    }
    for (std::size_t t = 0; t < patches.small.triangles.size(); ++t) {
        if (!wanted(patches.small.objects[t])) continue;
        for (const std::uint32_t corner : patches.small.triangles[t])
            bounds.add(patches.small.points[corner]);
    }
    return bounds;
}

Bounds scene_bounds(const model::Scene& scene, const model::PatchSet& patches) {
    const auto at_rest = [&](ObjectId object) { return !scene.objects[object.value].motion.has_value(); };
    const Bounds bounds = bounds_of(patches, at_rest);
    return bounds.longest_edge() > 0.0 ? bounds : bounds_of(patches, [](ObjectId) { return true; });
}

// Light varies over lengths of the order of the mean free path between surfaces, 4 V / A; so elements are a share of it,
// and of the extent where surfaces are few. Found on rooms and halls with degree 2, where the error falls about as the square of
// the size. The number of elements is limited because blocks are stored densely.
double element_size_for(const model::Scene& scene, const model::PatchSet& patches) {
    constexpr double reference_target = 0.03, path_share = 0.16, extent_share = 0.1;
    constexpr double flattest = 0.25; // of the extent: what stands in for the height of flat scenes
    constexpr double most_elements = 2500.0;
    const Bounds bounds = scene_bounds(scene, patches);
    const double extent = bounds.longest_edge();
    const Vec3 size = glm::max(bounds.high - bounds.low, Vec3(flattest * extent));
    double area = geometry::area(patches.small);
    for (const model::Patch& patch : patches.patches) area += geometry::area(patch);
    const double free_path = 4.0 * size.x * size.y * size.z / area;
    const double at_reference = std::min(path_share * free_path, extent_share * extent);
    return std::max(at_reference * std::sqrt(scene.accuracy.target / reference_target),
                    std::sqrt(area / most_elements));
}

bool is_emitter(const ClusterOptions& options, MaterialId material) {
    return std::find(options.emitters.begin(), options.emitters.end(), material) != options.emitters.end();
}

void add_pieces(const model::PatchSet& patches, const ClusterOptions& options, model::ClusterTree& tree) {
    for (std::size_t p = 0; p < patches.patches.size(); ++p) {
        const model::Patch& patch = patches.patches[p];
        double edge = options.element_size;
        if (is_emitter(options, patch.material)) {
            const Vec2 extent = extent_on_surface(patch);
            if (std::max(extent.x, extent.y) <= 2.0 * edge) edge *= 2.0;
        }
        for (const Piece& piece : cut_patch(patch, edge)) {
            model::Element element;
            element.patch = PatchId(p);
            element.object = patch.object;
            element.material = patch.material;
            element.first_triangle = static_cast<std::uint32_t>(tree.domain_triangles.size());
            element.triangle_count = static_cast<std::uint32_t>(piece.size());
            tree.domain_triangles.insert(tree.domain_triangles.end(), piece.begin(), piece.end());
            tree.elements.push_back(element);
        }
    }
}

} // namespace

ClusterOptions cluster_options_for(const model::Scene& scene, const model::PatchSet& patches) {
    ClusterOptions options;
    options.element_size = scene.accuracy.element_size.value_or(element_size_for(scene, patches));
    options.cluster_size = options.element_size;
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        if (scene.materials[m].emits()) options.emitters.push_back(MaterialId(m));
    }
    return options;
}

model::ClusterTree build_clusters(const model::PatchSet& patches, const ClusterOptions& options) {
    if (!(options.element_size > 0.0) || !(options.cluster_size > 0.0)) {
        throw core::GeometryError("the sizes of elements and clusters must be above 0");
    }
    model::ClusterTree tree;
    tree.element_size = options.element_size;
    add_pieces(patches, options, tree);
    tree.clusters = group_triangles(patches.small, options);
    for (std::size_t c = 0; c < tree.clusters.size(); ++c) {
        model::Element element;
        element.cluster = ClusterId(c);
        element.object = tree.clusters[c].object;
        element.material = tree.clusters[c].material;
        tree.elements.push_back(element);
    }
    const auto place = [](const model::Element& e) {
        return std::tuple(e.object, e.cluster.has_value(), e.patch ? e.patch->value : e.cluster->value);
    };
    std::stable_sort(tree.elements.begin(), tree.elements.end(),
                     [&](const model::Element& a, const model::Element& b) { return place(a) < place(b); });
    return tree;
}

} // namespace kinelux::cluster
