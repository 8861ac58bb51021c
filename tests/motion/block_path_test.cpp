// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/block_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace kinelux::motion {
namespace {

using Function = std::function<std::vector<double>(double)>;

struct Made {
    BlockPath path;
    double largest = 0.0; ///< error at any frame
    double beyond = 0.0;  ///< the same over what the path says of it
};

// A path through a function of the frame that is integrated without error.
Made path_through(const Function& function, Change change, std::uint32_t frames, double tolerance) {
    Made made{BlockPath(function(0.0).size(), INFINITY)};
    made.path.add_run(change, 0, frames - 1);
    while (!made.path.finished()) {
        for (const BlockPath::Request& request : made.path.requests()) {
            EXPECT_EQ(request.change, change);
            made.path.set(request.frame, {.values = function(request.frame)});
        }
        made.path.judge(tolerance);
    }
    made.path.compact();
    std::vector<double> values(made.path.size());
    for (std::uint32_t frame = 0; frame < frames; ++frame) {
        const BlockPath::Value value = made.path.at(frame, values);
        double off = 0.0;
        const std::vector<double> exact = function(frame);
        for (std::size_t v = 0; v < values.size(); ++v) off = std::hypot(off, values[v] - exact[v]);
        made.largest = std::max(made.largest, off);
        made.beyond = std::max(made.beyond, off - value.error);
    }
    return made;
}

TEST(BlockPath, through_a_smooth_function_needs_few_blocks) {
    const Function smooth = [](double f) {
        return std::vector<double>{1.0 / (1.0 + 0.02 * f), std::exp(-0.03 * f)};
    };
    for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
        const Made made = path_through(smooth, Change::Clear, 100, tolerance);
        EXPECT_LE(made.largest, tolerance + 1e-7);
        EXPECT_LE(made.path.integrated(), tolerance < 1e-5 ? 60u : 20u) << tolerance;
    }
}

TEST(BlockPath, through_a_constant_needs_five_blocks) {
    const Made made = path_through([](double) { return std::vector<double>{0.5}; }, Change::Clear, 100, 1e-6);
    EXPECT_LE(made.largest, 1e-7);
    EXPECT_EQ(made.path.integrated(), 5u);
    EXPECT_EQ(made.path.samples(), 3u);
}

TEST(BlockPath, through_kinks_keeps_the_tolerance) {
    const Function kinked = [](double f) {
        return std::vector<double>{std::abs(f - 31.3) / 50.0, std::max(0.0, 0.02 * (f - 44.1))};
    };
    for (const Change change : {Change::Clear, Change::Shaded}) {
        const Made made = path_through(kinked, change, 80, 1e-3);
        EXPECT_LE(made.largest, 1e-3 + 1e-7);
        EXPECT_LE(made.path.integrated(), 55u);
    }
}

TEST(BlockPath, through_noise_takes_every_frame_once) {
    const Function noise = [](double f) { return std::vector<double>{std::sin(1e4 * f * f)}; };
    for (const Change change : {Change::Clear, Change::Shaded}) {
        const Made made = path_through(noise, change, 50, 1e-3);
        EXPECT_LE(made.largest, 1e-7);
        EXPECT_EQ(made.path.integrated(), 50u);
    }
}

TEST(BlockPath, of_one_or_two_frames_is_exact) {
    for (const std::uint32_t frames : {1u, 2u, 3u}) {
        const Made made =
            path_through([](double f) { return std::vector<double>{f * f}; }, Change::Shaded, frames, 1e-3);
        EXPECT_LE(made.largest, 1e-7);
        EXPECT_EQ(made.path.integrated(), frames);
    }
}

TEST(BlockPath, lets_blocks_below_the_tolerance_cost_three) {
    const Made made = path_through([](double f) { return std::vector<double>{1e-4 * std::sin(f)}; },
                                   Change::Clear, 60, 1e-2);
    EXPECT_EQ(made.path.integrated(), 3u);
    EXPECT_LE(made.beyond, 0.0);
}

TEST(BlockPath, covers_its_runs_and_nothing_else) {
    BlockPath path(1, INFINITY);
    path.add_run(Change::Clear, 3, 5);
    path.add_run(Change::Shaded, 8, 8);
    for (const BlockPath::Request& request : path.requests()) path.set(request.frame, {.values = {1.0}});
    path.judge(1.0);
    ASSERT_TRUE(path.finished());
    path.compact();
    EXPECT_TRUE(path.covers(3, 5));
    EXPECT_TRUE(path.covers(8, 8));
    for (const auto& [first, last] :
         {std::pair(2u, 3u), std::pair(5u, 6u), std::pair(6u, 6u), std::pair(8u, 9u)})
        EXPECT_FALSE(path.covers(first, last)) << first;
    EXPECT_GE(path.bytes(), sizeof(BlockPath) + 4 * sizeof(float));
}

} // namespace
} // namespace kinelux::motion
