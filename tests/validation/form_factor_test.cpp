// SPDX-License-Identifier: GPL-3.0-or-later
// Form factors as the program stores them, against closed forms.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "closed_form_cases.h"
#include "coefficients/whole_patch_factors.h"
#include "support/planar_patches.h"
#include "support/shapes.h"

namespace kinelux::validation {
namespace {

// From group 0 to the group that receives, as kinelux form-factors computes it.
coefficients::FormFactor whole_patch_factor(const ClosedFormCase& item) {
    const auto elements = geometry::element_shapes(item.set, support::whole_patch_elements(item.set), 0, 0);
    const auto occluders = item.open ? visibility::Occluders(std::vector<visibility::Body>())
                                     : support::occluders_of(item.set, support::plain_scene(elements.size()));
    std::vector<std::uint32_t> group_of = item.group_of;
    for (auto e = static_cast<std::uint32_t>(group_of.size()); e < elements.size(); ++e)
        group_of.push_back(e);
    const auto factors = coefficients::whole_patch_factors(
        elements, occluders, {.tolerance = 1e-3, .sight_tolerance = 1e-3, .most_blockers = 100}, group_of,
        *std::max_element(group_of.begin(), group_of.end()) + 1);
    const auto found = std::find_if(factors.begin(), factors.end(), [&](const auto& factor) {
        return factor.from == 0 && factor.to == item.to;
    });
    return found != factors.end() ? *found : coefficients::FormFactor{};
}

TEST(FormFactor, meets_every_closed_form_at_an_accuracy_of_1e_6) {
    for (const ClosedFormCase& item : closed_form_cases())
        EXPECT_NEAR(computed_factor(item, 1e-6) / item.expected, 1.0, item.tolerance) << item.name;
}

TEST(FormFactor, is_within_a_thousandth_at_the_default_accuracy) {
    for (const ClosedFormCase& item : closed_form_cases())
        EXPECT_NEAR(computed_factor(item, 1e-3) / item.expected, 1.0, 1e-3) << item.name;
}

TEST(FormFactor, of_whole_patches_is_off_by_at_most_three_times_its_estimate) {
    constexpr double of_references = 1e-8,
                     of_shadows = 2e-5; // of the forms that are limits or sums over points
    for (const ClosedFormCase& item : closed_form_cases()) {
        const coefficients::FormFactor factor = whole_patch_factor(item);
        const bool shadowed = !item.open && item.set.patches.size() > 2;
        const double slack = (shadowed ? of_shadows : of_references) * item.expected;
        EXPECT_NEAR(factor.value, item.expected, 3.0 * factor.error_estimate + slack) << item.name;
        EXPECT_LE(factor.error_estimate, 2e-3 * item.expected) << item.name;
    }
}

} // namespace
} // namespace kinelux::validation
