// SPDX-License-Identifier: GPL-3.0-or-later
#include "pair_judgement.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include <fmt/format.h>

#include "core/error.h"
#include "core/parallel.h"
#include "kernel/transport.h"
#include "support/pair_reference.h"

namespace kinelux::validation {

namespace {

constexpr double honest_share = 1.0 / 3.0; ///< of the true error that the estimate must reach
constexpr double rounding = 1e-12;         ///< errors below it are not asked about

// What the reference's cells may be off for a block of a tolerance at first. Many of them add up to one block, the more
// the finer it has to be.
double cell_tolerance(double tolerance) {
    constexpr double share = 0.1, few_cells = 1e-3;
    return share * tolerance * std::min(1.0, std::sqrt(tolerance / few_cells));
}

// CPU time of this thread: what else the machine does does not count.
double cpu_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double difference(std::span<const double> block, std::span<const double> reference) {
    double sum = 0.0;
    for (std::size_t k = 0; k < reference.size(); ++k) {
        const double value = block.empty() ? 0.0 : block[k];
        sum += (value - reference[k]) * (value - reference[k]);
    }
    return std::sqrt(sum);
}

double quantile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

std::string class_row(std::string_view name, std::span<const Judgement* const> rows) {
    std::vector<double> ratios, pessimism;
    std::size_t within = 0, honest = 0, judged = 0;
    double seconds = 0.0, reference_seconds = 0.0, uncertainty = 0.0;
    for (const Judgement* row : rows) {
        ratios.push_back(row->error / row->tolerance);
        pessimism.push_back(row->estimate / std::max(row->error, rounding));
        within += row->within_tolerance() ? 1u : 0u;
        honest += row->honest() ? 1u : 0u;
        judged += row->uncertainty <= row->tolerance * judge_share ? 1u : 0u;
        seconds += row->seconds;
        reference_seconds += row->reference_seconds;
        uncertainty = std::max(uncertainty, row->uncertainty);
    }
    const double n = static_cast<double>(rows.size());
    return fmt::format("{:<10} {:>6} {:>7.2f} {:>7.2f} {:>9.2e} {:>9.2e} {:>9.2e} {:>9.2e} {:>9.3f} {:>9.1e} "
                       "{:>6} {:>8.1f}\n",
                       name, rows.size(), 100.0 * static_cast<double>(within) / n,
                       100.0 * static_cast<double>(honest) / n, quantile(ratios, 0.5), quantile(ratios, 0.95),
                       quantile(ratios, 1.0), quantile(pessimism, 0.5), 1e3 * seconds / n, uncertainty,
                       rows.size() - judged, 1e3 * reference_seconds / n);
}

template <class Badness>
std::string worst_rows(std::span<const Judgement> judgements, std::size_t count, const Badness& badness) {
    std::vector<const Judgement*> rows;
    for (const Judgement& judgement : judgements) rows.push_back(&judgement);
    count = std::min(count, rows.size());
    std::partial_sort(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(count), rows.end(),
                      [&](auto* a, auto* b) { return badness(*a) > badness(*b); });
    std::string text;
    for (std::size_t r = 0; r < count; ++r)
        text += fmt::format("  {:<9} degree {} recipe {:#018x}: error {:.2e} estimate {:.2e} norm {:.3e} "
                            "reference +-{:.0e}; {}\n",
                            pair_class_names[static_cast<std::size_t>(rows[r]->recipe.kind)],
                            rows[r]->recipe.degree, rows[r]->recipe.seed, rows[r]->error, rows[r]->estimate,
                            rows[r]->norm, rows[r]->uncertainty, rows[r]->what);
    return text;
}

} // namespace

PairClass class_named(std::string_view name) {
    const auto found = std::find(pair_class_names.begin(), pair_class_names.end(), name);
    if (found == pair_class_names.end())
        throw core::OptionError(fmt::format("--class {}: one of {}", name, fmt::join(pair_class_names, " ")));
    return static_cast<PairClass>(found - pair_class_names.begin());
}

bool Judgement::honest() const {
    return proved_error() <= rounding || estimate >= honest_share * proved_error();
}

Judgement judge(const PairRecipe& recipe, double tolerance) {
    static const visibility::Occluders nothing{std::vector<visibility::Body>()};
    const TestPair pair = make_pair(recipe);
    Judgement judgement{.recipe = recipe, .what = pair.what, .tolerance = tolerance};
    double start = cpu_seconds();
    const auto block =
        kernel::transport(pair.a, pair.b, nothing, {.tolerance = tolerance, .occlusion = false});
    judgement.seconds = cpu_seconds() - start;
    start = cpu_seconds();
    const double largest = std::sqrt(std::min(pair.a.area, pair.b.area) / std::max(pair.a.area, pair.b.area));
    support::PairReference reference;
    double scale = 0.0;
    constexpr double finer = 0.03, finest = 1e-8;
    for (double cell = cell_tolerance(tolerance);; cell *= finer) {
        reference = support::pair_reference(pair.a, pair.b, std::max(cell, finest));
        scale = 1.0 / std::max(reference.norm, negligible_share * largest);
        if (cell <= finest || scale * reference.disagreement <= judge_share * tolerance) break;
    }
    judgement.reference_seconds = cpu_seconds() - start;
    judgement.norm = reference.norm;
    judgement.error = scale * difference(block.values, reference.values);
    judgement.estimate = scale * block.error;
    judgement.uncertainty = scale * reference.disagreement;
    return judgement;
}

std::vector<Judgement> judge_series(std::uint64_t count, std::uint64_t seed, double tolerance,
                                    std::string_view kind, int degree) {
    std::vector<PairRecipe> recipes;
    for (std::uint64_t index = 0; index < count; ++index) {
        recipes.push_back(series_recipe(index, seed));
        if (!kind.empty()) recipes.back().kind = class_named(kind);
        if (degree >= 0) recipes.back().degree = degree;
    }
    std::vector<Judgement> judgements(recipes.size());
    core::parallel_for(recipes.size(), [&](std::size_t i) { judgements[i] = judge(recipes[i], tolerance); });
    return judgements;
}

std::string report(std::span<const Judgement> judgements, std::size_t worst) {
    std::string text =
        fmt::format("{:<10} {:>6} {:>7} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>6} {:>8}\n", "class",
                    "pairs", "within%", "honest%", "err/tol50", "err/tol95", "err/tolmax", "est/err50",
                    "ms/block", "ref.max", "unsure", "ms/ref");
    std::vector<const Judgement*> all;
    for (std::size_t kind = 0; kind < pair_class_names.size(); ++kind) {
        std::vector<const Judgement*> rows;
        for (const Judgement& judgement : judgements)
            if (static_cast<std::size_t>(judgement.recipe.kind) == kind) rows.push_back(&judgement);
        if (!rows.empty()) text += class_row(pair_class_names[kind], rows);
        all.insert(all.end(), rows.begin(), rows.end());
    }
    if (all.empty()) return text;
    text += class_row("all", all);
    if (worst == 0) return text;
    text += "largest errors\n" + worst_rows(judgements, worst, [](const Judgement& j) { return j.error; });
    text += "least honest estimates\n" + worst_rows(judgements, worst, [](const Judgement& j) {
                return j.honest() ? 0.0 : j.proved_error() / std::max(j.estimate, rounding);
            });
    text += "least certain references\n" +
            worst_rows(judgements, worst, [](const Judgement& j) { return j.uncertainty; });
    return text;
}

} // namespace kinelux::validation
