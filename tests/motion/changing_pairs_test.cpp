// SPDX-License-Identifier: GPL-3.0-or-later
// Every way in which a moving body changes what passes between two elements, against the scene built anew.
#include "motion/changing_pairs.h"

#include <gtest/gtest.h>

#include "geometry/surface.h"
#include "support/moving_rooms.h"

namespace kinelux::motion {
namespace {

using support::MovingRoom;
using support::PreparedRoom;

// The same room with everything at rest where it is in a frame.
MovingRoom frozen(const MovingRoom& room, std::uint32_t frame) {
    MovingRoom still = room;
    const auto poses = geometry::object_poses(room.scene, room.scene.time.time_of_frame(frame));
    for (model::Patch& patch : still.set.patches)
        patch.surface = geometry::moved(patch.surface, poses[patch.object.value]);
    for (model::Object& object : still.scene.objects) object.motion.reset();
    still.scene.motions.clear();
    still.plan.moving_objects.clear();
    return still;
}

// All blocks of all frames as G x for a fixed x.
void expect_as_built_anew(MovingRoom made) {
    PreparedRoom room(std::move(made));
    ExactEngine engine(room.coefficients, room.shapes, room.room.plan, room.occluders, room.room.options);
    solve::BlockOperator moving(room.coefficients.layout, room.coefficients.static_blocks);
    std::vector<double> x(room.coefficients.layout.unknowns()), y(x.size()), expected(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = 1.5 + std::sin(static_cast<double>(k));
    for (const std::uint32_t frame : room.all_frames()) {
        const FrameBlocks blocks = engine.advance(room.time(frame), room.poses(frame));
        moving.replace(blocks.pairs, blocks.blocks);
        solve::apply(moving, 1, x, y);
        const PreparedRoom still(frozen(room.room, frame));
        const solve::BlockOperator anew(still.coefficients.layout, still.coefficients.static_blocks);
        solve::apply(anew, 1, x, expected);
        double off = 0.0, size = 0.0;
        for (std::size_t k = 0; k < x.size(); ++k) {
            off += (y[k] - expected[k]) * (y[k] - expected[k]);
            size += expected[k] * expected[k];
        }
        // Quadrature is planned anew, and turns by rounding.
        EXPECT_LE(std::sqrt(off / size), 1e-4) << "frame " << frame;
    }
}

TEST(ChangingPairs, at_rest_that_a_mover_crosses_equal_a_scene_built_anew) {
    MovingRoom room(4);
    const ObjectId panel = room.body("panel");
    room.panel(panel, Vec3(0.1, 0.6, 1.1), Vec3(0.7, 0, 0), Vec3(0, 0.8, 0));
    room.slide(panel, Vec3(1.1, 0.0, 0.0));
    expect_as_built_anew(std::move(room));
}

ChangingPairs changing_of(PreparedRoom& prepared) {
    return {prepared.coefficients, prepared.shapes, prepared.room.plan, prepared.occluders,
            prepared.room.options};
}

TEST(ChangingPairs, that_a_thin_mover_crosses_are_not_missed) {
    MovingRoom room(3);
    const ObjectId rod = room.body("rod");
    room.panel(rod, Vec3(0.9, 0.013, 1.0), Vec3(0.01, 0, 0), Vec3(0, 1.97, 0));
    room.slide(rod, Vec3(0.037, 0.0, 0.0));
    PreparedRoom prepared(std::move(room));
    ChangingPairs changing = changing_of(prepared);
    changing.set_poses(prepared.poses(1));
    std::size_t shaded = 0;
    for (std::size_t k = 0; k < changing.pairs().size(); ++k)
        shaded += !changing.in_relative_motion(k) && changing.change(k) == Change::Shaded ? 1 : 0;
    EXPECT_GT(shaded, 10u); // floor to ceiling alone: four elements each
}

TEST(ChangingPairs, glimpses_follow_the_constants_of_their_blocks) {
    PreparedRoom prepared(support::sliding_panel(5));
    ChangingPairs changing = changing_of(prepared);
    std::vector<double> before(changing.pairs().size(), 0.0), glimpsed = before;
    double off = 0.0, size = 0.0;
    for (std::uint32_t frame = 0; frame < 5; ++frame) {
        changing.set_poses(prepared.poses(frame));
        for (std::size_t k = 0; k < changing.pairs().size(); ++k) {
            if (changing.change(k) != Change::Shaded) continue;
            const kernel::TransportBlock block = changing.block(k, Change::Shaded);
            const double now = block.values.empty() ? 0.0 : block.values[0];
            const Glimpse glimpse = changing.glimpse(k);
            EXPECT_LE(glimpse.visible, glimpse.whole);
            const double change = now - before[k], seen = glimpse.visible - glimpsed[k];
            off += (change - seen) * (change - seen);
            size += change * change;
            before[k] = now;
            glimpsed[k] = glimpse.visible;
        }
    }
    EXPECT_GT(size, 0.0);
    EXPECT_LT(std::sqrt(off / size), 0.6); // coarse: without a glimpse it is 1
}

TEST(ChangingPairs, that_move_further_than_they_are_apart_are_near) {
    MovingRoom room(3);
    const ObjectId panel = room.body("panel");
    room.panel(panel, Vec3(0.1, 0.6, 0.01), Vec3(0.5, 0, 0), Vec3(0, 0.5, 0));
    room.slide(panel, Vec3(1.0, 0.0, 0.0));
    PreparedRoom prepared(std::move(room));
    ChangingPairs changing = changing_of(prepared);
    changing.set_poses(prepared.poses(1));
    const auto near = [&](double step_m) {
        std::size_t count = 0;
        for (std::size_t k = 0; k < changing.pairs().size(); ++k)
            count += changing.change(k, step_m) == Change::Near ? 1 : 0;
        return count;
    };
    EXPECT_EQ(near(0.0), 0u);
    EXPECT_EQ(near(0.009), 0u);
    EXPECT_EQ(near(0.011), 9u); // above one, two, two and four elements of the floor
}

TEST(ChangingPairs, of_a_mover_and_a_wall_behind_a_shelf_equal_a_scene_built_anew) {
    MovingRoom room(3);
    const ObjectId lamp = room.body("lamp"), shelf = room.body("shelf");
    room.side(lamp, Vec3(0.2, 0.8, 1.7), Vec3(0, 0.4, 0), Vec3(0.4, 0, 0), true);
    room.panel(shelf, Vec3(0.6, 0.5, 1.0), Vec3(0.8, 0, 0), Vec3(0, 1, 0));
    room.slide(lamp, Vec3(1.1, 0.0, 0.0));
    expect_as_built_anew(std::move(room));
}

TEST(ChangingPairs, of_two_movers_that_a_third_parts_equal_a_scene_built_anew) {
    MovingRoom room(3);
    const ObjectId lamp = room.body("lamp"), table = room.body("table"), panel = room.body("panel");
    room.side(lamp, Vec3(0.2, 0.8, 1.7), Vec3(0, 0.4, 0), Vec3(0.4, 0, 0), true);
    room.side(table, Vec3(0.9, 0.7, 0.4), Vec3(0.6, 0, 0), Vec3(0, 0.6, 0));
    room.panel(panel, Vec3(0.1, 0.6, 1.1), Vec3(0.6, 0, 0), Vec3(0, 0.7, 0));
    room.slide(lamp, Vec3(1.1, 0.0, 0.0));
    room.slide(table, Vec3(-0.5, 0.1, 0.0));
    room.turn(panel, Vec3(1, 0, 0), 90.0, Vec3(0.4, 0.95, 1.1));
    expect_as_built_anew(std::move(room));
}

// Two plates of one body that face each other across a gap.
void add_jaws(MovingRoom& room, ObjectId object) {
    room.side(object, Vec3(0.2, 0.5, 0.5), Vec3(0, 0.6, 0), Vec3(0, 0, 0.6));
    room.side(object, Vec3(0.8, 0.5, 0.5), Vec3(0, 0, 0.6), Vec3(0, 0.6, 0));
}

TEST(ChangingPairs, on_one_body_that_goes_round_a_post_at_rest_equal_a_scene_built_anew) {
    MovingRoom room(4);
    const ObjectId jaws = room.body("jaws"), post = room.body("post");
    add_jaws(room, jaws);
    room.panel(post, Vec3(1.2, 0.4, 0.1), Vec3(0, 0.5, 0), Vec3(0, 0, 0.8));
    room.slide(jaws, Vec3(0.9, 0.0, 0.0));
    expect_as_built_anew(std::move(room));
}

TEST(ChangingPairs, on_one_body_that_another_mover_enters_or_starts_in_equal_a_scene_built_anew) {
    for (const bool starts_inside : {false, true}) {
        MovingRoom room(3);
        const ObjectId jaws = room.body("jaws"), blade = room.body("blade");
        add_jaws(room, jaws);
        const double x = starts_inside ? 0.5 : 1.5;
        room.panel(blade, Vec3(x, 0.4, 0.4), Vec3(0, 0.4, 0), Vec3(0, 0, 0.8));
        room.slide(jaws, Vec3(0.3, 0.1, 0.0));
        room.slide(blade, Vec3(starts_inside ? 1.2 : -0.7, 0.0, 0.0));
        expect_as_built_anew(std::move(room));
    }
}

TEST(ChangingPairs, on_one_body_of_two_objects_keep_their_static_blocks) {
    MovingRoom room(3);
    const ObjectId left = room.body("left"), right = room.body("right");
    room.side(left, Vec3(0.2, 0.5, 0.5), Vec3(0, 0.6, 0), Vec3(0, 0, 0.6));
    room.side(right, Vec3(0.8, 0.5, 0.5), Vec3(0, 0, 0.6), Vec3(0, 0.6, 0));
    room.move({left, right},
              {{0.0, Vec3(0.0), Quat(1, 0, 0, 0)}, {1.0, Vec3(0.9, 0.0, 0.0), Quat(1, 0, 0, 0)}});
    const PreparedRoom prepared(room);
    for (const auto& pair : prepared.coefficients.moving_pairs)
        EXPECT_FALSE(prepared.shapes[pair.i].object == left && prepared.shapes[pair.j].object == right);
    expect_as_built_anew(std::move(room));
}

} // namespace
} // namespace kinelux::motion
