// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/coefficients.h"

#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"

namespace kinelux::model {

namespace {

/// Three elements with 3, 1 and 1 unknowns, all their blocks stored.
Coefficients whole() {
    Coefficients coefficients;
    coefficients.layout.offsets = {0, 3, 4, 5};
    coefficients.static_blocks.entries = {{0, 1, 0, 0.1f}, {0, 2, 3, 0.1f}, {1, 2, 6, 0.0f}};
    coefficients.static_blocks.values.assign(7, 0.5f);
    coefficients.moving_pairs = {{0, 1}};
    coefficients.crossed_pairs = {{1, 2}, {2, 2}};
    return coefficients;
}

} // namespace

TEST(CheckCoefficients, whole_and_empty_ones_pass) {
    EXPECT_NO_THROW(check(whole()));
    EXPECT_NO_THROW(check(Coefficients{}));
}

TEST(CheckCoefficients, layout_counts_up_from_zero) {
    Coefficients broken = whole();
    broken.layout.offsets = {1, 3, 4, 5};
    EXPECT_THROW(check(broken), core::GeometryError);
    broken.layout.offsets = {0, 4, 3, 5};
    EXPECT_THROW(check(broken), core::GeometryError);
}

TEST(CheckCoefficients, blocks_are_sorted_and_each_pair_is_there_once) {
    Coefficients broken = whole();
    std::swap(broken.static_blocks.entries[0], broken.static_blocks.entries[1]);
    EXPECT_THROW(check(broken), core::GeometryError);
    broken = whole();
    broken.static_blocks.entries[1] = broken.static_blocks.entries[0];
    EXPECT_THROW(check(broken), core::GeometryError);
}

TEST(CheckCoefficients, blocks_and_pairs_are_of_elements_that_exist) {
    for (const ElementPair pair : {ElementPair{0, 3}, ElementPair{2, 1}}) {
        Coefficients broken = whole();
        broken.static_blocks.entries[2].i = pair.i;
        broken.static_blocks.entries[2].j = pair.j;
        EXPECT_THROW(check(broken), core::GeometryError);
        broken = whole();
        broken.moving_pairs[0] = pair;
        EXPECT_THROW(check(broken), core::GeometryError);
        broken = whole();
        broken.crossed_pairs[0] = pair;
        EXPECT_THROW(check(broken), core::GeometryError);
    }
}

TEST(CheckCoefficients, blocks_end_within_the_values) {
    Coefficients broken = whole();
    broken.static_blocks.values.pop_back();
    EXPECT_THROW(check(broken), core::GeometryError);
    broken = whole();
    broken.static_blocks.entries[0].offset = std::numeric_limits<std::uint64_t>::max();
    EXPECT_THROW(check(broken), core::GeometryError);
}

TEST(CheckCoefficients, values_and_errors_are_finite) {
    Coefficients broken = whole();
    broken.static_blocks.values[3] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(check(broken), core::GeometryError);
    broken = whole();
    broken.static_blocks.entries[0].error = std::numeric_limits<float>::infinity();
    EXPECT_THROW(check(broken), core::GeometryError);
}

} // namespace kinelux::model
