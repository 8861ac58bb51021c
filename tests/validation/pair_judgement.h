// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pair_recipes.h"

namespace kinelux::validation {

/// One block of kernel::transport beside its reference; all norms Frobenius.
struct Judgement {
    PairRecipe recipe;
    std::string what;         ///< TestPair::what
    double tolerance = 0.0;   ///< asked for [1]
    double norm = 0.0;        ///< of the reference [1]
    double error = 0.0;       ///< of the block, over `norm` (absolute where that is 0) [1]
    double estimate = 0.0;    ///< TransportBlock::error, likewise [1]
    double uncertainty = 0.0; ///< of the reference, likewise [1]
    double seconds = 0.0;     ///< of CPU time for the block
    double reference_seconds = 0.0;

    /// The error that is proved, and the one that the estimate has to cover: less what the reference may be off.
    double proved_error() const { return error > uncertainty ? error - uncertainty : 0.0; }
    bool within_tolerance() const { return proved_error() <= tolerance; }
    bool honest() const;
};

/// A reference that is off by less than this share of a tolerance can judge it.
constexpr double judge_share = 0.3;

/// Errors are judged relative to the block, or to this share of the largest block that elements of such areas can have:
/// kernel::TransportOptions::tolerance.
constexpr double negligible_share = 1e-3;

/// @throws OptionError  no class of that name
PairClass class_named(std::string_view name);

/// Computes and judges one pair.
Judgement judge(const PairRecipe& recipe, double tolerance);

/// The first `count` pairs of a series, on all threads. @param kind  name of a class, empty = all in turn
/// @param degree  of all, -1 = the series' own
/// @throws OptionError  no class of that name
std::vector<Judgement> judge_series(std::uint64_t count, std::uint64_t seed, double tolerance,
                                    std::string_view kind, int degree);

/// A table by class and, below it, the pairs with the largest error over tolerance and the least honest estimates.
std::string report(std::span<const Judgement> judgements, std::size_t worst);

} // namespace kinelux::validation
