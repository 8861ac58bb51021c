// SPDX-License-Identifier: GPL-3.0-or-later
// What a frame of a moving scene costs by each engine of motion, and how far each is off; scripts/bench --temporal.
//   temporal_bench CASE [--stride N] [--no-occlusion] [--csv FILE]
// CASE has been computed up to its plan. CPU seconds of one thread; errors against blocks integrated anew and solved to
// 1e-9: what motion and solver add, not what elements and blocks leave out (the scene's accuracy).
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "core/parallel.h"
#include "engines.h"
#include "light_case.h"
#include "motion/posed_elements.h"
#include "solve/animation.h"

using namespace kinelux;

namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// The classical way: all blocks are integrated anew in every frame.
class ScratchEngine : public motion::Engine {
public:
    ScratchEngine(stages::LightCase& light, const kernel::TransportOptions& options)
        : light_(light), options_(options) {}

    motion::FrameBlocks advance(double /*time_s*/, std::span<const geometry::Pose> poses) override {
        light_.occluders.set_poses(poses);
        const motion::PosedElements elements(light_.elements, light_.plan, poses);
        motion::FrameBlocks frame;
        for (std::uint32_t i = 0; i < light_.elements.size(); ++i)
            for (std::uint32_t j = i; j < light_.elements.size(); ++j) {
                const auto block = kernel::transport(elements[i], elements[j], light_.occluders, options_);
                frame.pairs.push_back({i, j});
                ++frame.computed;
                if (block.values.empty()) continue;
                frame.blocks.entries.push_back(
                    {i, j, frame.blocks.values.size(), static_cast<float>(block.error)});
                for (const double value : block.values)
                    frame.blocks.values.push_back(static_cast<float>(value));
            }
        return frame;
    }

private:
    stages::LightCase& light_;
    kernel::TransportOptions options_;
};

struct Way {
    std::string name;
    solve::SolveOptions solve;
    std::uint32_t stride; ///< of the frames it is measured on
    std::function<std::unique_ptr<motion::Engine>()> engine;
};

struct Run {
    double build_s = 0.0;    ///< CPU before the first frame
    double playback_s = 0.0; ///< CPU per frame when all blocks are asked for once more
    std::vector<std::uint32_t> frames;
    std::vector<double> seconds; ///< CPU per frame
    std::vector<double> computed;
    std::vector<std::vector<double>> radiosity;
};

Run run(const Way& way, const stages::LightCase& light, const model::Coefficients& coefficients,
        std::span<const double> areas) {
    Run result;
    for (std::uint32_t f = 0; f < light.scene.time.frames; f += way.stride) result.frames.push_back(f);
    double last = cpu_seconds();
    const auto engine = way.engine();
    result.build_s = cpu_seconds() - last;
    last = cpu_seconds();
    solve::solve_animation({light.scene, light.plan, coefficients, light.tree.elements, areas}, *engine,
                           result.frames, way.solve, [&](const model::FrameSolution& frame) {
                               const double now = cpu_seconds();
                               result.seconds.push_back(now - last);
                               result.computed.push_back(static_cast<double>(frame.blocks_recomputed));
                               result.radiosity.push_back(frame.radiosity);
                               last = cpu_seconds();
                           });
    last = cpu_seconds();
    for (const std::uint32_t f : result.frames) {
        const double time_s = light.scene.time.time_of_frame(f);
        if (way.name == "offline") engine->advance(time_s, geometry::object_poses(light.scene, time_s));
    }
    result.playback_s = (cpu_seconds() - last) / static_cast<double>(result.frames.size());
    return result;
}

// Relative L2 difference of radiosity over what does not emit.
double difference(const stages::LightCase& light, const model::UnknownLayout& layout,
                  std::span<const double> found, std::span<const double> expected) {
    const std::size_t channels = light.scene.channels.size();
    double error = 0.0, size = 0.0;
    for (std::size_t e = 0; e < layout.elements(); ++e) {
        if (light.scene.materials[light.elements[e].material.value].emits()) continue;
        for (std::size_t k = layout.offsets[e] * channels; k < layout.offsets[e + 1] * channels; ++k) {
            error += (found[k] - expected[k]) * (found[k] - expected[k]);
            size += expected[k] * expected[k];
        }
    }
    return size > 0.0 ? std::sqrt(error / size) : 0.0;
}

struct Summary {
    double per_frame = 0.0, mean_error = 0.0, max_error = 0.0, computed = 0.0;
};

