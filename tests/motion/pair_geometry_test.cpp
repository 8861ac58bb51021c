// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/pair_geometry.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "kernel/far_pair.h"
#include "support/curved.h"
#include "support/shapes.h"

namespace kinelux::motion {
namespace {

using geometry::ElementShape;

// Squares and pieces of spheres somewhere in a box.
std::vector<ElementShape> scattered_elements(std::mt19937& generator) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-2.0, 2.0);
    model::PatchSet set;
    for (int k = 0; k < 12; ++k)
        set.patches.push_back(support::rectangle(Vec3(0), Vec3(0.8, 0, 0), Vec3(0, 0.5, 0)));
    for (int k = 0; k < 4; ++k)
        set.patches.push_back(support::surface_patch(support::tilted_surface(model::SurfaceType::Sphere),
                                                     Vec2(0.2, -0.3), Vec2(0.9, 0.4)));
    auto shapes = support::shapes_of(set, 1, 1);
    for (ElementShape& shape : shapes) {
        const Quat turn =
            glm::normalize(Quat(normal(generator), normal(generator), normal(generator), normal(generator)));
        shape =
            geometry::moved(shape, {turn, Vec3(uniform(generator), uniform(generator), uniform(generator))});
    }
    return shapes;
}

TEST(PairGeometry, bounds_hold_at_all_nodes_of_random_pairs) {
    std::mt19937 generator(7);
    int facing = 0, apart = 0;
    for (int trial = 0; trial < 20; ++trial) {
        const auto shapes = scattered_elements(generator);
        for (const ElementShape& a : shapes)
            for (const ElementShape& b : shapes) {
                if (&a == &b) continue;
                double nearest = std::numeric_limits<double>::infinity(), smallest = nearest;
                for (const auto& x : a.rules[2].nodes)
                    for (const auto& y : b.rules[2].nodes) {
                        nearest = std::min(nearest, glm::distance(x.position, y.position));
                        smallest = std::min(smallest, kernel::kernel_value(x, y));
                    }
                EXPECT_LE(least_distance(a, b), nearest);
                EXPECT_DOUBLE_EQ(least_distance(a, b), least_distance(b, a));
                EXPECT_TRUE(!wholly_facing(a, b) || smallest > 0.0);
                facing += wholly_facing(a, b) ? 1 : 0;
                apart += least_distance(a, b) > 0.3 * nearest ? 1 : 0;
            }
    }
    EXPECT_GT(facing, 50);
    EXPECT_GT(apart, 2000) << "of 4800";
}

TEST(PairGeometry, neighbours_that_share_an_edge_face_each_other_and_walls_in_one_plane_do_not) {
    model::PatchSet set;
    set.patches = {support::rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)),
                   support::rectangle(Vec3(0), Vec3(0, 1, 0), Vec3(0, 0, 1)),
                   support::rectangle(Vec3(0, 0, -0.5), Vec3(0, 1, 0), Vec3(0, 0, 1))};
    const auto shapes = support::shapes_of(set, 1, 0);
    EXPECT_TRUE(wholly_facing(shapes[0], shapes[1]));
    EXPECT_FALSE(wholly_facing(shapes[0], shapes[2])) << "half of it is behind";
    EXPECT_EQ(least_distance(shapes[0], shapes[1]), 0.0);
}

} // namespace
} // namespace kinelux::motion
