// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/exported.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/sequence.h"

namespace kinelux::reference {
namespace {

/// A level grid of n x n squares over [0,1]^2 at height z; the field is 2 x + 3 y + z in both components.
struct Grid {
    std::vector<Vec3> points;
    std::vector<model::Triangle> triangles;
    std::vector<std::uint32_t> objects;
    std::vector<float> values;

    void add(std::uint32_t n, double z, std::uint32_t object, bool up) {
        const auto first = static_cast<std::uint32_t>(points.size());
        for (std::uint32_t j = 0; j <= n; ++j)
            for (std::uint32_t i = 0; i <= n; ++i) {
                points.push_back({double(i) / n, double(j) / n, z});
                for (int c = 0; c < 2; ++c)
                    values.push_back(static_cast<float>(2.0 * i / n + 3.0 * j / n + z));
            }
        for (std::uint32_t j = 0; j < n; ++j)
            for (std::uint32_t i = 0; i < n; ++i) {
                const std::uint32_t a = first + j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
                triangles.push_back(up ? model::Triangle{a, b, c} : model::Triangle{a, c, b});
                triangles.push_back(up ? model::Triangle{a, c, d} : model::Triangle{a, d, c});
                objects.insert(objects.end(), 2, object);
            }
    }
    ExportedField field() const { return {points, triangles, objects, values, 2}; }
};

TEST(ValuesAt, a_linear_field_is_reproduced) {
    Grid grid;
    grid.add(13, 0.0, 0, true);
    core::Random random(3);
    std::vector<SensorPoint> sensors;
    sensors.reserve(500);
    for (int i = 0; i < 500; ++i)
        sensors.push_back({ObjectId(0), 0, Vec3(random.next_2d(), 1e-3), Vec3(0, 0, 1)});
    const auto values = values_at(grid.field(), sensors, {});
    for (std::size_t i = 0; i < sensors.size(); ++i) {
        ASSERT_TRUE(values[i]);
        const double truth = 2.0 * sensors[i].position.x + 3.0 * sensors[i].position.y;
        EXPECT_NEAR((*values[i])[0], truth, 1e-5);
        EXPECT_NEAR((*values[i])[1], truth, 1e-5);
    }
}

TEST(ValuesAt, only_triangles_of_the_same_object_that_face_the_same_way_count) {
    Grid grid;
    grid.add(4, 0.0, 0, true);
    grid.add(4, 0.0, 0, false); // the other side of a sheet
    grid.add(4, 0.001, 1, true);
    for (std::size_t i = 2 * 25; i < 4 * 25; ++i) grid.values[i] += 100.0f;
    const std::vector<SensorPoint> sensors{{ObjectId(0), 0, {0.3, 0.6, 0.001}, {0, 0, 1}},
                                           {ObjectId(0), 0, {0.3, 0.6, 0.001}, {0, 0, -1}},
                                           {ObjectId(1), 0, {0.3, 0.6, 0.0}, {0, 0, 1}},
                                           {ObjectId(1), 0, {0.3, 0.6, 0.0}, {0, 0, -1}},
                                           {ObjectId(2), 0, {0.3, 0.6, 0.0}, {0, 0, 1}}};
    const auto values = values_at(grid.field(), sensors, {});
    EXPECT_NEAR(values[0].value()[0], 2.4, 1e-5);
    EXPECT_NEAR(values[1].value()[0], 102.4, 1e-4);
    EXPECT_NEAR(values[2].value()[0], 2.401, 1e-5);
    EXPECT_FALSE(values[3]);
    EXPECT_FALSE(values[4]);
}

TEST(ValuesAt, sensors_beyond_the_tolerance_get_nothing) {
    Grid grid;
    grid.add(4, 0.0, 0, true);
    const double reach = 0.01 * std::sqrt(2.0);
    const std::vector<SensorPoint> sensors{{ObjectId(0), 0, {1.0 + 0.9 * reach, 0.5, 0.0}, {0, 0, 1}},
                                           {ObjectId(0), 0, {1.0 + 1.1 * reach, 0.5, 0.0}, {0, 0, 1}}};
    const auto values = values_at(grid.field(), sensors, {});
    EXPECT_NEAR(values[0].value()[0], 3.5, 1e-5);
    EXPECT_FALSE(values[1]);
}

TEST(ValuesAt, sizes_that_do_not_fit_are_refused) {
    Grid grid;
    grid.add(2, 0.0, 0, true);
    grid.values.pop_back();
    EXPECT_THROW(values_at(grid.field(), {}, {}), core::GeometryError);
    const Grid nothing;
    EXPECT_FALSE(values_at(nothing.field(), std::vector<SensorPoint>(1), {})[0]);
}

} // namespace
} // namespace kinelux::reference
