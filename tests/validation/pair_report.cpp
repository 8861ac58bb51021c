// SPDX-License-Identifier: GPL-3.0-or-later
// pair_report [--count N] [--seed S] [--tolerance T] [--class NAME] [--degree D] [--worst W] [--recipe HEX]: how far the
// blocks of kernel::transport are from their references, by class of pair. --recipe judges one pair of a class again.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include <fmt/format.h>

#include "core/error.h"
#include "pair_judgement.h"

namespace {

using Options = std::map<std::string, std::string>;

Options parse(int argc, char** argv) {
    Options options{{"--count", "240"}, {"--seed", "1"},  {"--tolerance", "1e-3"}, {"--class", ""},
                    {"--degree", "-1"}, {"--worst", "5"}, {"--recipe", ""}};
    for (int i = 1; i < argc; i += 2) {
        const auto found = options.find(argv[i]);
        if (found == options.end() || i + 1 == argc)
            throw kinelux::core::OptionError(
                fmt::format("{}: expected --count N --seed S --tolerance T --class NAME --degree D --worst W "
                            "--recipe HEX, each with a value",
                            argv[i]));
        found->second = argv[i + 1];
    }
    return options;
}

} // namespace

int main(int argc, char** argv) {
    using namespace kinelux::validation;
    try {
        Options options = parse(argc, argv);
        const double tolerance = std::stod(options["--tolerance"]);
        const int degree = std::stoi(options["--degree"]);
        std::vector<Judgement> judgements;
        if (options["--recipe"].empty()) {
            judgements = judge_series(std::stoull(options["--count"]), std::stoull(options["--seed"]),
                                      tolerance, options["--class"], degree);
        } else {
            PairRecipe recipe{.seed = std::stoull(options["--recipe"], nullptr, 16),
                              .degree = std::max(degree, 0)};
            recipe.kind = class_named(options["--class"]);
            judgements = {judge(recipe, tolerance)};
        }
        fmt::print("{}", report(judgements, std::stoull(options["--worst"])));
    } catch (const std::exception& error) {
        fmt::print(stderr, "pair_report: {}\n", error.what());
        return 2;
    }
    return 0;
}
