// SPDX-License-Identifier: GPL-3.0-or-later
// What the publication's engine takes and loses against the exact one: processor time per frame, blocks computed anew,
// and the error of the light. paper_bench [elements per edge] [frames] [degree]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "motion/exact_engine.h"
#include "motion/lamp_room.h"
#include "motion/paper_engine.h"
#include "motion/rotation_series.h"
#include "motion/translation_series.h"
#include "solve/solve.h"

namespace kinelux {
namespace {

using motion::ExpansionRule;
using motion::FrameBlocks;
using motion::LampRoom;
using motion::PaperOcclusion;
using motion::PaperOptions;
using motion::PreparedRoom;

double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double norm(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

// The reflected light on what does not emit.
class Light {
public:
    explicit Light(const PreparedRoom& p) : blocks_(p.coefficients.layout, p.coefficients.static_blocks) {
        std::vector<double> M;
        for (const auto& shape : p.shapes) {
            const model::Material& material = p.room.scene.materials[shape.material.value];
            areas_.push_back(shape.area);
            M.push_back(material.exitance[0]);
            reflectance_.push_back(material.reflectance[0]);
        }
        exitance_ = solve::constant_coefficients(p.coefficients.layout, 1, areas_, M);
        for (std::size_t e = 0; e < M.size(); ++e)
            emits_.insert(emits_.end(), p.coefficients.layout.count(e), M[e] > 0.0);
    }
    std::vector<double> of(const FrameBlocks& frame) {
        blocks_.replace(frame.pairs, frame.blocks);
        auto B = solve::solve_system({blocks_, 1, exitance_, reflectance_, areas_}, {.tolerance = 1e-8}, {})
                     .radiosity;
        for (std::size_t u = 0; u < B.size(); ++u)
            if (emits_[u]) B[u] = 0.0;
        return B;
    }

private:
    solve::BlockOperator blocks_;
    std::vector<double> areas_, reflectance_, exitance_;
    std::vector<bool> emits_;
};

struct Run {
    double ms_per_frame = 0.0, refreshed = 0.0, expanded = 0.0,
           sets = 0.0;                          // means over all frames but the first
    double mean_error = 0.0, worst_error = 0.0; // of the light, relative
    std::vector<std::vector<double>> light;
};

Run run(PreparedRoom& p, const std::optional<PaperOptions>& options, std::uint32_t frames,
        const Run* expected) {
    motion::ExactEngine exact(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options);
    std::optional<motion::PaperEngine> paper;
    if (options) paper.emplace(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options, *options);
    Light light(p);
    Run result;
    for (std::uint32_t frame = 0; frame < frames; ++frame) {
        const double started = processor_ms();
        const FrameBlocks blocks =
            paper ? paper->advance(0.0, p.poses(frame)) : exact.advance(0.0, p.poses(frame));
        const double share = frame == 0 ? 0.0 : 1.0 / (frames - 1);
        result.ms_per_frame += share * (processor_ms() - started);
        result.refreshed += share * static_cast<double>(blocks.computed);
        result.expanded += paper ? share * static_cast<double>(paper->counts().expanded) : 0.0;
        result.sets += paper ? share * static_cast<double>(paper->counts().sets) : 0.0;
        result.light.push_back(light.of(blocks));
        if (expected == nullptr) continue;
        std::vector<double> off = result.light.back();
        for (std::size_t u = 0; u < off.size(); ++u) off[u] -= expected->light[frame][u];
        const double error = norm(off) / norm(expected->light[frame]);
        result.mean_error += error / frames;
        result.worst_error = std::max(result.worst_error, error);
    }
    return result;
}

void print(const char* name, const Run& r, double exact_ms) {
    printf("  %-36s %8.2f ms %5.2fx %8.0f anew %8.0f expanded %6.0f sets  error %.3f %% (max %.3f %%)\n",
           name, r.ms_per_frame, exact_ms / r.ms_per_frame, r.refreshed, r.expanded, r.sets,
           100.0 * r.mean_error, 100.0 * r.worst_error);
}

enum class Shadows { Cast, None };

void compare(const char* name, LampRoom room, Shadows shadows, int n, std::uint32_t frames) {
    room.plan.moving_occlusion = shadows == Shadows::Cast;
    PreparedRoom p(std::move(room), n);
    p.options.occlusion = shadows == Shadows::Cast;
    printf("%s: %zu elements of degree %d, %zu moving and %zu crossed pairs\n", name, p.shapes.size(),
           p.room.plan.degree, p.coefficients.moving_pairs.size(), p.coefficients.crossed_pairs.size());
    const Run exact = run(p, {}, frames, nullptr);
    print("exact engine", exact, exact.ms_per_frame);
    struct Variant {
        const char* name;
        ExpansionRule rule;
        motion::Horizons horizons;
        PaperOcclusion occlusion;
        int moves;
    };
    using enum ExpansionRule;
    using enum motion::Horizons;
    const auto as_published = PaperOcclusion::Publication, exact_sight = PaperOcclusion::Exact;
    for (const Variant& v : {Variant{"printed, kept horizons, publication", Printed, Kept, as_published, 1},
                             Variant{"printed, publication's occlusion", Printed, Refresh, as_published, 1},
                             Variant{"printed, exact occlusion", Printed, Refresh, exact_sight, 1},
                             Variant{"scale-free, exact occlusion", ScaleFree, Refresh, exact_sight, 1},
                             Variant{"certified, exact occlusion", Certified, Refresh, exact_sight, 1},
                             Variant{"certified, exact, 4 moves", Certified, Refresh, exact_sight, 4}}) {
        PaperOptions options;
        options.expansion.rule = v.rule;
        options.expansion.horizons = v.horizons;
        options.occlusion = v.occlusion;
        options.moves_per_frame = v.moves;
        options.sources = {MaterialId(1)};
        print(v.name, run(p, options, frames, &exact), exact.ms_per_frame);
    }
}

// What one pair's block takes: computed, its coefficients, and expanded from them. Unit squares across a gap.
void print_costs(double gap, int degree) {
    model::PatchSet set;
    set.patches = {support::rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)),
                   support::rectangle(Vec3(0.2, 0.1, gap), Vec3(0, 1, 0), Vec3(1, 0, 0))};
    const auto shapes = support::shapes_of(set, 1, degree);
    const visibility::Occluders none({});
    const motion::PairNodes nodes(shapes[0], shapes[1], 1e-3);
    const auto microseconds = [](const auto& work) {
        constexpr int times = 400;
        const double started = processor_ms();
        for (int k = 0; k < times; ++k) work();
        return 1e3 * (processor_ms() - started) / times;
    };
    const Vec3 direction = glm::normalize(Vec3(1, 1, 0));
    const auto series = motion::translation_blocks(nodes, direction, 6);
    std::vector<double> values(nodes.block_size());
    const double block = microseconds(
        [&] { values = kernel::transport(shapes[0], shapes[1], none, {.occlusion = false}).values; });
    const double translation = microseconds([&] { motion::translation_blocks(nodes, direction, 6); });
    const double rotation =
        microseconds([&] { motion::rotation_blocks(nodes, motion::Turning::Second, true); });
    const double expanded = microseconds([&] { motion::add_translation(series, 0.1, 1.0, values); });
    printf("gap %.1f, degree %d: block %.2f us; in its units: six orders %.1f, turn %.1f, expansion %.4f\n",
           gap, degree, block, translation / block, rotation / block, expanded / block);
}

} // namespace
} // namespace kinelux

