// SPDX-License-Identifier: GPL-3.0-or-later
#include "curved_pairs.h"

#include <cstdlib>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "core/parallel.h"

namespace kinelux::validation {
namespace {

// The first 56 pairs of a series are all kinds at all places, the first 35 those that are far or near: the references of
// others take minutes at 1e-3.
struct Series {
    double tolerance;
    std::uint64_t seed;
    std::size_t count;
};

std::ostream& operator<<(std::ostream& out, const Series& series) {
    return out << "tolerance_" << series.tolerance << "_seed_" << series.seed;
}
constexpr Series all_series[] = {{1e-2, 1, 56}, {1e-2, 2, 56}, {1e-3, 3, 35}};

// KINELUX_PAIRS=560 judges as many pairs per series; few are enough to notice a change.
std::size_t pairs_asked_for(const Series& series) {
    const char* asked = std::getenv("KINELUX_PAIRS");
    return asked != nullptr ? std::stoull(asked) : series.count;
}

constexpr double least_within = 0.95, least_honest = 0.97, least_judged = 0.8;
constexpr double judge_share = 0.3; ///< of a tolerance that a reference may be off for it

class CurvedPairs : public testing::TestWithParam<Series> {};

TEST_P(CurvedPairs, blocks_keep_the_tolerance_and_their_estimates_are_honest) {
    const auto [tolerance, seed, count] = GetParam();
    std::vector<CurvedJudgement> all(pairs_asked_for(GetParam()));
    core::parallel_for(all.size(), [&, tolerance = tolerance, seed = seed](std::size_t i) {
        all[i] = judge_curved(curved_recipe(i, seed), tolerance);
    });
    double judged = 0.0, within = 0.0, honest = 0.0;
    for (const CurvedJudgement& judgement : all) {
        if (judgement.uncertainty > judge_share * tolerance) continue;
        judged += 1.0;
        within += judgement.proved_error() <= tolerance ? 1.0 : 0.0;
        honest += 3.0 * judgement.estimate >= judgement.proved_error() ? 1.0 : 0.0;
    }
    EXPECT_GE(judged, least_judged * static_cast<double>(all.size())) << curved_report(all, tolerance, 8);
    EXPECT_GE(within, least_within * judged) << curved_report(all, tolerance, 8);
    EXPECT_GE(honest, least_honest * judged) << curved_report(all, tolerance, 8);
}

INSTANTIATE_TEST_SUITE_P(series, CurvedPairs, testing::ValuesIn(all_series));

} // namespace
} // namespace kinelux::validation
