// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "reference/reference.h"

namespace kinelux::reference {
namespace {

TEST(Compare, figures_are_what_their_names_say) {
    const std::vector<SensorReading> reference{{{3.0, 1.0}, {0.3, 0.0}}, {{4.0, 0.0}, {0.4, 0.0}}};
    const std::vector<std::vector<double>> values{{3.5, 1.0}, {3.5, 1.0}};
    const Comparison result = compare(reference, values);
    EXPECT_EQ(result.points, 2u);
    EXPECT_DOUBLE_EQ(result.relative_rms, std::sqrt(1.5 / 26.0));
    EXPECT_DOUBLE_EQ(result.relative_to_mean, std::sqrt(1.5 / 4.0) / 2.0);
    EXPECT_DOUBLE_EQ(result.reference_noise, std::sqrt(0.25 / 26.0));
    EXPECT_DOUBLE_EQ(result.bias, 0.125);
}

TEST(Compare, points_without_a_value_are_counted_apart) {
    const std::vector<SensorReading> reference{{{2.0}, {0.0}}, {{4.0}, {0.0}}};
    const std::vector<std::optional<std::vector<double>>> values{std::vector<double>{1.0}, std::nullopt};
    const Comparison result = compare(reference, values);
    EXPECT_EQ(result.points, 1u);
    EXPECT_EQ(result.unmatched, 1u);
    EXPECT_DOUBLE_EQ(result.relative_rms, 0.5);
}

TEST(Compare, sizes_that_do_not_fit_are_refused) {
    const std::vector<SensorReading> reference{{{2.0}, {0.0}}};
    EXPECT_THROW(compare(reference, std::vector<std::vector<double>>{}), core::GeometryError);
    EXPECT_THROW(compare(reference, std::vector<std::vector<double>>{{1.0, 2.0}}), core::GeometryError);
}

TEST(Compare, a_dark_scene_has_no_relative_error) {
    const std::vector<SensorReading> reference{{{0.0}, {0.0}}};
    EXPECT_EQ(compare(reference, std::vector<std::vector<double>>{{0.0}}).relative_rms, 0.0);
}

} // namespace
} // namespace kinelux::reference
