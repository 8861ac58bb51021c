// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <gtest/gtest.h>

#include "kernel/polygon_irradiance.h"
#include "kernel/transport.h"
#include "support/shapes.h"

namespace kinelux::kernel {
namespace {

using support::rectangle;

struct HardCase {
    const char* name;
    model::Patch a, b;
    double lowest, highest; ///< what F_ab must lie between [1]
};

std::vector<HardCase> hard_cases() {
    const model::Patch floor = rectangle(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0));
    return {
        {"coincident, opposite normals", floor, rectangle(Vec3(0), Vec3(0, 1, 0), Vec3(1, 0, 0)), 0.0, 1.0},
        {"facing at a gap of 1e-3", floor, rectangle(Vec3(0, 0, 1e-3), Vec3(0, 1, 0), Vec3(1, 0, 0)), 0.9,
         1.05},
        {"facing at a gap of 1e-6", floor, rectangle(Vec3(0, 0, 1e-6), Vec3(0, 1, 0), Vec3(1, 0, 0)), 0.9,
         1.05},
        {"duplicated", floor, floor, 0.0, 0.0},
        {"reversed neighbour in one plane", floor, rectangle(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 0, 0)),
         0.0, 0.0},
        {"interpenetrating at right angles", floor,
         rectangle(Vec3(0.5, 0, -0.5), Vec3(0, 1, 0), Vec3(0, 0, 1)), 0.0, 0.5},
        {"sliver of 1e-4 along a wall's foot", floor, rectangle(Vec3(0), Vec3(0, 1, 0), Vec3(0, 0, 1e-4)),
         0.0, 1e-4},
        {"1e-6 m in a hall of 100 m", rectangle(Vec3(0), Vec3(1e-6, 0, 0), Vec3(0, 1e-6, 0)),
         rectangle(Vec3(-50, -50, 100), Vec3(0, 100, 0), Vec3(100, 0, 0)), 0.239, 0.240},
        {"edge on the other's horizon", floor, rectangle(Vec3(2, 0, 0), Vec3(0, 0, 1), Vec3(0, 1, 0)), 0.0,
         0.1},
        {"touching in one vertex", floor, rectangle(Vec3(1, 1, 0), Vec3(0, 0, 1), Vec3(0, 1, 0)), 0.0, 0.1},
    };
}

// Every case as it is, turned, scaled to millimetres and to kilometres, and far from the origin.
std::vector<geometry::Pose> placements() {
    return {{},
            {glm::normalize(Quat(0.3, 0.5, -0.2, 0.7)), Vec3(0.0)},
            {glm::normalize(Quat(0.9, 0.1, 0.3, 0.2)), Vec3(1e4, -2e4, 3e4)}};
}

model::Patch placed(model::Patch patch, const geometry::Pose& pose, double scale) {
    patch.surface.origin = pose.point(scale * patch.surface.origin);
    patch.surface.axis_u = pose.direction(patch.surface.axis_u);
    patch.surface.axis_v = pose.direction(patch.surface.axis_v);
    patch.surface.axis_w = pose.direction(patch.surface.axis_w);
    for (Vec2& point : patch.points) point *= scale;
    return patch;
}

class KernelHardCases : public ::testing::TestWithParam<int> {};

TEST_P(KernelHardCases, stay_finite_non_negative_and_bounded) {
    const int degree = GetParam();
    for (const HardCase& hard : hard_cases())
        for (const geometry::Pose& pose : placements())
            for (const double scale : {1.0, 1e-3, 1e3}) {
                model::PatchSet set;
                set.patches = {placed(hard.a, pose, scale), placed(hard.b, pose, scale)};
                const auto shapes = support::shapes_of(set, 1, degree);
                const auto occluders = support::occluders_of(set, support::plain_scene(1));
                const auto block = transport(shapes[0], shapes[1], occluders, {.occlusion = false});
                for (const double value : block.values) ASSERT_TRUE(std::isfinite(value)) << hard.name;
                ASSERT_TRUE(std::isfinite(block.error)) << hard.name;
                const double factor =
                    block.values.empty() ? 0.0 : block.values[0] * std::sqrt(shapes[1].area / shapes[0].area);
                EXPECT_GE(factor, hard.lowest) << hard.name << " scale " << scale;
                EXPECT_LE(factor, hard.highest) << hard.name << " scale " << scale;
            }
}

INSTANTIATE_TEST_SUITE_P(Degrees, KernelHardCases, ::testing::Values(0, 2, 6));

TEST(PolygonIrradianceHardCases, points_in_the_plane_on_edges_and_on_vertices_give_a_number) {
    const std::vector<Vec3> polygon{Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1, 1, 1), Vec3(1, 0, 1)};
    for (const Vec3& x :
         {Vec3(0.5, 0.5, 1), Vec3(0, 0.5, 1), Vec3(0, 0, 1), Vec3(2, 2, 1), Vec3(0.5, 0.5, 1 - 1e-12)})
        for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0)}) {
            const double factor = point_to_polygon(x, normal, polygon);
            EXPECT_TRUE(factor >= 0.0 && factor <= 1.0);
        }
    EXPECT_NEAR(point_to_polygon(Vec3(0.5, 0.5, 1 - 1e-12), Vec3(0, 0, 1), polygon), 1.0, 1e-9)
        << "in contact";
}

} // namespace
} // namespace kinelux::kernel
