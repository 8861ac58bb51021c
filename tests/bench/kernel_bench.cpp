// SPDX-License-Identifier: GPL-3.0-or-later
// Transport blocks per second by kind of pair, and the solver's sweep. One thread unless said.
#include <benchmark/benchmark.h>

#include "coefficients/coefficients.h"
#include "kernel/clear_pair.h"
#include "kernel/transport.h"
#include "solve/transport_operator.h"
#include "support/shapes.h"

namespace kinelux {
namespace {

model::PatchSet pair_of_squares(double gap, bool hinged) {
    model::PatchSet set;
    set.patches = {support::rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)),
                   hinged ? support::rectangle(Vec3(0), Vec3(0, 1, 0), Vec3(0, 0, 1))
                          : support::rectangle(Vec3(0, 0, gap), Vec3(0, 1, 0), Vec3(1, 0, 0))};
    return set;
}

void transport_of(benchmark::State& state, const model::PatchSet& set) {
    const auto shapes = support::shapes_of(set, 1, static_cast<int>(state.range(0)));
    const auto occluders = support::occluders_of(set, support::plain_scene(1));
    for (auto _ : state)
        benchmark::DoNotOptimize(kernel::transport(shapes[0], shapes[1], occluders, {.occlusion = false}));
    state.SetItemsProcessed(state.iterations());
}

// Two squares at gap 1.5 with a pane at half height over a share of the way between them; 1 hides all.
void behind_pane(benchmark::State& state, double share, bool exact_sight) {
    const auto pair = pair_of_squares(1.5, false);
    model::PatchSet all = pair;
    all.patches.push_back(
        support::rectangle(Vec3(-1.0, -1.0, 0.75), Vec3(1.0 + 2.0 * share, 0, 0), Vec3(0, 3, 0)));
    const auto shapes = support::shapes_of(pair, 1, static_cast<int>(state.range(0)));
    const auto occluders = support::occluders_of(all, support::plain_scene(1));
    for (auto _ : state)
        benchmark::DoNotOptimize(
            kernel::transport(shapes[0], shapes[1], occluders, {.exact_sight = exact_sight}));
    state.SetItemsProcessed(state.iterations());
}

// The short way that most pairs of a scene take.
void far_clear_pair(benchmark::State& state) {
    const auto shapes = support::shapes_of(pair_of_squares(6.0, false), 1, static_cast<int>(state.range(0)));
    const kernel::FlatEnd a(shapes[0]), b(shapes[1]);
    std::vector<double> values(shapes[0].basis.size() * shapes[1].basis.size());
    for (auto _ : state) {
        benchmark::DoNotOptimize(kernel::clear_far_block(a, b, 1e-3, values));
        benchmark::DoNotOptimize(values.data());
    }
    state.SetItemsProcessed(state.iterations());
}
void near_clear_pair(benchmark::State& state, const model::PatchSet& set) {
    const auto shapes = support::shapes_of(set, 1, 0);
    double value = 0.0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(kernel::clear_near_block(shapes[0], shapes[1], 1e-3, value));
        benchmark::DoNotOptimize(value);
    }
    state.SetItemsProcessed(state.iterations());
}
void facing_clear_pair(benchmark::State& state) { near_clear_pair(state, pair_of_squares(0.1, false)); }
void hinged_clear_pair(benchmark::State& state) { near_clear_pair(state, pair_of_squares(0.0, true)); }
BENCHMARK(far_clear_pair)->DenseRange(0, 3);
BENCHMARK(facing_clear_pair);
BENCHMARK(hinged_clear_pair);

void hidden_pair(benchmark::State& state) { behind_pane(state, 1.0, true); }
void partly_hidden_pair(benchmark::State& state) { behind_pane(state, 0.3, true); }
void sampled_pair(benchmark::State& state) { behind_pane(state, 0.3, false); }
BENCHMARK(hidden_pair)->DenseRange(0, 3);
BENCHMARK(partly_hidden_pair)->DenseRange(0, 3);
BENCHMARK(sampled_pair)->DenseRange(0, 3);

void far_pair(benchmark::State& state) { transport_of(state, pair_of_squares(6.0, false)); }
void middle_pair(benchmark::State& state) { transport_of(state, pair_of_squares(1.5, false)); }
void near_pair(benchmark::State& state) { transport_of(state, pair_of_squares(0.1, false)); }
void hinged_pair(benchmark::State& state) { transport_of(state, pair_of_squares(0.0, true)); }
BENCHMARK(far_pair)->DenseRange(0, 3);
BENCHMARK(middle_pair)->DenseRange(0, 3);
BENCHMARK(near_pair)->DenseRange(0, 3);
BENCHMARK(hinged_pair)->DenseRange(0, 3);

// A furnished box room of 9 x n x n elements, degree 2; items are the pairs of elements examined, CPU time of all threads.
void room_coefficients(benchmark::State& state) {
    const int n = static_cast<int>(state.range(0));
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(3, 4, 2.5), support::Facing::Inwards);
    for (const auto& patch : support::box(Vec3(1, 1, 0.3), Vec3(1.6, 2.2, 1.1), support::Facing::Outwards))
        set.patches.push_back(patch);
    const auto scene = support::plain_scene(1);
    const auto shapes = support::shapes_of(set, n, 2);
    const auto occluders = support::occluders_of(set, scene);
    double pairs = 0.0;
    for (auto _ : state) {
        const auto result =
            coefficients::compute_coefficients(shapes, scene, {.degree = 2}, occluders, {}, 1e6);
        pairs += result.pairs_examined;
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(pairs));
}
BENCHMARK(room_coefficients)->Arg(2)->Arg(4)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void sweep(benchmark::State& state) {
    model::PatchSet set;
    set.patches = support::box(Vec3(0), Vec3(3, 4, 2.5), support::Facing::Inwards);
    const auto scene = support::plain_scene(1);
    const auto shapes = support::shapes_of(set, 5, 2);
    const auto occluders = support::occluders_of(set, scene);
    const auto coefficients =
        coefficients::compute_coefficients(shapes, scene, {.degree = 2}, occluders, {}, 1e6);
    const solve::BlockOperator blocks(coefficients.layout, coefficients.static_blocks);
    std::vector<double> x(coefficients.layout.unknowns() * 3, 1.0), y(x.size());
    for (auto _ : state) solve::apply(blocks, 3, x, y);
    state.SetBytesProcessed(
        static_cast<std::int64_t>(2 * coefficients.static_blocks.values.size() * sizeof(float)) *
        state.iterations());
}
BENCHMARK(sweep)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

} // namespace
} // namespace kinelux