int main(int argc, char** argv) {
    using namespace kinelux;
    using Shelf = LampRoom::Shelf;
    const int n = argc > 1 ? std::atoi(argv[1]) : 5;
    const auto frames = static_cast<std::uint32_t>(argc > 2 ? std::atoi(argv[2]) : 41);
    core::set_thread_count(1);
    for (const double gap : {1.5, 6.0})
        for (int degree = 0; degree <= 3; ++degree) print_costs(gap, degree);
    struct Scene {
        const char* name;
        std::vector<model::Keyframe> keys;
        Shelf shelf;
        Shadows shadows = Shadows::Cast;
    };
    for (const Scene& scene : {Scene{"lamp slides along an axis, nothing casts shadows", motion::slide(),
                                     Shelf::None, Shadows::None},
                               Scene{"lamp slides along an axis", motion::slide(), Shelf::None},
                               Scene{"lamp on a bent path", motion::bend(), Shelf::None},
                               Scene{"lamp turns in place", motion::spin(), Shelf::None},
                               Scene{"lamp slides and turns", motion::spin_and_slide(), Shelf::None},
                               Scene{"lamp slides, shelf slides below it", motion::slide(), Shelf::Moving}}) {
        LampRoom room(scene.keys, scene.shelf);
        if (argc > 3) room.plan.degree = std::atoi(argv[3]);
        compare(scene.name, std::move(room), scene.shadows, n, frames);
    }
}
