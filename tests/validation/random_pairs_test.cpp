// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "pair_judgement.h"

namespace kinelux::validation {
namespace {

// KINELUX_PAIRS=2400 judges as many pairs per tolerance as docs/validation.md says; few are enough to notice a change.
std::uint64_t pairs_asked_for() {
    const char* asked = std::getenv("KINELUX_PAIRS");
    return asked != nullptr ? std::stoull(asked) : 60;
}

constexpr std::uint64_t seed = 20;
constexpr double least_share_within = 0.95;

class RandomPairs : public testing::TestWithParam<double> {};

TEST_P(RandomPairs, blocks_keep_the_tolerance_and_their_estimates_are_honest) {
    const auto judgements = judge_series(pairs_asked_for(), seed, GetParam(), "", -1);
    std::size_t judged = 0, within = 0, dishonest = 0;
    for (const Judgement& judgement : judgements) {
        if (judgement.uncertainty > judge_share * GetParam()) continue; // no judge for it
        ++judged;
        within += judgement.within_tolerance() ? 1u : 0u;
        dishonest += judgement.honest() ? 0u : 1u;
    }
    const double count = static_cast<double>(judged);
    EXPECT_GE(count, least_share_within * static_cast<double>(judgements.size())) << report(judgements, 5);
    EXPECT_GE(static_cast<double>(within), least_share_within * count) << report(judgements, 5);
    EXPECT_LE(static_cast<double>(dishonest), (1.0 - least_share_within) * count) << report(judgements, 5);
}

INSTANTIATE_TEST_SUITE_P(tolerances, RandomPairs, testing::Values(1e-2, 1e-4, 1e-6));

} // namespace
} // namespace kinelux::validation
