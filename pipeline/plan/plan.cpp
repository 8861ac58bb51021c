// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "geometry/settle.h"
#include "geometry/surface.h"

namespace kinelux::plan {

namespace {

using model::Effect;
using model::Plan;
using model::Scene;

constexpr double coarse_target = 0.05; ///< above it degree 1 is enough on elements of the size chosen for it

// Area of each material, patches and small triangles together.
std::vector<double> material_areas(const Scene& scene, const model::PatchSet& set) {
    std::vector<double> areas(scene.materials.size());
    for (const model::Patch& patch : set.patches) areas[patch.material.value] += geometry::area(patch);
    for (std::size_t t = 0; t < set.small.triangles.size(); ++t) {
        const auto& [a, b, c] = set.small.triangles[t];
        const Vec3 cross =
            glm::cross(set.small.points[b] - set.small.points[a], set.small.points[c] - set.small.points[a]);
        areas[set.small.materials[t].value] += 0.5 * glm::length(cross);
    }
    return areas;
}

Effect overridden(Effect effect, const std::optional<bool>& choice) {
    if (choice && *choice != effect.simulated) {
        effect.simulated = *choice;
        effect.overridden = true;
        effect.reason = "the scene's [effects] says so; otherwise: " + effect.reason;
    }
    return effect;
}

// Light left after n bounces is at most rho^n of what was emitted; bounces below the target are not worth following.
Effect interreflection(const Scene& scene, const std::vector<double>& areas, Plan& plan) {
    double total = 0.0, reflected = 0.0, largest = 0.0;
    for (std::size_t m = 0; m < areas.size(); ++m) {
        const auto& rho = scene.materials[m].reflectance;
        const double strongest = areas[m] > 0.0 ? *std::max_element(rho.begin(), rho.end()) : 0.0;
        total += areas[m];
        reflected += areas[m] * strongest;
        largest = std::max(largest, strongest);
    }
    const double mean = total > 0.0 ? reflected / total : 0.0;
    const double small = 0.1 * scene.accuracy.target;
    if (largest > 0.0)
        plan.bounces =
            static_cast<std::uint32_t>(std::ceil(std::log(small) / std::log(std::max(mean, 1e-6))));
    Effect effect{"interreflection", largest > 0.0, "", 0.0, false};
    effect.reason =
        largest > 0.0
            ? fmt::format("mean reflectance {:.2f}: about {} bounces until {:.2g} % of the light is left",
                          mean, plan.bounces, 100.0 * small)
            : "no surface reflects";
    effect = overridden(effect, scene.effects.interreflection);
    if (!effect.simulated) {
        plan.bounces = 0;
        effect.risked_error = mean;
    }
    return effect;
}

// Whether two vectors over channels are proportional.
bool proportional(const std::vector<double>& a, const std::vector<double>& b) {
    for (std::size_t c = 1; c < a.size(); ++c)
        if (std::abs(a[0] * b[c] - a[c] * b[0]) > 1e-12 * (std::abs(a[0] * b[c]) + std::abs(a[c] * b[0])))
            return false;
    return true;
}

Effect colour(const Scene& scene, const std::vector<double>& areas, Plan& plan) {
    bool grey = true;
    const std::vector<double>* light = nullptr;
    for (std::size_t m = 0; m < areas.size(); ++m) {
        const model::Material& material = scene.materials[m];
        if (!(areas[m] > 0.0)) continue;
        grey = grey && std::all_of(material.reflectance.begin(), material.reflectance.end(),
                                   [&](double rho) { return rho == material.reflectance.front(); });
        if (material.emits()) {
            grey = grey && (light == nullptr || proportional(*light, material.exitance));
            light = &material.exitance;
        }
    }
    plan.single_channel = grey && light != nullptr && light->front() > 0.0;
    const auto count = scene.channels.size();
    if (count == 1) return {"colour", false, "one channel", 0.0, false};
    return {"colour", !plan.single_channel,
            plan.single_channel
                ? "all reflectances are grey and all sources of one colour: one channel, then scaled"
                : fmt::format("reflectances or sources differ between the {} channels", count),
            0.0, false};
}

// In a scene whose every point lies in front of every patch nothing can come between two points.
bool convex(const model::PatchSet& set) {
    if (!set.small.triangles.empty()) return false;
    std::vector<Vec3> points;
    Vec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const model::Patch& patch : set.patches) {
        if (patch.surface.type != model::SurfaceType::Plane) return false;
        for (const Vec2& uv : patch.points) {
            points.push_back(patch.surface.origin + uv.x * patch.surface.axis_u +
                             uv.y * patch.surface.axis_v);
            low = glm::min(low, points.back());
            high = glm::max(high, points.back());
        }
    }
    const double margin = 1e-9 * glm::length(high - low);
    return std::all_of(set.patches.begin(), set.patches.end(), [&](const model::Patch& patch) {
        const Vec3 normal = patch.surface.orientation * patch.surface.axis_w;
        return std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
            return glm::dot(normal, p - patch.surface.origin) >= -margin;
        });
    });
}

