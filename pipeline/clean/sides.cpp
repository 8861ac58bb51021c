// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean/sides.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "clean/shells.h"

namespace kinelux::clean {

namespace {

// Points of a part that stand for where it lies.
constexpr std::size_t samples_per_part = 5;
// A point counts as inside a closed surface that surrounds it at least this often; a point on the surface sees half.
constexpr double inside_winding = 0.75;
// Of the scene's size: boundary edges this near to each other may close a surface.
constexpr double joint_share = 1e-6;

// A shell with what the decision looks at.
struct Candidate {
    const Shell* shell = nullptr;
    double volume = 0.0; // enclosed, positive if it faces outwards [m3]
    Vec3 low{0.0}, high{0.0};
    std::vector<Vec3> samples;
    bool emits = false;
};

Vec3 corner(const WorkMesh& work, std::uint32_t face, std::size_t k) {
    return work.mesh.points[work.mesh.triangles[face][k]];
}

double area(const WorkMesh& work, std::uint32_t f) {
    return 0.5 * glm::length(glm::cross(corner(work, f, 1) - corner(work, f, 0),
                                        corner(work, f, 2) - corner(work, f, 0)));
}

// Calls visit(work, face) for all faces of a shell.
template <class Visit>
void for_each_face(const std::vector<WorkMesh>& meshes, const Shell& shell, const Visit& visit) {
    for (const Shell::Member& member : shell.members) {
        for (const std::uint32_t f : member.part->faces) visit(meshes[member.object], f);
    }
}

Candidate candidate_of(const model::Scene& scene, const std::vector<WorkMesh>& meshes, const Shell& shell) {
    Candidate result;
    result.shell = &shell;
    result.low = Vec3{std::numeric_limits<double>::infinity()};
    result.high = -result.low;
    const Vec3 base = corner(meshes[shell.members[0].object], shell.members[0].part->faces.front(), 0);
    std::vector<Vec3> centroids;
    for_each_face(meshes, shell, [&](const WorkMesh& work, std::uint32_t f) {
        const Vec3 a = corner(work, f, 0), b = corner(work, f, 1), c = corner(work, f, 2);
        result.low = glm::min(result.low, glm::min(a, glm::min(b, c)));
        result.high = glm::max(result.high, glm::max(a, glm::max(b, c)));
        result.volume += glm::dot(a - base, glm::cross(b - base, c - base)) / 6.0;
        result.emits = result.emits || scene.materials[work.mesh.materials[f].value].emits();
        centroids.push_back((a + b + c) / 3.0);
    });
    const std::size_t count = std::min(samples_per_part, centroids.size());
    for (std::size_t i = 0; i < count; ++i) result.samples.push_back(centroids[i * centroids.size() / count]);
    return result;
}

// How often a closed shell surrounds a point: the sum of the solid angles of its faces over that of the sphere.
// @cite Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983), eq. (8)
double winding(const std::vector<WorkMesh>& meshes, const Shell& shell, const Vec3& x) {
    double half_angles = 0.0;
    for_each_face(meshes, shell, [&](const WorkMesh& work, std::uint32_t f) {
        const Vec3 a = corner(work, f, 0) - x, b = corner(work, f, 1) - x, c = corner(work, f, 2) - x;
        const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
        const double denominator =
            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
        half_angles += std::atan2(glm::dot(a, glm::cross(b, c)), denominator);
    });
    return half_angles / (2.0 * std::numbers::pi);
}

// A shell lies inside if most of it does; of a lamp, any piece is enough to light the inside.
bool lies_inside(const std::vector<WorkMesh>& meshes, const Candidate& outer, const Candidate& other) {
    if (!glm::all(glm::lessThanEqual(outer.low, other.high)) ||
        !glm::all(glm::lessThanEqual(other.low, outer.high))) {
        return false;
    }
    std::size_t inside = 0;
    for (const Vec3& x : other.samples) {
        const bool in_bounds =
            glm::all(glm::lessThanEqual(outer.low, x)) && glm::all(glm::lessThanEqual(x, outer.high));
        if (in_bounds && std::abs(winding(meshes, *outer.shell, x)) > inside_winding) ++inside;
    }
    return other.emits ? inside > 0 : 2 * inside >= other.samples.size() && inside > 0;
}

// Whether a closed shell that faces outwards is the outer skin of a hollow solid: then a cavity, a closed shell that
// faces inwards, holds all that lies inside.
bool is_skin(const std::vector<WorkMesh>& meshes, const std::vector<Candidate>& all,
             const std::vector<std::size_t>& inside) {
    return std::any_of(inside.begin(), inside.end(), [&](std::size_t c) {
        const Candidate& cavity = all[c];
        if (!cavity.shell->closed || cavity.volume >= 0.0) return false;
        return std::all_of(inside.begin(), inside.end(),
                           [&](std::size_t o) { return o == c || lies_inside(meshes, cavity, all[o]); });
    });
}

// Whether a closed shell is a room, whose inside is looked at: a lamp is inside, or all else is, or something is and the
// file has it face inwards. Unlit things inside alone (the eyes of an animal, the works of a machine) make no room.
bool is_room(const std::vector<WorkMesh>& meshes, const std::vector<Candidate>& all, std::size_t shell) {
    if (all.size() == 1) return true;
    std::vector<std::size_t> inside;
    bool lit = false;
    for (std::size_t other = 0; other < all.size(); ++other) {
        if (other == shell || !lies_inside(meshes, all[shell], all[other])) continue;
        inside.push_back(other);
        if (all[shell].volume < 0.0) return true;
        lit = lit || all[other].emits;
    }
    return (lit || inside.size() + 1 == all.size()) && !is_skin(meshes, all, inside);
}

double size_of(const std::vector<WorkMesh>& meshes) {
    Vec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    for (const WorkMesh& work : meshes) {
        for (const Vec3& x : work.mesh.points) {
            low = glm::min(low, x);
            high = glm::max(high, x);
        }
    }
    return glm::length(high - low);
}

// Area of the faces of a part that were turned, less that of the others; only those of the given sides, if any.
double turned_area(const model::Scene& scene, const WorkMesh& work, const Part& part, bool front_only) {
    double balance = 0.0;
    for (const std::uint32_t f : part.faces) {
        const bool front = scene.materials[work.mesh.materials[f].value].sides == model::Sides::Front;
        if (front_only && !front) continue;
        balance += work.flipped[f] != 0 ? area(work, f) : -area(work, f);
    }
    return balance;
}

// Counts per object for the notes.
struct Decisions {
    std::uint64_t outward = 0, inward = 0, only_content = 0, sheets = 0, joined = 0;
};

// Whether a shell is to be turned. Looks at all shells as they are in the file, so that their order does not matter.
bool to_be_turned(const model::Scene& scene, const std::vector<WorkMesh>& meshes,
                  const std::vector<Candidate>& all, std::size_t index, std::vector<Decisions>& decisions) {
    const Shell& shell = *all[index].shell;
    bool any_front = false, any_auto = false;
    for_each_face(meshes, shell, [&](const WorkMesh& work, std::uint32_t f) {
        const model::Sides sides = scene.materials[work.mesh.materials[f].value].sides;
        any_front = any_front || sides == model::Sides::Front;
        any_auto = any_auto || sides == model::Sides::Auto;
    });
    // Faces of Front materials know their direction. The first pass has turned parts to agree with most of the area.
    if (any_front || !any_auto) return false;
    Decisions& decision = decisions[shell.members.front().object];
    if (!shell.closed) {
        ++decision.sheets;
        return false;
    }
    if (shell.members.size() > 1) {
        for (const Shell::Member& member : shell.members) ++decisions[member.object].joined;
    }
    const bool inward = is_room(meshes, all, index);
    ++(inward ? decision.inward : decision.outward);
    if (inward && all.size() == 1) ++decision.only_content;
    return inward == (all[index].volume > 0.0);
}

void set_two_sided(const model::Scene& scene, WorkMesh& work, const Part& part, bool closed) {
    for (const std::uint32_t f : part.faces) {
        switch (scene.materials[work.mesh.materials[f].value].sides) {
        case model::Sides::Front: break; // one that lay back to back with its like stays two-sided
        case model::Sides::Both: work.mesh.two_sided[f] = 1; break;
        case model::Sides::Auto:
            if (!closed) work.mesh.two_sided[f] = 1;
            break;
        }
    }
}

void note_decisions(const Decisions& decisions, CleanReport& report) {
    if (decisions.joined > 0) {
        report.notes.push_back(
            fmt::format("{} open part(s) close a surface together with other parts", decisions.joined));
    }
    if (decisions.only_content > 0) {
        report.notes.push_back(
            "the closed part is all there is in the scene: it is a room and faces inwards");
    } else if (decisions.inward > 0) {
        report.notes.push_back(fmt::format(
            "{} closed part(s) hold other geometry or a lamp: rooms, facing inwards", decisions.inward));
    }
    if (decisions.outward > 0) {
        report.notes.push_back(
            fmt::format("{} closed part(s) with nothing inside face outwards", decisions.outward));
    }
    if (decisions.sheets > 0) {
        report.notes.push_back(fmt::format("{} open part(s): both sides exchange light", decisions.sheets));
    }
}

} // namespace

void decide_sides(const model::Scene& scene, const std::vector<std::vector<Part>>& parts,
                  std::vector<WorkMesh>& meshes, std::vector<CleanReport>& reports) {
    // First every part keeps the direction that most of its area has in the file, by Front faces if it has any.
    for (std::size_t o = 0; o < meshes.size(); ++o) {
        for (const Part& part : parts[o]) {
            double balance = turned_area(scene, meshes[o], part, true);
            if (balance == 0.0) balance = turned_area(scene, meshes[o], part, false);
            if (balance > 0.0) flip(meshes[o], part);
        }
    }
    const std::vector<Shell> shells = find_shells(scene, parts, meshes, joint_share * size_of(meshes));
    std::vector<Candidate> all;
    all.reserve(shells.size());
    for (const Shell& shell : shells) all.push_back(candidate_of(scene, meshes, shell));
    std::vector<Decisions> decisions(meshes.size());
    std::vector<std::size_t> to_turn;
    for (std::size_t c = 0; c < all.size(); ++c) {
        if (to_be_turned(scene, meshes, all, c, decisions)) to_turn.push_back(c);
    }
    for (const std::size_t c : to_turn) {
        for (const Shell::Member& member : shells[c].members) flip(meshes[member.object], *member.part);
    }
    for (const Candidate& candidate : all) {
        const Shell& shell = *candidate.shell;
        for (const Shell::Member& member : shell.members) {
            set_two_sided(scene, meshes[member.object], *member.part, shell.closed);
        }
        if (shell.closed) reports[shell.members.front().object].volume_out += std::abs(candidate.volume);
    }
    for (std::size_t o = 0; o < meshes.size(); ++o) note_decisions(decisions[o], reports[o]);
}

} // namespace kinelux::clean