Summary summary(const Run& run, std::span<const double> errors) {
    Summary result;
    const auto n = static_cast<double>(run.frames.size());
    for (std::size_t f = 0; f < run.frames.size(); ++f) {
        result.per_frame += run.seconds[f] / n;
        result.computed += run.computed[f] / n;
        result.mean_error += errors[f] / n;
        result.max_error = std::max(result.max_error, errors[f]);
    }
    return result;
}

} // namespace

int main(int argc, char** argv) {
    std::string folder, csv;
    std::uint32_t stride = 10;
    bool occlusion = true;
    for (int k = 1; k < argc; ++k) {
        const std::string word = argv[k];
        if (word == "--stride" && k + 1 < argc)
            stride = static_cast<std::uint32_t>(std::stoul(argv[++k]));
        else if (word == "--csv" && k + 1 < argc)
            csv = argv[++k];
        else if (word == "--no-occlusion")
            occlusion = false;
        else
            folder = word;
    }
    if (folder.empty()) {
        std::puts("temporal_bench CASE [--stride N] [--no-occlusion] [--csv FILE]");
        return 2;
    }
    try {
        core::set_thread_count(1);
        stages::LightCase light = stages::read_light_case(io::CaseFolder(folder));
        if (!occlusion) light.plan.static_occlusion = light.plan.moving_occlusion = false;
        const kernel::TransportOptions options = light.transport_options(1);
        const auto coefficients = coefficients::compute_coefficients(light.elements, light.scene, light.plan,
                                                                     light.occluders, options, 1e6);
        const std::vector<double> areas = light.areas();
        std::vector<std::uint32_t> all;
        for (std::uint32_t f = 0; f < light.scene.time.frames; ++f) all.push_back(f);
        const auto engine = [&](const char* name) {
            return [&, name] {
                return stages::make_engine({.name = name}, light, coefficients, areas, all, 1).engine;
            };
        };
        const solve::SolveOptions usual{.tolerance = solve::tolerance_for(light.scene.accuracy.target)};
        solve::SolveOptions cold = usual;
        cold.method = solve::Method::Shooting;
        solve::SolveOptions papers = usual;
        papers.method = solve::Method::TemporalShooting;
        papers.start = solve::Start::LastFrame;
        const std::vector<Way> ways{
            {"classical", cold, stride, [&] { return std::make_unique<ScratchEngine>(light, options); }},
            {"cached", cold, stride, engine("exact")},
            {"exact", usual, 1, engine("exact")},
            {"paper", papers, 1, engine("paper")},
            {"online", usual, 1, engine("online")},
            {"offline", usual, 1, engine("offline")},
        };
        const Run truth =
            run({"converged", {.tolerance = 1e-9}, 1, engine("exact")}, light, coefficients, areas);
        std::ofstream table;
        if (!csv.empty()) table.open(csv);
        table << "way,frame,cpu_s,error\n";
        fmt::print("{} elements, {} unknowns, {} moving pairs, {} crossed pairs, {} frames, occlusion {}\n",
                   light.elements.size(), coefficients.layout.unknowns(), coefficients.moving_pairs.size(),
                   coefficients.crossed_pairs.size(), light.scene.time.frames, occlusion ? "on" : "off");
        fmt::print("{:<12}{:>12}{:>12}{:>11}{:>11}{:>13}{:>12}{:>12}\n", "way", "build CPU s", "ms a frame",
                   "/classical", "/cached", "integrated", "mean error", "max error");
        double classical = 0.0, cached = 0.0;
        for (const Way& way : ways) {
            const Run found = run(way, light, coefficients, areas);
            std::vector<double> errors;
            for (std::size_t f = 0; f < found.frames.size(); ++f) {
                errors.push_back(difference(light, coefficients.layout, found.radiosity[f],
                                            truth.radiosity[found.frames[f]]));
                table << fmt::format("{},{},{:.6g},{:.6g}\n", way.name, found.frames[f], found.seconds[f],
                                     errors.back());
            }
            const Summary s = summary(found, errors);
            const double cost = s.per_frame + found.build_s / static_cast<double>(found.frames.size());
            if (way.name == "classical") classical = cost;
            if (way.name == "cached") cached = cost;
            fmt::print("{:<12}{:>12.3f}{:>12.2f}{:>11.2f}{:>11.2f}{:>13.1f}{:>11.3f}%{:>11.3f}%\n", way.name,
                       found.build_s, 1e3 * cost, classical / cost, cached > 0.0 ? cached / cost : 0.0,
                       s.computed, 100.0 * s.mean_error, 100.0 * s.max_error);
            if (way.name == "offline")
                fmt::print("blocks of any frame from the stored ones: {:.2f} ms\n", 1e3 * found.playback_s);
            std::fflush(stdout);
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "temporal_bench: {}\n", error.what());
        return 1;
    }
    return 0;
}
