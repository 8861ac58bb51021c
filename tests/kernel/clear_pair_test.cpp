// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/clear_pair.h"

#include <cmath>

#include <gtest/gtest.h>

#include "kernel/polygon_form_factor.h"
#include "kernel/transport.h"
#include "support/shapes.h"

namespace kinelux::kernel {
namespace {

std::vector<geometry::ElementShape> floor_and(const model::Patch& other, int degree) {
    model::PatchSet set;
    set.patches = {support::rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)), other};
    return support::shapes_of(set, 1, degree);
}

const visibility::Occluders nothing{{}};

TEST(ClearPair, far_blocks_of_all_degrees_are_those_of_transport) {
    for (int degree = 0; degree <= 3; ++degree)
        for (const double gap : {2.5, 6.0, 30.0})
            for (const double tolerance : {1e-2, 1e-4}) {
                const auto shapes =
                    floor_and(support::rectangle({0.3, 0.2, gap}, {0.1, 0.9, 0.2}, {0.9, -0.1, 0.0}), degree);
                std::vector<double> values(shapes[0].basis.size() * shapes[1].basis.size());
                const auto error = clear_far_block(FlatEnd(shapes[0]), FlatEnd(shapes[1]), tolerance, values);
                if (!error) continue;
                const auto block =
                    transport(shapes[0], shapes[1], nothing, {.tolerance = tolerance, .occlusion = false});
                ASSERT_EQ(block.values.size(), values.size());
                for (std::size_t k = 0; k < values.size(); ++k)
                    EXPECT_NEAR(values[k], block.values[k], 1e-14 + 1e-12 * std::abs(block.values[0]));
            }
}

TEST(ClearPair, close_elements_have_no_far_block) {
    const auto shapes = floor_and(support::rectangle({0, 0, 0.5}, {0, 1, 0}, {1, 0, 0}), 0);
    std::vector<double> values(1);
    EXPECT_FALSE(clear_far_block(FlatEnd(shapes[0]), FlatEnd(shapes[1]), 1e-3, values));
}

TEST(ClearPair, near_blocks_of_constants_keep_their_tolerance) {
    const std::vector<model::Patch> others{
        support::rectangle({0, 0, 0.5}, {0, 1, 0}, {1, 0, 0}),      // facing
        support::rectangle({0, 0, 1e-3}, {0, 1, 0}, {1, 0, 0}),     // narrow gap
        support::rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, 1}),        // common edge
        support::rectangle({0, 0, 0}, {0, 1, 0}, {-0.9, 0, 0.1}),   // open hinge
        support::rectangle({0, 0, -0.5}, {0, 1, 0}, {0, 0, 1}),     // across the horizon
        support::rectangle({2.0, 3.0, 0.4}, {0, 1, 0}, {0.3, 0, 1}) // apart
    };
    for (const model::Patch& other : others) {
        const auto shapes = floor_and(other, 0);
        const double exact = polygon_form_factor(shapes[0].outline, shapes[1].outline).value;
        for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-6}) {
            double value = 0.0;
            const auto error = clear_near_block(shapes[0], shapes[1], tolerance, value);
            ASSERT_TRUE(error);
            EXPECT_NEAR(value, exact * std::sqrt(shapes[0].area / shapes[1].area), tolerance * exact);
        }
    }
}

} // namespace
} // namespace kinelux::kernel
