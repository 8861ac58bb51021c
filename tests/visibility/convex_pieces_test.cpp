// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/convex_pieces.h"

#include <gtest/gtest.h>

namespace kinelux::visibility {
namespace {

constexpr Vec3 up{0.0, 0.0, 1.0};

double area(const Loops3& loops) {
    double sum = 0.0;
    for (std::size_t l = 0; l < loops.size(); ++l) sum += 0.5 * glm::dot(up, twice_vector_area(loops[l]));
    return sum;
}

TEST(ConvexPieces, a_rectangle_is_one_piece) {
    const std::vector<Vec3> points{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
    const std::vector<model::Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
    const Loops3 pieces = convex_pieces(points, triangles, up);
    ASSERT_EQ(pieces.size(), 1u);
    EXPECT_EQ(pieces[0].size(), 4u);
}

TEST(ConvexPieces, a_frame_is_cut_into_convex_pieces_of_its_area) {
    const std::vector<Vec3> points{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0},
                                   {1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}};
    const std::vector<model::Triangle> triangles{{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5},
                                                 {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    const Loops3 pieces = convex_pieces(points, triangles, up);
    EXPECT_EQ(pieces.size(), 4u);
    EXPECT_NEAR(area(pieces), 8.0, 1e-14);
    for (std::size_t p = 0; p < pieces.size(); ++p) EXPECT_TRUE(is_convex(pieces[p], up, 1e-12));
}

TEST(ConvexPieces, triangles_that_share_no_edge_stay_apart) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    const std::vector<model::Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
    EXPECT_EQ(convex_pieces(points, triangles, up).size(), 2u);
}

} // namespace
} // namespace kinelux::visibility