Effect static_occlusion(const Scene& scene, const model::PatchSet& set, Plan& plan) {
    const bool needed = !convex(set);
    Effect effect{"static occlusion", needed,
                  needed ? "surfaces stand in front of others: rays decide"
                         : "every surface faces every point: no rays",
                  0.0, false};
    effect = overridden(effect, scene.effects.static_occlusion);
    if (!effect.simulated && needed) effect.risked_error = 1.0;
    plan.static_occlusion = effect.simulated;
    return effect;
}

std::pair<double, double> factors_over_frames(const Scene& scene, const model::Dimming& dimming) {
    double least = dimming.factor_at(scene.time.start_s), greatest = least;
    for (std::uint32_t frame = 1; frame < scene.time.frames; ++frame) {
        const double factor = dimming.factor_at(scene.time.time_of_frame(frame));
        least = std::min(least, factor);
        greatest = std::max(greatest, factor);
    }
    return {least, greatest};
}

Effect motion(const Scene& scene, Plan& plan) {
    std::string names;
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        const model::Object& object = scene.objects[o];
        if (object.motion && geometry::changes_pose(scene, *object.motion)) {
            plan.moving_objects.push_back(ObjectId(o));
            names += (names.empty() ? "" : ", ") + object.name;
        }
    }
    const bool moves = !plan.moving_objects.empty();
    return {"motion", moves,
            moves ? fmt::format("{} of {} bodies move over {} frames: {}", plan.moving_objects.size(),
                                scene.objects.size(), scene.time.frames, names)
                  : "no body moves: no block changes with time",
            0.0, false};
}

Effect dimming(const Scene& scene, bool moves) {
    std::string names;
    for (std::size_t d = 0; d < scene.dimmings.size(); ++d) {
        const model::Dimming& dimming = scene.dimmings[d];
        const auto [least, greatest] = factors_over_frames(scene, dimming);
        if (least != greatest)
            names += fmt::format("{}{} ({:.3g} to {:.3g})", names.empty() ? "" : ", ", dimming.name, least,
                                 greatest);
    }
    if (!names.empty())
        return {"dimming", true,
                fmt::format("exitance changes over {} frames, which no block depends on: {}",
                            scene.time.frames, names),
                0.0, false};
    return {"dimming", false,
            moves ? "every lamp is steady"
                  : "every lamp is steady and no body moves: one solve serves all frames",
            0.0, false};
}

Effect moving_occlusion(const Scene& scene, Plan& plan) {
    const bool moves = !plan.moving_objects.empty();
    Effect effect{"moving occlusion", moves,
                  moves ? "bodies that move may come between others: pairs they cross are watched"
                        : "nothing moves",
                  0.0, false};
    if (moves) effect = overridden(effect, scene.effects.moving_occlusion);
    if (moves && !effect.simulated) effect.risked_error = 1.0;
    plan.moving_occlusion = effect.simulated;
    return effect;
}

void predict(const model::ClusterTree& tree, Plan& plan) {
    const auto size = [](int degree) { return static_cast<std::uint64_t>((degree + 1) * (degree + 2) / 2); };
    const std::uint64_t clusters = tree.clusters.size(), pieces = tree.elements.size() - clusters;
    plan.unknowns = pieces * size(plan.degree) + clusters * size(plan.cluster_degree);
    // In a room about half of all pairs face each other; a convex one comes close to all.
    plan.predicted_blocks = tree.elements.size() * (tree.elements.size() + 1) / 2;
    const double mean_block =
        std::pow(static_cast<double>(plan.unknowns) / static_cast<double>(tree.elements.size()), 2.0);
    plan.predicted_memory_mib =
        static_cast<double>(plan.predicted_blocks) * (4.0 * mean_block + 24.0) / (1024.0 * 1024.0);
}

} // namespace

model::Plan plan_effects(const model::Scene& scene, const model::PatchSet& patches,
                         const model::ClusterTree& tree) {
    Plan plan;
    plan.degree = scene.accuracy.degree.value_or(scene.accuracy.target > coarse_target ? 1 : 2);
    plan.cluster_degree = 0;
    const std::vector<double> areas = material_areas(scene, patches);
    plan.effects.push_back(interreflection(scene, areas, plan));
    plan.effects.push_back(colour(scene, areas, plan));
    plan.effects.push_back(static_occlusion(scene, patches, plan));
    plan.effects.push_back(motion(scene, plan));
    plan.effects.push_back(moving_occlusion(scene, plan));
    plan.effects.push_back(dimming(scene, !plan.moving_objects.empty()));
    const bool clusters = !tree.clusters.empty();
    plan.effects.push_back({"clusters", clusters,
                            clusters ? fmt::format("{} small triangles in {} clusters",
                                                   patches.small.triangles.size(), tree.clusters.size())
                                     : "no small triangles",
                            0.0, false});
    predict(tree, plan);
    return plan;
}

} // namespace kinelux::plan
