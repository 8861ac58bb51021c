// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/quasi_monte_carlo.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/sequence.h"
#include "pair_recipes.h"
#include "support/closed_forms.h"
#include "support/pair_reference.h"
#include "support/planar_patches.h"
#include "support/shapes.h"

namespace kinelux::kernel {
namespace {

using support::rectangle;

double distance(const TransportBlock& block, const std::vector<double>& values) {
    double sum = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k)
        sum += (block.values[k] - values[k]) * (block.values[k] - values[k]);
    return std::sqrt(sum);
}

TEST(Sobol, every_two_of_four_dimensions_are_evenly_filled) {
    // Of 256 points each dimension has one in every 256th, and any two dimensions have four in each of 64 squares.
    for (std::size_t d = 0; d < 4; ++d) {
        std::vector<int> hits(256, 0);
        for (std::uint32_t i = 0; i < 256; ++i)
            ++hits[static_cast<std::size_t>(256 * core::sobol_4d(i, 7)[d])];
        for (const int hit : hits) ASSERT_EQ(hit, 1) << "dimension " << d;
        for (std::size_t e = 0; e < d; ++e) {
            std::vector<int> boxes(64, 0);
            for (std::uint32_t i = 0; i < 256; ++i) {
                const auto point = core::sobol_4d(i, 7);
                ++boxes[8 * static_cast<std::size_t>(8 * point[d]) + static_cast<std::size_t>(8 * point[e])];
            }
            for (const int count : boxes) ASSERT_EQ(count, 4) << "dimensions " << d << " and " << e;
        }
    }
}

class QuasiMonteCarlo : public testing::TestWithParam<Points> {};

TEST_P(QuasiMonteCarlo, tends_to_the_reference_within_its_standard_error) {
    const visibility::Occluders nothing{std::vector<visibility::Body>()};
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const auto pair = validation::make_pair({validation::PairClass::Close, seed, 2});
        const auto reference = support::pair_reference(pair.a, pair.b, 1e-6);
        const auto block = quasi_monte_carlo(pair.a, pair.b, nothing,
                                             {.samples = 4096, .scramblings = 16, .points = GetParam()});
        constexpr double wide = 4.0; // standard errors
        EXPECT_LT(distance(block, reference.values), wide * block.error) << "seed " << seed;
        EXPECT_LT(block.error, 0.1 * reference.norm);
    }
}

TEST_P(QuasiMonteCarlo, sees_what_stands_between) {
    model::PatchSet set;
    set.patches = {rectangle({0, 0, 0}, {2, 0, 0}, {0, 1, 0}), rectangle({0, 0, 1}, {0, 1, 0}, {2, 0, 0}),
                   rectangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1})};
    const auto shapes = geometry::element_shapes(set, support::whole_patch_elements(set), 0, 0);
    const auto occluders = support::occluders_of(set, support::plain_scene(1));
    const auto block = quasi_monte_carlo(shapes[0], shapes[1], occluders, {.points = GetParam()});
    EXPECT_NEAR(block.values[0], support::parallel_equal_rectangles(1, 1, 1), 4.0 * block.error);
    EXPECT_LT(block.error, 0.01);
    EXPECT_GT(block.rays, 8000u);
}

TEST_P(QuasiMonteCarlo, repeats_itself) {
    const visibility::Occluders nothing{std::vector<visibility::Body>()};
    const auto pair = validation::make_pair({validation::PairClass::Hinge, 1, 1});
    const QuasiMonteCarloOptions options{.samples = 64, .points = GetParam()};
    EXPECT_EQ(quasi_monte_carlo(pair.a, pair.b, nothing, options).values,
              quasi_monte_carlo(pair.a, pair.b, nothing, options).values);
}

INSTANTIATE_TEST_SUITE_P(points, QuasiMonteCarlo, testing::Values(Points::Sobol, Points::Random));

} // namespace
} // namespace kinelux::kernel
