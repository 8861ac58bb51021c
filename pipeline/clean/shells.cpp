// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/shells.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "clean/merge_points.h"

namespace kinelux::clean {

namespace {

using Member = Shell::Member;
using Edge = std::array<std::uint32_t, 2>; // from, to

// The parts that may be joined, with their boundary edges between common points.
struct Rims {
    std::vector<Member> members;
    std::vector<Vec3> points;
    std::vector<std::vector<Edge>> edges; // per member
};

bool may_be_joined(const model::Scene& scene, const WorkMesh& work, const Part& part) {
    return !part.closed && std::all_of(part.faces.begin(), part.faces.end(), [&](std::uint32_t f) {
        return scene.materials[work.mesh.materials[f].value].sides == model::Sides::Auto &&
               work.mesh.two_sided[f] == 0;
    });
}

// Directed edges of a part that no face of it runs along the other way.
std::vector<Edge> open_edges(const model::Mesh& mesh, const Part& part,
                             const std::vector<std::uint32_t>& number) {
    std::map<Edge, int> balance;
    for (const std::uint32_t f : part.faces) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = number[mesh.triangles[f][k]], b = number[mesh.triangles[f][(k + 1) % 3]];
            if (a != b) balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    }
    std::vector<Edge> edges;
    for (const auto& [edge, count] : balance) {
        for (int i = 0; i < count; ++i) edges.push_back(edge);
        for (int i = 0; i < -count; ++i) edges.push_back({edge[1], edge[0]});
    }
    return edges;
}

// All bodies of one motion (or none).
Rims find_rims(const model::Scene& scene, const std::vector<std::vector<Part>>& parts,
               const std::vector<WorkMesh>& meshes, std::optional<MotionId> motion, double tolerance) {
    Rims rims;
    std::vector<Vec3> all;
    std::map<std::size_t, std::size_t> first_point; // of an object
    for (std::size_t o = 0; o < meshes.size(); ++o) {
        if (scene.objects[o].motion != motion) continue;
        first_point[o] = all.size();
        all.insert(all.end(), meshes[o].mesh.points.begin(), meshes[o].mesh.points.end());
        for (const Part& part : parts[o]) {
            if (may_be_joined(scene, meshes[o], part)) rims.members.push_back({o, &part});
        }
    }
    if (rims.members.size() < 2) return {};
    const MergedPoints merged = merge_points(all, tolerance);
    rims.points = merged.points;
    for (const Member& member : rims.members) {
        const auto begin = merged.number.begin() + static_cast<std::ptrdiff_t>(first_point.at(member.object));
        const std::vector<std::uint32_t> number(
            begin, begin + static_cast<std::ptrdiff_t>(meshes[member.object].mesh.points.size()));
        rims.edges.push_back(open_edges(meshes[member.object].mesh, *member.part, number));
    }
    return rims;
}

// Divides boundary edges at the boundary points that lie on them, so that edges that cover each other are equal.
void divide_edges(Rims& rims, double tolerance) {
    std::vector<std::uint32_t> by_x;
    for (const std::vector<Edge>& edges : rims.edges) {
        for (const Edge& edge : edges) by_x.insert(by_x.end(), edge.begin(), edge.end());
    }
    std::sort(by_x.begin(), by_x.end(), [&](std::uint32_t p, std::uint32_t q) {
        return std::pair(rims.points[p].x, p) < std::pair(rims.points[q].x, q);
    });
    by_x.erase(std::unique(by_x.begin(), by_x.end()), by_x.end());
    for (std::vector<Edge>& edges : rims.edges) {
        std::vector<Edge> divided;
        for (const Edge& edge : edges) {
            const Vec3 a = rims.points[edge[0]], run = rims.points[edge[1]] - a;
            const double length = glm::length(run);
            std::vector<std::pair<double, std::uint32_t>> stops;
            auto at = std::lower_bound(by_x.begin(), by_x.end(), std::min(a.x, a.x + run.x) - tolerance,
                                       [&](std::uint32_t p, double x) { return rims.points[p].x < x; });
            for (; at != by_x.end() && rims.points[*at].x <= std::max(a.x, a.x + run.x) + tolerance; ++at) {
                if (*at == edge[0] || *at == edge[1]) continue;
                const double along = glm::dot(rims.points[*at] - a, run) / length;
                if (along <= 0.0 || along >= length) continue;
                if (glm::distance(rims.points[*at], a + (along / length) * run) <= tolerance)
                    stops.emplace_back(along, *at);
            }
            std::sort(stops.begin(), stops.end());
            std::uint32_t last = edge[0];
            for (const auto& [along, point] : stops) {
                divided.push_back({last, point});
                last = point;
            }
            divided.push_back({last, edge[1]});
        }
        edges = std::move(divided);
    }
}

// Two members along one edge: whether they agree, or one of them has to be turned.
struct Joint {
    std::size_t other;
    bool agree;
};

struct Joints {
    std::vector<std::vector<Joint>> of;
    std::vector<std::uint8_t> open; // a member with an edge that is not shared by exactly two
};

Joints find_joints(const Rims& rims) {
    struct Use {
        std::size_t member;
        bool ascending;
    };
    std::map<Edge, std::vector<Use>> users;
    for (std::size_t m = 0; m < rims.edges.size(); ++m) {
        for (const Edge& edge : rims.edges[m]) {
            users[{std::min(edge[0], edge[1]), std::max(edge[0], edge[1])}].push_back({m, edge[0] < edge[1]});
        }
    }
    Joints joints{std::vector<std::vector<Joint>>(rims.members.size()),
                  std::vector<std::uint8_t>(rims.members.size(), 0)};
    for (const auto& [edge, uses] : users) {
        if (uses.size() != 2) {
            for (const Use& use : uses) joints.open[use.member] = 1;
            continue;
        }
        const bool agree = uses[0].ascending != uses[1].ascending;
        joints.of[uses[0].member].push_back({uses[1].member, agree});
        joints.of[uses[1].member].push_back({uses[0].member, agree});
    }
    return joints;
}

// Members that hang together with a seed, and which of them are to be turned; nothing if they close no surface.
struct Union {
    std::vector<std::size_t> members;
    std::map<std::size_t, bool> turned;
    bool closed = true;
};

Union gather(const Joints& joints, std::size_t seed) {
    Union result;
    result.members.push_back(seed);
    result.turned[seed] = false;
    for (std::size_t i = 0; i < result.members.size(); ++i) {
        const std::size_t m = result.members[i];
        result.closed = result.closed && joints.open[m] == 0;
        for (const Joint& joint : joints.of[m]) {
            const bool turned = result.turned.at(m) != !joint.agree;
            const auto [at, fresh] = result.turned.try_emplace(joint.other, turned);
            if (fresh) result.members.push_back(joint.other);
            result.closed = result.closed && at->second == turned;
        }
    }
    return result;
}

// Shells of more than one part among the bodies of one motion.
void join(const Rims& rims, std::vector<WorkMesh>& meshes, std::map<const Part*, Shell>& joined) {
    const Joints joints = find_joints(rims);
    std::vector<std::uint8_t> seen(rims.members.size(), 0);
    for (std::size_t seed = 0; seed < rims.members.size(); ++seed) {
        if (seen[seed] != 0) continue;
        Union unified = gather(joints, seed);
        for (const std::size_t m : unified.members) seen[m] = 1;
        if (!unified.closed || unified.members.size() < 2) continue;
        std::sort(unified.members.begin(), unified.members.end());
        Shell shell;
        shell.closed = true;
        for (const std::size_t m : unified.members) {
            shell.members.push_back(rims.members[m]);
            if (unified.turned.at(m)) flip(meshes[rims.members[m].object], *rims.members[m].part);
        }
        for (const Member& member : shell.members) joined[member.part] = shell;
    }
}

} // namespace

