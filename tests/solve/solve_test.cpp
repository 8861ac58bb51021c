// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/solve.h"

#include <gtest/gtest.h>

#include "core/parallel.h"
#include "core/sequence.h"

namespace kinelux::solve {
namespace {

// A random symmetric system of `elements` elements with 1 to 3 unknowns each, row sums about 1.
struct RandomTransport {
    model::UnknownLayout layout;
    model::BlockSet blocks;

    explicit RandomTransport(std::size_t elements, std::uint64_t seed) {
        core::Random random(seed);
        layout.offsets.push_back(0);
        for (std::size_t e = 0; e < elements; ++e)
            layout.offsets.push_back(layout.offsets.back() + 1 + static_cast<std::uint32_t>(e % 3));
        for (std::uint32_t i = 0; i < elements; ++i)
            for (std::uint32_t j = i; j < elements; ++j) {
                if (random.next() < 0.3) continue;
                blocks.entries.push_back({i, j, blocks.values.size(), 0.0f});
                const bool self = i == j;
                for (std::size_t k = 0; k < layout.count(i); ++k)
                    for (std::size_t l = 0; l < layout.count(j); ++l) {
                        const bool mirrored = self && l < k;
                        const std::size_t twin = blocks.entries.back().offset + l * layout.count(j) + k;
                        blocks.values.push_back(
                            mirrored ? blocks.values[twin]
                                     : static_cast<float>(random.next() / static_cast<double>(2 * elements)));
                    }
            }
    }
};

std::vector<double> random_vector(std::size_t size, std::uint64_t seed) {
    core::Random random(seed);
    std::vector<double> result(size);
    for (double& value : result) value = random.next() - 0.3;
    return result;
}

struct KnownAnswer {
    RandomTransport transport{40, 7};
    BlockOperator blocks{transport.layout, transport.blocks};
    std::size_t channels = 3;
    std::vector<double> answer = random_vector(transport.layout.unknowns() * 3, 11);
    std::vector<double> reflectance = std::vector<double>(40 * 3, 0.0), areas = std::vector<double>(40, 1.0),
                        exitance;

