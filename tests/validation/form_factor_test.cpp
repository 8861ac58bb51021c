// SPDX-License-Identifier: GPL-3.0-or-later
// Form factors as the program stores them, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "closed_form_cases.h"

namespace kinelux::validation {
namespace {

TEST(FormFactor, meets_every_closed_form_at_an_accuracy_of_1e_6) {
    for (const ClosedFormCase& item : closed_form_cases())
        EXPECT_NEAR(computed_factor(item, 1e-6) / item.expected, 1.0, item.tolerance) << item.name;
}

TEST(FormFactor, is_within_a_thousandth_at_the_default_accuracy) {
    for (const ClosedFormCase& item : closed_form_cases())
        EXPECT_NEAR(computed_factor(item, 1e-3) / item.expected, 1.0, 1e-3) << item.name;
}

} // namespace
} // namespace kinelux::validation
