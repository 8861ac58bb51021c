// SPDX-License-Identifier: GPL-3.0-or-later
// Frames of a closed room with a sliding lamp, against each frame solved to rounding.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/parallel.h"
#include "support/sliding_lamp.h"

namespace kinelux::solve {
namespace {

using support::SlidingLamp;

const SlidingLamp& lamp() {
    static const SlidingLamp room(9, 2, 1);
    return room;
}

// Two rooms with little light between them.
const SlidingLamp& walled() {
    static const SlidingLamp rooms(2, 2, 1, 0.1, support::Inside::Wall);
    return rooms;
}

struct Light {
    const SlidingLamp& room;
    std::size_t channels;
    std::vector<double> exitance, reflectance;

    Light(double rho, std::size_t count, const SlidingLamp& in = lamp())
        : room(in), channels(count), exitance(in.exitance(count)), reflectance(in.reflectance(rho, count)) {}
    System system(const TransportOperator& transport) const {
        return {transport, channels, exitance, reflectance, room.areas()};
    }
    std::vector<double> exact(const TransportOperator& transport) const {
        return solve_system(system(transport), {.method = Method::ConjugateGradients, .tolerance = 1e-12}, {})
            .radiosity;
    }
    TemporalSolver solver(const SolveOptions& options) const {
        return {channels, reflectance, room.areas(), options};
    }
    // Over what does not emit.
    double error(const std::vector<double>& radiosity, const std::vector<double>& truth) const {
        double difference = 0.0, size = 0.0;
        const auto& layout = room.layout();
        for (std::size_t e = 0; e < layout.elements(); ++e) {
            if (exitance[layout.offsets[e] * channels] > 0.0) continue;
            for (std::size_t k = layout.offsets[e] * channels; k < layout.offsets[e + 1] * channels; ++k) {
                difference += (radiosity[k] - truth[k]) * (radiosity[k] - truth[k]);
                size += truth[k] * truth[k];
            }
        }
        return std::sqrt(difference / size);
    }
};

constexpr std::array all_methods{Method::Automatic, Method::Shooting, Method::TemporalShooting,
                                 Method::GaussSeidel, Method::ConjugateGradients};

void expect_agreement(const SlidingLamp& room, double rho) {
    const BlockOperator blocks(room.layout(), room.static_blocks());
    const Light light(rho, 3, room);
    const std::vector<double> truth = light.exact(blocks);
    for (const double tolerance : {1e-3, 1e-6})
        for (const Method method : all_methods) {
            const auto found = solve_system(
                light.system(blocks), {.method = method, .tolerance = tolerance, .max_sweeps = 1e5}, {});
            const double error = light.error(found.radiosity, truth);
            SCOPED_TRACE("method " + std::to_string(static_cast<int>(method)) + " rho " +
                         std::to_string(rho) + " estimate " + std::to_string(found.solver_error));
            EXPECT_TRUE(found.converged);
            EXPECT_LE(error, tolerance);
            // The estimate is no smaller than the error, and not so large that work is wasted for digits.
            EXPECT_LE(error, 1.1 * found.solver_error);
            EXPECT_GE(error, 0.01 * found.solver_error);
        }
}

TEST(SolveSystem, all_methods_agree_within_the_tolerance_in_closed_rooms_of_any_brightness) {
    for (const double rho : {0.5, 0.9, 0.99}) expect_agreement(lamp(), rho);
}

TEST(SolveSystem, all_methods_agree_within_the_tolerance_where_two_rooms_exchange_little_light) {
    for (const double rho : {0.5, 0.9, 0.99}) expect_agreement(walled(), rho);
}

TEST(DominantMode, second_eigenvalue_is_that_of_the_exchange_between_two_rooms) {
    // By orthogonal iteration on two vectors, to rounding.
    const BlockOperator blocks(walled().layout(), walled().static_blocks());
    const Light light(0.9, 1, walled());
    const System system = light.system(blocks);
    std::size_t products = 0;
    const DominantMode mode = dominant_mode(system, {}, products);
    EXPECT_LT(products, 40u);
    const auto& layout = walled().layout();
    const std::size_t n = layout.unknowns();
    std::vector<double> root(n), first(n, 1.0), second(n), image(n);
    for (std::size_t e = 0; e < layout.elements(); ++e)
        for (std::size_t u = layout.offsets[e]; u < layout.offsets[e + 1]; ++u)
            root[u] = std::sqrt(light.reflectance[e]);
    for (std::size_t k = 0; k < n; ++k) second[k] = std::sin(static_cast<double>(k));
    const auto dot = [](const auto& x, const auto& y) {
        double sum = 0.0;
        for (std::size_t k = 0; k < x.size(); ++k) sum += x[k] * y[k];
        return sum;
    };
    const auto step = [&](std::vector<double>& x) {
        std::vector<double> sent = x;
        for (std::size_t k = 0; k < n; ++k) sent[k] *= root[k];
        blocks.apply(1, sent, image);
        for (std::size_t k = 0; k < n; ++k) x[k] = root[k] * image[k];
        const double norm = std::sqrt(dot(x, x));
        for (double& value : x) value /= norm;
        return norm;
    };
    double largest = 0.0, next = 0.0;
    for (int i = 0; i < 300; ++i) {
        largest = step(first);
        const double shared = dot(first, second);
        for (std::size_t k = 0; k < n; ++k) second[k] -= shared * first[k];
        next = step(second);
    }
    const double q = returned_shares(system, mode).front();
    EXPECT_NEAR(q, largest, 0.05 * (1.0 - largest));
    EXPECT_NEAR(q * mode.second.front(), next, 0.2 * (1.0 - next));
    EXPECT_GT(next, 0.6);
}

TEST(TemporalSolver, every_frame_of_every_method_is_within_the_tolerance) {
    for (const double rho : {0.5, 0.9, 0.99})
        for (const Method method : all_methods) {
            const Light light(rho, 2);
            BlockOperator blocks(lamp().layout(), lamp().static_blocks());
            TemporalSolver solver = light.solver({.method = method, .tolerance = 1e-4, .max_sweeps = 1e5});
            for (std::uint32_t f = 0; f < 12; ++f) {
                lamp().move(blocks, f);
                const auto frame = solver.solve_frame(blocks, light.exitance);
                EXPECT_TRUE(frame.converged);
                EXPECT_LE(light.error(frame.radiosity, light.exact(blocks)), 1e-4)
                    << "frame " << f << " rho " << rho << " method " << static_cast<int>(method);
            }
        }
}

TEST(TemporalSolver, follows_light_that_fades_and_goes_out) {
    const Light light(0.8, 1);
    BlockOperator blocks(lamp().layout(), lamp().static_blocks());
    for (const Method method : all_methods) {
        TemporalSolver solver = light.solver({.method = method, .tolerance = 1e-5});
        for (const double share : {1.0, 0.7, 0.4, 0.1, 0.0, 0.5}) {
            Light now = light;
            for (double& value : now.exitance) value *= share;
            const auto frame = solver.solve_frame(blocks, now.exitance);
            if (share > 0.0) {
                EXPECT_LE(now.error(frame.radiosity, now.exact(blocks)), 1e-5);
            } else {
                for (const double value : frame.radiosity) EXPECT_EQ(value, 0.0);
            }
        }
    }
}

TEST(TemporalSolver, temporal_shooting_takes_the_shots_of_a_warm_start_with_the_exact_residual) {
    // Equation (9) with the leftover carried, against the residual computed anew from G' and B: the same sequence.
    const Light light(0.9, 1);
    BlockOperator blocks(lamp().layout(), lamp().static_blocks());
    const SolveOptions options{
        .method = Method::TemporalShooting, .tolerance = 1e-3, .start = Start::LastFrame};
    TemporalSolver solver = light.solver(options);
    std::vector<double> anew;
    for (std::uint32_t f = 0; f < 6; ++f) {
        lamp().move(blocks, f);
        const auto frame = solver.solve_frame(blocks, light.exitance);
        anew = solve_system(light.system(blocks), options, anew).radiosity;
        for (std::size_t k = 0; k < anew.size(); ++k)
            EXPECT_NEAR(frame.radiosity[k], anew[k], 1e-9) << "frame " << f;
    }
}

TEST(TemporalSolver, an_extrapolated_start_takes_fewer_sweeps_than_the_last_frame) {
    const SlidingLamp slow(21, 1, 1, 0.2);
    const auto sweeps = [&](Start start) {
        BlockOperator blocks(slow.layout(), slow.static_blocks());
        const auto exitance = slow.exitance(1);
        TemporalSolver solver(1, slow.reflectance(0.7, 1), slow.areas(), {.tolerance = 1e-4, .start = start});
        double sum = 0.0;
        for (std::uint32_t f = 0; f < 20; ++f) {
            slow.move(blocks, f);
            const double now = solver.solve_frame(blocks, exitance).sweeps;
            sum += f > 3 ? now : 0.0;
        }
        return sum;
    };
    EXPECT_LT(sweeps(Start::Extrapolated), sweeps(Start::LastFrame));
}

TEST(TemporalSolver, restored_goes_on_with_the_same_bytes) {
    const Light light(0.9, 2);
    for (const Method method : all_methods) {
        BlockOperator blocks(lamp().layout(), lamp().static_blocks());
        TemporalSolver whole = light.solver({.method = method});
        TemporalSolver second = light.solver({.method = method});
        BlockOperator other(lamp().layout(), lamp().static_blocks());
        for (std::uint32_t f = 0; f < 8; ++f) {
            lamp().move(blocks, f);
            const auto frame = whole.solve_frame(blocks, light.exitance);
            if (f == 4) {
                lamp().move(other, f);
                second.restore(whole.state(), other);
            } else if (f > 4) {
                lamp().move(other, f);
                const auto again = second.solve_frame(other, light.exitance);
                EXPECT_EQ(again.radiosity, frame.radiosity);
                EXPECT_EQ(again.irradiance_indirect, frame.irradiance_indirect);
                EXPECT_EQ(again.sweeps, frame.sweeps);
            }
        }
    }
}

TEST(TemporalSolver, gives_the_same_bytes_on_one_thread_and_two) {
    const Light light(0.9, 3);
    const auto solved = [&](std::size_t threads) {
        core::set_thread_count(threads);
        BlockOperator blocks(lamp().layout(), lamp().static_blocks());
        TemporalSolver solver = light.solver({});
        std::vector<double> last;
        for (std::uint32_t f = 0; f < 5; ++f) {
            lamp().move(blocks, f);
            last = solver.solve_frame(blocks, light.exitance).radiosity;
        }
        core::set_thread_count(0);
        return last;
    };
    EXPECT_EQ(solved(1), solved(2));
}

TEST(BlockOperator, applies_what_has_changed) {
    const SlidingLamp& room = lamp();
    BlockOperator blocks(room.layout(), room.static_blocks());
    std::vector<double> x(room.layout().unknowns()), before(x.size()), now(x.size()), change(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::sin(static_cast<double>(k));
    for (const std::uint32_t frame : {3u, 5u, 0u, 7u}) {
        apply(blocks, 1, x, before);
        room.move(blocks, frame);
        apply(blocks, 1, x, now);
        blocks.apply_change(1, x, change);
        for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(change[k], now[k] - before[k], 1e-13);
        EXPECT_GT(blocks.changed_share(), 0.0);
    }
}

} // namespace
} // namespace kinelux::solve