    KnownAnswer() {
        core::Random random(3);
        for (double& rho : reflectance) rho = 0.9 * random.next();
        exitance.resize(answer.size());
        apply(blocks, channels, answer, exitance);
        for (std::size_t e = 0; e < 40; ++e)
            for (std::size_t k = transport.layout.offsets[e] * channels;
                 k < transport.layout.offsets[e + 1] * channels; ++k)
                exitance[k] = answer[k] - reflectance[e * channels + k % channels] * exitance[k];
    }
    System system() const { return {blocks, channels, exitance, reflectance, areas}; }
    double relative_error(const std::vector<double>& x) const {
        double difference = 0.0, size = 0.0;
        for (std::size_t k = 0; k < x.size(); ++k) {
            difference += (x[k] - answer[k]) * (x[k] - answer[k]);
            size += answer[k] * answer[k];
        }
        return std::sqrt(difference / size);
    }
};

TEST(Solve, all_methods_reach_ten_digits_of_a_known_answer) {
    const KnownAnswer known;
    for (const Method method : {Method::GaussSeidel, Method::Shooting, Method::ConjugateGradients}) {
        const auto solution = solve_system(known.system(), {.method = method, .tolerance = 1e-12}, {});
        EXPECT_TRUE(solution.converged);
        EXPECT_LT(solution.residual, 2e-12);
        EXPECT_LT(known.relative_error(solution.radiosity), 1e-10);
    }
}

TEST(Solve, a_start_at_the_answer_needs_no_sweep) {
    const KnownAnswer known;
    EXPECT_EQ(solve_system(known.system(), {.tolerance = 1e-10}, known.answer).sweeps, 0u);
}

TEST(Solve, conjugate_gradients_leave_what_does_not_reflect_as_it_is) {
    KnownAnswer known;
    std::fill_n(known.reflectance.begin(), 60, 0.0);
    const auto solution =
        solve_system(known.system(), {.method = Method::ConjugateGradients, .tolerance = 1e-9}, {});
    EXPECT_TRUE(solution.converged);
    for (std::size_t k = 0; k < std::size_t{known.transport.layout.offsets[20]} * 3; ++k)
        EXPECT_EQ(solution.radiosity[k], known.exitance[k]);
}

TEST(Solve, too_few_sweeps_are_reported_not_hidden) {
    const KnownAnswer known;
    const auto solution = solve_system(known.system(), {.tolerance = 1e-12, .max_sweeps = 2}, {});
    EXPECT_FALSE(solution.converged);
    EXPECT_GT(solution.residual, 1e-12);
}

TEST(Solve, without_emitters_all_is_dark) {
    KnownAnswer known;
    std::fill(known.exitance.begin(), known.exitance.end(), 0.0);
    for (const double value : solve_system(known.system(), {}, {}).radiosity) EXPECT_EQ(value, 0.0);
}

TEST(BlockOperator, scatter_is_gather_seen_from_the_source) {
    const RandomTransport random(17, 5);
    const BlockOperator blocks(random.layout, random.blocks);
    const auto x = random_vector(random.layout.unknowns(), 9);
    std::vector<double> gathered(x.size()), scattered(x.size());
    apply(blocks, 1, x, gathered);
    for (std::size_t e = 0; e < 17; ++e)
        blocks.scatter(e, 1, std::span(x).subspan(random.layout.offsets[e], random.layout.count(e)),
                       scattered);
    for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(gathered[k], scattered[k], 1e-14);
}

TEST(BlockOperator, replaced_blocks_hold_until_the_next_replacement) {
    const RandomTransport random(12, 5), other(12, 6);
    BlockOperator blocks(random.layout, random.blocks);
    const BlockOperator truth(other.layout, other.blocks);
    const auto x = random_vector(random.layout.unknowns(), 9);
    std::vector<double> before(x.size()), all_replaced(x.size()), expected(x.size()), after(x.size());
    apply(blocks, 1, x, before);
    std::vector<model::ElementPair> pairs;
    for (std::uint32_t i = 0; i < 12; ++i)
        for (std::uint32_t j = i; j < 12; ++j) pairs.push_back({i, j});
    blocks.replace(pairs, other.blocks);
    apply(blocks, 1, x, all_replaced);
    apply(truth, 1, x, expected);
    blocks.replace({}, {});
    apply(blocks, 1, x, after);
    EXPECT_EQ(all_replaced, expected);
    EXPECT_EQ(after, before);
}

TEST(BlockOperator, gives_the_same_bytes_on_one_thread_and_two) {
    const RandomTransport random(50, 5);
    const BlockOperator blocks(random.layout, random.blocks);
    const auto x = random_vector(random.layout.unknowns() * 3, 9);
    std::vector<double> one(x.size()), two(x.size());
    core::set_thread_count(1);
    apply(blocks, 3, x, one);
    core::set_thread_count(2);
    apply(blocks, 3, x, two);
    core::set_thread_count(0);
    EXPECT_EQ(one, two);
}

TEST(TemporalSolver, follows_a_fading_source_and_starts_near_the_answer) {
    const KnownAnswer known;
    TemporalSolver solver(3, known.reflectance, known.areas, {.tolerance = 1e-8});
    const auto first = solver.solve_frame(known.blocks, known.exitance);
    const auto second = solver.solve_frame(known.blocks, known.exitance);
    EXPECT_GT(first.sweeps, 2u);
    EXPECT_LE(second.sweeps, 1u);
    EXPECT_LT(known.relative_error(second.radiosity), 1e-7);
    for (std::size_t k = 0; k < first.radiosity.size(); ++k) {
        const double rho = known.reflectance[0];
        if (k < 3 && rho > 0.0) {
            EXPECT_NEAR(first.radiosity[k],
                        known.exitance[k] + known.reflectance[k] *
                                                (first.irradiance_direct[k] + first.irradiance_indirect[k]),
                        1e-6);
        }
    }
}

} // namespace
} // namespace kinelux::solve
