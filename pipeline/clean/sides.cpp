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

namespace kinelux::clean {

namespace {

// Points of a part that stand for where it lies.
constexpr std::size_t samples_per_part = 5;
// A point counts as inside a closed surface that surrounds it at least this often; a point on the surface sees half.
constexpr double inside_winding = 0.75;

// A part with what the decision looks at.
struct Candidate {
    std::size_t object = 0;
    const Part* part = nullptr;
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

Candidate candidate_of(const model::Scene& scene, std::size_t object, const WorkMesh& work,
                       const Part& part) {
    Candidate result;
    result.object = object;
    result.part = &part;
    result.low = Vec3{std::numeric_limits<double>::infinity()};
    result.high = -result.low;
    const Vec3 base = corner(work, part.faces.front(), 0);
    for (const std::uint32_t f : part.faces) {
        const Vec3 a = corner(work, f, 0), b = corner(work, f, 1), c = corner(work, f, 2);
        result.low = glm::min(result.low, glm::min(a, glm::min(b, c)));
        result.high = glm::max(result.high, glm::max(a, glm::max(b, c)));
        result.volume += glm::dot(a - base, glm::cross(b - base, c - base)) / 6.0;
        result.emits = result.emits || scene.materials[work.mesh.materials[f].value].emits();
    }
    const std::size_t count = std::min(samples_per_part, part.faces.size());
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t f = part.faces[i * part.faces.size() / count];
        result.samples.push_back((corner(work, f, 0) + corner(work, f, 1) + corner(work, f, 2)) / 3.0);
    }
    return result;
}

// How often a closed part surrounds a point: the sum of the solid angles of its faces over that of the sphere.
// @cite Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983), eq. (8)
double winding(const WorkMesh& work, const Part& part, const Vec3& x) {
    double half_angles = 0.0;
    for (const std::uint32_t f : part.faces) {
        const Vec3 a = corner(work, f, 0) - x, b = corner(work, f, 1) - x, c = corner(work, f, 2) - x;
        const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
        const double denominator =
            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
        half_angles += std::atan2(glm::dot(a, glm::cross(b, c)), denominator);
    }
    return half_angles / (2.0 * std::numbers::pi);
}

// A part lies inside if most of it does; of a lamp, any piece is enough to light the inside.
bool lies_inside(const WorkMesh& work, const Candidate& shell, const Candidate& other) {
    if (!glm::all(glm::lessThanEqual(shell.low, other.high)) ||
        !glm::all(glm::lessThanEqual(other.low, shell.high))) {
        return false;
    }
    std::size_t inside = 0;
    for (const Vec3& x : other.samples) {
        const bool in_bounds =
            glm::all(glm::lessThanEqual(shell.low, x)) && glm::all(glm::lessThanEqual(x, shell.high));
        if (in_bounds && std::abs(winding(work, *shell.part, x)) > inside_winding) ++inside;
    }
    return other.emits ? inside > 0 : 2 * inside >= other.samples.size() && inside > 0;
}

// Whether a closed part that faces outwards is the outer skin of a hollow solid: then a cavity, a closed part that
// faces inwards, holds all that lies inside.
bool is_skin(const std::vector<WorkMesh>& meshes, const std::vector<Candidate>& all,
             const std::vector<std::size_t>& inside) {
    return std::any_of(inside.begin(), inside.end(), [&](std::size_t c) {
        const Candidate& cavity = all[c];
        if (!cavity.part->closed || cavity.volume >= 0.0) return false;
        return std::all_of(inside.begin(), inside.end(), [&](std::size_t o) {
            return o == c || lies_inside(meshes[cavity.object], cavity, all[o]);
        });
    });
}

// Whether light is inside a closed part: then it is a room and faces inwards.
bool is_room(const std::vector<WorkMesh>& meshes, const std::vector<Candidate>& all, std::size_t shell) {
    if (all.size() == 1) return true;
    std::vector<std::size_t> inside;
    for (std::size_t other = 0; other < all.size(); ++other) {
        if (other == shell || !lies_inside(meshes[all[shell].object], all[shell], all[other])) continue;
        inside.push_back(other);
        if (all[shell].volume < 0.0) return true;
    }
    return !inside.empty() && !is_skin(meshes, all, inside);
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

void flip(WorkMesh& work, const Part& part) {
    for (const std::uint32_t f : part.faces) {
        std::swap(work.mesh.triangles[f][1], work.mesh.triangles[f][2]);
        work.flipped[f] ^= 1;
    }
}

// Counts per object for the notes.
struct Decisions {
    std::uint64_t outward = 0, inward = 0, only_content = 0, sheets = 0;
};

// Whether a part is to be turned. Looks at all parts as they are in the file, so that their order does not matter.
bool to_be_turned(const model::Scene& scene, const std::vector<WorkMesh>& meshes,
                  const std::vector<Candidate>& all, std::size_t index, Decisions& decisions) {
    const Candidate& candidate = all[index];
    const WorkMesh& work = meshes[candidate.object];
    const Part& part = *candidate.part;
    const auto any_of_sides = [&](model::Sides sides) {
        return std::any_of(part.faces.begin(), part.faces.end(), [&](std::uint32_t f) {
            return scene.materials[work.mesh.materials[f].value].sides == sides;
        });
    };
    // Faces of Front materials know their direction. The first pass has turned parts to agree with most of the area.
    if (any_of_sides(model::Sides::Front) || !any_of_sides(model::Sides::Auto)) return false;
    if (!part.closed) {
        ++decisions.sheets;
        return false;
    }
    const bool inward = is_room(meshes, all, index);
    ++(inward ? decisions.inward : decisions.outward);
    if (inward && all.size() == 1) ++decisions.only_content;
    return inward == (candidate.volume > 0.0);
}

void set_two_sided(const model::Scene& scene, WorkMesh& work, const Part& part) {
    for (const std::uint32_t f : part.faces) {
        switch (scene.materials[work.mesh.materials[f].value].sides) {
        case model::Sides::Front: break; // one that lay back to back with its like stays two-sided
        case model::Sides::Both: work.mesh.two_sided[f] = 1; break;
        case model::Sides::Auto:
            if (!part.closed) work.mesh.two_sided[f] = 1;
            break;
        }
    }
}

void note_decisions(const Decisions& decisions, CleanReport& report) {
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
    std::vector<Candidate> all;
    for (std::size_t o = 0; o < meshes.size(); ++o) {
        for (const Part& part : parts[o]) all.push_back(candidate_of(scene, o, meshes[o], part));
    }
    std::vector<Decisions> decisions(meshes.size());
    std::vector<std::size_t> to_turn;
    for (std::size_t c = 0; c < all.size(); ++c) {
        if (to_be_turned(scene, meshes, all, c, decisions[all[c].object])) to_turn.push_back(c);
    }
    for (const std::size_t c : to_turn) flip(meshes[all[c].object], *all[c].part);
    for (std::size_t o = 0; o < meshes.size(); ++o) {
        for (const Part& part : parts[o]) set_two_sided(scene, meshes[o], part);
        note_decisions(decisions[o], reports[o]);
    }
    for (const Candidate& candidate : all) {
        if (candidate.part->closed) reports[candidate.object].volume_out += std::abs(candidate.volume);
    }
}

} // namespace kinelux::clean
