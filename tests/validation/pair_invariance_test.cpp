// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <gtest/gtest.h>

#include "kernel/transport.h"
#include "pair_recipes.h"

namespace kinelux::validation {
namespace {

constexpr double tolerance = 1e-3; ///< of the blocks; most pairs get the same rules in any place
constexpr std::uint64_t pairs = 240, seed = 31;
constexpr double most_change = 1e-9; ///< relative

// The share of what leaves one element that reaches the other, times the root of their areas' ratio, and its error.
struct FormFactor {
    double value = 0.0, error = 0.0;
};
FormFactor form_factor(const PairRecipe& recipe, const Placement& placement) {
    static const visibility::Occluders nothing{std::vector<visibility::Body>()};
    const TestPair pair = make_pair(recipe, placement);
    const auto block =
        kernel::transport(pair.a, pair.b, nothing, {.tolerance = tolerance, .occlusion = false});
    return block.values.empty() ? FormFactor{} : FormFactor{block.values[0], block.error};
}

Placement turned() {
    const Vec3 u = glm::normalize(Vec3(0.48, -0.6, 0.64));
    const Vec3 v = glm::normalize(glm::cross(Vec3(0.3, 0.8, -0.5), u));
    return {.axis_u = u, .axis_v = v};
}

// Form factors change by less than `most_change`, or by what coordinates rounded by `rounding` [m] change of the gaps.
// Where rounding changes a choice of rules both results are within their errors; such pairs are counted.
// @return  share of the pairs whose form factor stays [1]
enum class Gaps : std::uint8_t { All, None }; // None: narrow ones, 1e-12 to 1e-1 m, left out
double share_that_stays(const Placement& placement, double rounding, Gaps gaps) {
    std::uint64_t stay = 0, asked = 0;
    for (std::uint64_t index = 0; index < pairs; ++index) {
        const PairRecipe recipe = series_recipe(index, seed);
        if (gaps == Gaps::None && make_pair(recipe, {}).what.find("gap") != std::string::npos) continue;
        ++asked;
        const FormFactor here = form_factor(recipe, {}), there = form_factor(recipe, placement);
        const double change = std::abs(there.value - here.value);
        stay += change <= most_change * here.value + rounding ? 1u : 0u;
        EXPECT_LE(change, here.error + there.error + rounding)
            << pair_class_names[static_cast<std::size_t>(recipe.kind)] << " degree " << recipe.degree
            << " recipe " << std::hex << recipe.seed << ' ' << make_pair(recipe, {}).what;
    }
    return static_cast<double>(stay) / static_cast<double>(asked);
}

TEST(Invariance, turning_leaves_form_factors) {
    EXPECT_GE(share_that_stays(turned(), 1e-12, Gaps::All), 0.9);
}

TEST(Invariance, shifting_by_10_km_leaves_form_factors) {
    Placement placement;
    placement.origin = Vec3(8e3, -5e3, 3e3);
    EXPECT_GE(share_that_stays(placement, 1e-10, Gaps::None), 0.95);
}

TEST(Invariance, scaling_leaves_form_factors) {
    for (const double scale : {1e-3, 1e3}) {
        Placement placement;
        placement.scale = scale;
        EXPECT_GE(share_that_stays(placement, 1e-12, Gaps::All), 0.95);
    }
}

} // namespace
} // namespace kinelux::validation