void flip(WorkMesh& work, const Part& part) {
    for (const std::uint32_t f : part.faces) {
        std::swap(work.mesh.triangles[f][1], work.mesh.triangles[f][2]);
        work.flipped[f] ^= 1;
    }
}

std::vector<Shell> find_shells(const model::Scene& scene, const std::vector<std::vector<Part>>& parts,
                               std::vector<WorkMesh>& meshes, double tolerance) {
    std::vector<std::optional<MotionId>> motions;
    for (const model::Object& object : scene.objects) {
        if (std::find(motions.begin(), motions.end(), object.motion) == motions.end())
            motions.push_back(object.motion);
    }
    std::map<const Part*, Shell> joined;
    for (const std::optional<MotionId>& motion : motions) {
        Rims rims = find_rims(scene, parts, meshes, motion, tolerance);
        if (rims.members.empty()) continue;
        divide_edges(rims, tolerance);
        join(rims, meshes, joined);
    }
    std::vector<Shell> shells;
    for (std::size_t o = 0; o < parts.size(); ++o) {
        for (const Part& part : parts[o]) {
            const auto at = joined.find(&part);
            if (at == joined.end()) {
                shells.push_back({{{o, &part}}, part.closed});
            } else if (at->second.members.front().part == &part) {
                shells.push_back(at->second);
            }
        }
    }
    return shells;
}

} // namespace kinelux::clean
