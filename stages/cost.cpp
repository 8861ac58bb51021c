// SPDX-License-Identifier: GPL-3.0-or-later
#include "cost.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <vector>

#include "core/parallel.h"
#include "geometry/pose.h"
#include "motion/changing_pairs.h"
#include "solve/transport_operator.h"

namespace kinelux::stages {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point began) {
    return std::chrono::duration<double>(Clock::now() - began).count();
}

// The sum over all rows from that of some, and its standard error.
Predicted extrapolated(const std::vector<double>& values, std::size_t all) {
    const auto count = static_cast<double>(values.size());
    double sum = 0.0, squares = 0.0;
    for (const double value : values) sum += value;
    for (const double value : values) squares += (value - sum / count) * (value - sum / count);
    const double scale = static_cast<double>(all) / count;
    const double rest = 1.0 - count / static_cast<double>(all); // nothing is uncertain of rows that are known
    return {scale * sum,
            scale * std::sqrt(std::max(rest, 0.0) * squares * count / std::max(count - 1.0, 1.0))};
}

// What the pairs of the sampled rows that change take in one frame, on all threads.
struct FrameCost {
    double seconds = 0.0, blocks = 0.0;
};
FrameCost frame_cost(LightCase& light, const model::Coefficients& sample, std::uint64_t seed) {
    motion::ChangingPairs changing(sample, light.elements, light.plan, light.occluders,
                                   light.transport_options(seed));
    const std::uint32_t last = light.scene.time.frames - 1;
    const std::set<std::uint32_t> frames{0, last / 2, last};
    FrameCost cost;
    for (const std::uint32_t frame : frames) {
        changing.set_poses(geometry::object_poses(light.scene, light.scene.time.time_of_frame(frame)));
        std::vector<std::uint8_t> integrated(changing.pairs().size(), 0);
        const auto began = Clock::now();
        core::parallel_for(integrated.size(), [&](std::size_t k) {
            const motion::Change change = changing.change(k);
            if (change == motion::Change::None || change == motion::Change::Zero) return;
            changing.block(k, change);
            integrated[k] = 1;
        });
        cost.seconds += seconds_since(began) / static_cast<double>(frames.size());
        cost.blocks += static_cast<double>(std::count(integrated.begin(), integrated.end(), 1)) /
                       static_cast<double>(frames.size());
    }
    return cost;
}

// One product with all blocks, per stored value and channel.
double seconds_per_value(const model::Coefficients& sample, std::size_t channels) {
    const auto values = static_cast<double>(sample.static_blocks.values.size());
    if (!(values > 0.0)) return 0.0;
    const solve::BlockOperator blocks(sample.layout, sample.static_blocks);
    const std::vector<double> x(sample.layout.unknowns() * channels, 1.0);
    std::vector<double> y(x.size());
    const auto began = Clock::now();
    constexpr int products = 3;
    for (int k = 0; k < products; ++k) solve::apply(blocks, channels, x, y);
    return seconds_since(began) / products / values;
}

} // namespace

Cost predict_cost(LightCase& light, std::uint64_t seed) {
    constexpr std::size_t share = 50, fewest = 32, most = 64;
    const std::size_t all = light.elements.size();
    Cost cost;
    const auto began = Clock::now();
    const coefficients::RowSample sample =
        coefficients::sample_rows(light.elements, light.scene, light.plan, light.occluders,
                                  light.transport_options(seed), std::clamp(all / share, fewest, most));
    const double wall = seconds_since(began);
    cost.rows = sample.rows.size();
    cost.of_rows = all;

    double busy = 0.0;
    for (const double seconds : sample.seconds) busy += seconds;
    const double threads = std::max(busy / wall, 1.0);
    cost.coefficients_s = extrapolated(sample.seconds, all);
    cost.coefficients_s.value /= threads;
    cost.coefficients_s.error /= threads;

    const auto& layout = sample.coefficients.layout;
    std::vector<double> blocks(cost.rows, 0.0), bytes(cost.rows, 0.0);
    for (const model::BlockEntry& entry : sample.coefficients.static_blocks.entries) {
        const auto row = static_cast<std::size_t>(std::find(sample.rows.begin(), sample.rows.end(), entry.i) -
                                                  sample.rows.begin());
        blocks[row] += 1.0;
        bytes[row] += static_cast<double>(layout.count(entry.i) * layout.count(entry.j) * sizeof(float) +
                                          sizeof(model::BlockEntry));
    }
    constexpr double mib = 1024.0 * 1024.0;
    cost.blocks = extrapolated(blocks, all);
    cost.memory_mib = extrapolated(bytes, all);
    cost.memory_mib.value /= mib;
    cost.memory_mib.error /= mib;

    // To the first frame's solution, and to the next from there: 16 and 4.5 products with all blocks on the shipped scenes, each
    // 2.7 times as long as one with a sample, which stays in the cache.
    constexpr double first_products = 43.0, next_products = 12.0;
    constexpr std::uint32_t few_frames = 8; // up to here the exact engine is taken
    const auto frames = static_cast<double>(light.scene.time.frames);
    const double scale = static_cast<double>(all) / static_cast<double>(cost.rows);
    const std::size_t channels = light.plan.single_channel ? 1 : light.scene.channels.size();
    const double values = cost.memory_mib.value * mib / sizeof(float);
    cost.solve_s.value = (first_products + next_products * (frames - 1.0)) * values *
                         seconds_per_value(sample.coefficients, channels);
    if (!light.plan.moving_objects.empty()) {
        const FrameCost frame = frame_cost(light, sample.coefficients, seed);
        // Of the exact engine's frames, what offline takes: all of short pieces, a fifth of long ones; one for weights.
        const bool offline = light.scene.time.frames > few_frames;
        const double like_frames = offline ? std::min(frames, 0.2 * frames + 5.0) + 1.0 : frames;
        cost.blocks_per_frame = scale * frame.blocks;
        cost.solve_s.value += like_frames * scale * frame.seconds;
    }
    cost.solve_s.error = cost.coefficients_s.value > 0.0
                             ? cost.solve_s.value * cost.coefficients_s.error / cost.coefficients_s.value
                             : 0.0;
    return cost;
}

} // namespace kinelux::stages
