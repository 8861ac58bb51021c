// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/cluster_tree.h"

#include <cmath>
#include <cstddef>
#include <string>

#include "core/error.h"

namespace kinelux::model {

namespace {

[[noreturn]] void fail(const std::string& what) { throw core::GeometryError("clusters: " + what); }

// Every small triangle is in exactly one cluster, which is of its object and material.
void check_clusters(const ClusterTree& tree, const SmallTriangles& small) {
    std::vector<std::uint8_t> seen(small.triangles.size(), 0);
    for (std::size_t c = 0; c < tree.clusters.size(); ++c) {
        const Cluster& cluster = tree.clusters[c];
        const std::string name = "cluster " + std::to_string(c);
        if (cluster.triangles.empty()) fail(name + " is empty");
        for (const std::uint32_t t : cluster.triangles) {
            if (t >= seen.size())
                fail(name + " names triangle " + std::to_string(t) + " of " + std::to_string(seen.size()));
            if (seen[t]++ != 0) fail("triangle " + std::to_string(t) + " is in two clusters");
            if (small.objects[t] != cluster.object || small.materials[t] != cluster.material) {
                fail(name + " holds a triangle of another object or material");
            }
        }
    }
    for (std::size_t t = 0; t < seen.size(); ++t) {
        if (seen[t] == 0) fail("triangle " + std::to_string(t) + " is in no cluster");
    }
}

void check_piece(const std::string& name, const Element& element, const ClusterTree& tree,
                 const PatchSet& patches) {
    if (element.patch->value >= patches.patches.size()) fail(name + " names a patch out of range");
    const Patch& patch = patches.patches[element.patch->value];
    if (patch.object != element.object || patch.material != element.material) {
        fail(name + " is of another object or material than its patch");
    }
    const std::size_t end = std::size_t{element.first_triangle} + element.triangle_count;
    if (element.triangle_count == 0 || end > tree.domain_triangles.size())
        fail(name + " has no domain triangles or names some out of range");
}

void check_whole_cluster(const std::string& name, const Element& element, const ClusterTree& tree) {
    if (element.cluster->value >= tree.clusters.size()) fail(name + " names a cluster out of range");
    const Cluster& cluster = tree.clusters[element.cluster->value];
    if (cluster.object != element.object || cluster.material != element.material) {
        fail(name + " is of another object or material than its cluster");
    }
}

} // namespace

void check(const ClusterTree& tree, const PatchSet& patches) {
    check_clusters(tree, patches.small);
    std::vector<std::uint32_t> pieces(patches.patches.size(), 0), uses(tree.clusters.size(), 0);
    for (std::size_t e = 0; e < tree.elements.size(); ++e) {
        const Element& element = tree.elements[e];
        const std::string name = "element " + std::to_string(e);
        if (element.patch.has_value() == element.cluster.has_value()) {
            fail(name + " must be a piece of one patch or one cluster");
        }
        if (element.patch) {
            check_piece(name, element, tree, patches);
            ++pieces[element.patch->value];
        } else {
            check_whole_cluster(name, element, tree);
            ++uses[element.cluster->value];
        }
        if (e > 0 && element.object < tree.elements[e - 1].object)
            fail(name + " is out of order: elements are sorted by object");
    }
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        if (pieces[p] == 0) fail("patch " + std::to_string(p) + " has no element");
    }
    for (std::size_t c = 0; c < uses.size(); ++c) {
        if (uses[c] != 1)
            fail("cluster " + std::to_string(c) + " is the element of " + std::to_string(uses[c]) +
                 ", not of one");
    }
    for (const DomainTriangle& triangle : tree.domain_triangles) {
        for (const Vec2& p : triangle) {
            if (!std::isfinite(p.x) || !std::isfinite(p.y))
                fail("a parameter of a domain triangle is not finite");
        }
    }
}

} // namespace kinelux::model
