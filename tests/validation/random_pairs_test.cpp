// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "pair_judgement.h"

namespace kinelux::validation {
namespace {

// Most pairs at the tolerances whose references are cheap, 2,016 in all.
struct Series {
    double tolerance;
    std::uint64_t seed, count;
};

std::ostream& operator<<(std::ostream& out, const Series& series) {
    return out << "tolerance_" << series.tolerance << "_seed_" << series.seed;
}

constexpr Series all_series[] = {{1e-2, 30, 200}, {1e-2, 31, 200}, {1e-2, 32, 200}, {1e-2, 33, 200},
                                 {1e-2, 34, 200}, {1e-2, 35, 200}, {1e-3, 40, 100}, {1e-3, 41, 100},
                                 {1e-3, 42, 100}, {1e-3, 43, 100}, {1e-3, 44, 100}, {1e-3, 45, 100},
                                 {1e-4, 50, 56},  {1e-4, 51, 56},  {1e-4, 52, 56},  {1e-6, 60, 12},
                                 {1e-6, 61, 12},  {1e-6, 62, 12},  {1e-6, 63, 12}};

constexpr double least_share_within = 0.99, least_share_judged = 0.95;

// KINELUX_PAIRS=2400 judges as many pairs per series.
std::uint64_t pairs_asked_for(const Series& series) {
    const char* asked = std::getenv("KINELUX_PAIRS");
    return asked != nullptr ? std::stoull(asked) : series.count;
}

class RandomPairs : public testing::TestWithParam<Series> {};

TEST_P(RandomPairs, blocks_keep_the_tolerance_and_their_estimates_are_honest) {
    const auto [tolerance, seed, count] = GetParam();
    const auto judgements = judge_series(pairs_asked_for(GetParam()), seed, tolerance, "", -1);
    std::size_t judged = 0, within = 0, dishonest = 0;
    for (const Judgement& judgement : judgements) {
        const bool surely_within = judgement.error + judgement.uncertainty <= tolerance;
        if (judgement.uncertainty > judge_share * tolerance && !surely_within) continue; // no judge for it
        ++judged;
        within += judgement.within_tolerance() ? 1u : 0u;
        dishonest += judgement.honest() ? 0u : 1u;
    }
    EXPECT_GE(static_cast<double>(judged), least_share_judged * static_cast<double>(judgements.size()));
    EXPECT_GE(static_cast<double>(within), least_share_within * static_cast<double>(judged));
    EXPECT_EQ(dishonest, 0u);
    if (HasFailure()) ADD_FAILURE() << "seed " << seed << "\n" << report(judgements, 5);
}

INSTANTIATE_TEST_SUITE_P(series, RandomPairs, testing::ValuesIn(all_series));

} // namespace
} // namespace kinelux::validation
