// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/paper_engine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/error.h"
#include "core/parallel.h"
#include "motion/lamp_room.h"
#include "motion/pair_geometry.h"
#include "motion/posed_elements.h"
#include "solve/solve.h"

namespace kinelux::motion {
namespace {

using geometry::ElementShape;
using Shelf = LampRoom::Shelf;

constexpr std::uint32_t frames = 12; ///< of 41: steps of 1/40 of a motion

struct Block {
    std::vector<double> values;
    double error = 0.0;
};

std::map<model::ElementPair, Block> blocks_of(const FrameBlocks& frame) {
    std::map<model::ElementPair, Block> blocks;
    for (const model::ElementPair& pair : frame.pairs) blocks[pair] = {};
    const auto& entries = frame.blocks.entries;
    for (std::size_t k = 0; k < entries.size(); ++k) {
        const std::size_t end = k + 1 < entries.size() ? entries[k + 1].offset : frame.blocks.values.size();
        const auto first = frame.blocks.values.begin();
        blocks[{entries[k].i, entries[k].j}] = {{first + static_cast<std::ptrdiff_t>(entries[k].offset),
                                                 first + static_cast<std::ptrdiff_t>(end)},
                                                static_cast<double>(entries[k].error)};
    }
    return blocks;
}

// A moving pair without a block is zero, whether it is listed or not.
void list_alike(std::map<model::ElementPair, Block>& a, std::map<model::ElementPair, Block>& b) {
    for (const auto& [pair, block] : a) b.try_emplace(pair);
    for (const auto& [pair, block] : b) a.try_emplace(pair);
}

double norm(const std::vector<double>& values) {
    return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0));
}

double difference(const Block& a, const Block& b) {
    std::vector<double> values = a.values;
    values.resize(std::max(a.values.size(), b.values.size()));
    for (std::size_t v = 0; v < b.values.size(); ++v) values[v] -= b.values[v];
    return norm(values);
}

void expect_same_bytes(const FrameBlocks& a, const FrameBlocks& b) {
    ASSERT_EQ(a.blocks.entries.size(), b.blocks.entries.size());
    for (std::size_t k = 0; k < a.blocks.entries.size(); ++k) {
        const model::BlockEntry& x = a.blocks.entries[k];
        const model::BlockEntry& y = b.blocks.entries[k];
        ASSERT_TRUE(x.i == y.i && x.j == y.j && x.offset == y.offset && x.error == y.error) << k;
    }
    ASSERT_EQ(a.blocks.values, b.blocks.values);
}

PaperOptions with(ExpansionRule rule, PaperOcclusion occlusion, int moves = 1) {
    PaperOptions options;
    options.expansion.rule = rule;
    options.occlusion = occlusion;
    options.moves_per_frame = moves;
    options.sources = {MaterialId(1)};
    return options;
}

TEST(PaperEngine, equals_the_exact_engine_bit_for_bit_when_no_expansion_is_tolerated) {
    for (const Shelf shelf : {Shelf::None, Shelf::Resting, Shelf::Moving})
        for (const auto& keys : {slide(), spin_and_slide()}) {
            PreparedRoom p(LampRoom(keys, shelf), 2);
            PaperOptions options = with(ExpansionRule::Certified, PaperOcclusion::Exact);
            options.expansion.translation_tolerance = 0.0;
            options.expansion.rotation_quality = 0.0;
            ExactEngine exact(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options);
            PaperEngine paper(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options, options);
            for (std::uint32_t frame = 0; frame < 5; ++frame) {
                expect_same_bytes(exact.advance(0.0, p.poses(frame)), paper.advance(0.0, p.poses(frame)));
                EXPECT_EQ(paper.counts().expanded, 0u);
                EXPECT_GT(paper.counts().refreshed, 0u);
            }
        }
}

TEST(PaperEngine, refreshed_blocks_equal_those_of_the_exact_engine_and_most_are_not_refreshed) {
    PreparedRoom p(LampRoom(slide()), 3);
    ExactEngine exact(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options);
    PaperEngine paper(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options,
                      with(ExpansionRule::Printed, PaperOcclusion::Exact));
    std::uint64_t refreshed = 0, expanded = 0;
    for (std::uint32_t frame = 0; frame < frames; ++frame) {
        auto expected = blocks_of(exact.advance(0.0, p.poses(frame)));
        auto actual = blocks_of(paper.advance(0.0, p.poses(frame)));
        list_alike(expected, actual);
        std::uint64_t equal = 0;
        for (const auto& [pair, block] : expected)
            equal += block.values == actual.at(pair).values && block.error == actual.at(pair).error ? 1 : 0;
        EXPECT_GE(equal, paper.counts().refreshed + paper.counts().dark) << frame;
        if (frame == 0) {
            EXPECT_EQ(equal, expected.size());
            continue;
        }
        refreshed += paper.counts().refreshed;
        expanded += paper.counts().expanded;
    }
    printf("refreshed %llu, expanded %llu\n", static_cast<unsigned long long>(refreshed),
           static_cast<unsigned long long>(expanded));
    EXPECT_GT(expanded, 2 * refreshed) << "walls that the lamp's plane cuts are computed in each frame";
    EXPECT_GT(refreshed, 0u);
}

// Largest difference of a block from the exact engine's, in units of what both say of their error.
double worst_against_errors(PreparedRoom& p, const PaperOptions& options, std::uint64_t& expanded) {
    ExactEngine exact(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options);
    PaperEngine paper(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options, options);
    constexpr double rounding = 1e-7; // blocks are kept as floats
    double worst = 0.0;
    for (std::uint32_t frame = 0; frame < frames; ++frame) {
        auto expected = blocks_of(exact.advance(0.0, p.poses(frame)));
        auto actual = blocks_of(paper.advance(0.0, p.poses(frame)));
        list_alike(expected, actual);
        for (const auto& [pair, block] : expected) {
            const Block& other = actual.at(pair);
            const double allowed = block.error + other.error + rounding * (norm(block.values) + 1e-3);
            worst = std::max(worst, difference(block, other) / allowed);
        }
        expanded += paper.counts().expanded;
    }
    return worst;
}

TEST(PaperEngine, blocks_differ_from_the_exact_ones_by_less_than_the_errors_they_state) {
    // A fine tolerance, so that what the expansion adds to the error is not lost in the rest.
    for (const auto& [name, keys] :
         {std::pair("slide", slide()), std::pair("bend", bend()), std::pair("spin", spin()),
          std::pair("spin and slide", spin_and_slide())})
        for (const ExpansionRule rule :
             {ExpansionRule::Printed, ExpansionRule::ScaleFree, ExpansionRule::Certified}) {
            // One move per frame leaves the body too far beside a bent path for the certified tolerance.
            const int moves = rule == ExpansionRule::Certified ? 4 : 1;
            PreparedRoom p(LampRoom(keys), 2, 1e-5);
            std::uint64_t expanded = 0;
            const double worst = worst_against_errors(p, with(rule, PaperOcclusion::Exact, moves), expanded);
            printf("%-14s %-10s worst %.3f of the stated error, %llu expanded\n", name,
                   rule == ExpansionRule::Printed     ? "printed"
                   : rule == ExpansionRule::ScaleFree ? "scale-free"
                                                      : "certified",
                   worst, static_cast<unsigned long long>(expanded));
            EXPECT_LT(worst, 1.0) << name;
            EXPECT_GT(expanded, 0u) << name;
        }
}

TEST(PaperEngine, a_curved_body_that_turns_stays_within_its_errors) {
    LampRoom room(spin_and_slide());
    model::Surface cap;
    cap.type = model::SurfaceType::Sphere;
    cap.origin = Vec3(0.4, 1.0, 1.7);
    cap.radius = 0.2;
    room.set.patches[6].surface = cap;
    room.set.patches[6].points = {Vec2(0, -1.3), Vec2(1.5, -1.3), Vec2(1.5, -0.8), Vec2(0, -0.8)};
    PreparedRoom p(std::move(room), 2);
    ASSERT_FALSE(p.shapes.back().planar);
    p.options.occlusion = false; // the chords of a curved patch hide its own elements
    std::uint64_t expanded = 0;
    EXPECT_LT(worst_against_errors(p, with(ExpansionRule::ScaleFree, PaperOcclusion::Exact), expanded), 1.0);
    EXPECT_GT(expanded, 100u);
}

TEST(PaperEngine, pairs_cut_by_a_horizon_are_within_their_errors_only_when_computed_anew) {
    // The lamp tilts by 4 degrees per frame: its plane sweeps over the walls.
    const std::vector<model::Keyframe> tilt{key(0.0, Vec3(0)), key(1.0, Vec3(0), 2.8, Vec3(0, 1, 0))};
    PreparedRoom p(LampRoom(tilt), 4);
    PaperOptions options = with(ExpansionRule::ScaleFree, PaperOcclusion::Exact);
    options.expansion.rotation_quality = 0.5;
    std::uint64_t expanded = 0, with_kept = 0;
    EXPECT_LT(worst_against_errors(p, options, expanded), 1.0);
    options.expansion.horizons = Horizons::Kept;
    EXPECT_GT(worst_against_errors(p, options, with_kept), 1.0);
    EXPECT_GT(with_kept, expanded);
}

TEST(PaperEngine, exact_occlusion_keeps_blocks_within_their_errors_behind_a_moving_shelf) {
    PreparedRoom p(LampRoom(slide(), Shelf::Moving), 2);
    std::uint64_t expanded = 0;
    EXPECT_LT(worst_against_errors(p, with(ExpansionRule::Certified, PaperOcclusion::Exact), expanded), 1.0);
    EXPECT_GT(expanded, 0u);
}

TEST(PaperEngine, only_the_printed_conditions_depend_on_the_unit_of_length) {
    const auto refreshed = [](ExpansionRule rule, double scale) {
        PreparedRoom p(LampRoom(spin(), Shelf::None, scale), 2);
        PaperEngine paper(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options,
                          with(rule, PaperOcclusion::Publication));
        std::vector<std::uint64_t> counts;
        for (std::uint32_t frame = 0; frame < 6; ++frame) {
            paper.advance(0.0, p.poses(frame));
            counts.push_back(paper.counts().refreshed);
        }
        return counts;
    };
    // A power of two scales every number of the computation exactly.
    for (const ExpansionRule rule : {ExpansionRule::ScaleFree, ExpansionRule::Certified})
        EXPECT_EQ(refreshed(rule, 1.0), refreshed(rule, 16.0));
    EXPECT_NE(refreshed(ExpansionRule::Printed, 1.0), refreshed(ExpansionRule::Printed, 16.0));
}

TEST(PaperEngine, a_moving_pair_keeps_its_visible_share_until_its_block_is_computed_anew) {
    PreparedRoom p(LampRoom(slide(), Shelf::Resting), 2);
    PaperOptions options; // no sources: the lamp's shadows are not exact
    PaperEngine paper(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options, options);
    const auto unoccluded = [&](const model::ElementPair& pair, std::uint32_t frame) {
        const PosedElements elements(p.shapes, p.room.plan, p.poses(frame));
        return kernel::transport(elements[pair.i], elements[pair.j], p.occluders,
                                 {.tolerance = 1e-5, .occlusion = false});
    };
    const auto first = blocks_of(paper.advance(0.0, p.poses(0)));
    auto last = first;
    constexpr std::uint32_t frame = 3;
    for (std::uint32_t f = 1; f <= frame; ++f) last = blocks_of(paper.advance(0.0, p.poses(f)));
    int partly_hidden = 0;
    for (const auto& [pair, block] : first) {
        const ElementShape& a = p.shapes[pair.i];
        const ElementShape& b = p.shapes[pair.j];
        if (block.values.empty() || !wholly_facing(a, b) || least_distance(a, b) < 0.3) continue;
        const double share = block.values[0] / unoccluded(pair, 0).values[0];
        if (share < 0.05 || share > 0.95) continue;
        ++partly_hidden;
        EXPECT_NEAR(last.at(pair).values[0] / unoccluded(pair, frame).values[0], share, 0.01);
    }
    EXPECT_GT(partly_hidden, 3);
}

TEST(PaperEngine, gives_the_same_bytes_at_any_number_of_threads) {
    std::vector<FrameBlocks> results;
    for (const std::size_t threads : {1, 2, 3}) {
        core::set_thread_count(threads);
        PreparedRoom p(LampRoom(bend(), Shelf::Moving), 2);
        PaperEngine paper(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options,
                          with(ExpansionRule::Printed, PaperOcclusion::Publication, 2));
        for (std::uint32_t frame = 0; frame < 4; ++frame) paper.advance(0.0, p.poses(frame));
        results.push_back(paper.advance(0.0, p.poses(4)));
    }
    core::set_thread_count(0);
    expect_same_bytes(results[0], results[1]);
    expect_same_bytes(results[0], results[2]);
}

TEST(PaperEngine, coefficients_are_computed_once_per_pair_and_axis_until_a_refresh) {
    PreparedRoom p(LampRoom(slide()), 2);
    PaperEngine paper(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options,
                      with(ExpansionRule::Printed, PaperOcclusion::Publication));
    std::uint64_t sets = 0, refreshed = 0, first_expansions = 0;
    for (std::uint32_t frame = 0; frame < frames; ++frame) {
        paper.advance(0.0, p.poses(frame));
        sets += paper.counts().sets;
        refreshed += paper.counts().refreshed;
        if (frame == 1) first_expansions = paper.counts().sets;
    }
    EXPECT_GT(first_expansions, 0u);
    EXPECT_LE(sets, refreshed) << "one axis: at most one set after each refresh";
}

TEST(PaperEngine, a_body_that_returns_to_its_reference_has_its_old_blocks) {
    PreparedRoom p(LampRoom(spin_and_slide()), 2);
    PaperOptions options = with(ExpansionRule::Certified, PaperOcclusion::Publication, 16);
    options.expansion.translation_tolerance = 1.0;
    options.expansion.rotation_quality = 1.0;
    PaperEngine paper(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options, options);
    const FrameBlocks first = paper.advance(0.0, p.poses(0));
    const FrameBlocks same = paper.advance(0.0, p.poses(0));
    expect_same_bytes(first, same);
    EXPECT_EQ(paper.counts().refreshed, 0u);
    EXPECT_EQ(paper.counts().sets, 0u);
}

TEST(PaperEngine, options_out_of_range_are_refused) {
    PreparedRoom p(LampRoom(slide()), 1);
    const auto make = [&](const PaperOptions& options) {
        PaperEngine(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options, options);
    };
    PaperOptions options;
    options.expansion.order = 17;
    EXPECT_THROW(make(options), core::OptionError);
    options = {};
    options.moves_per_frame = 0;
    EXPECT_THROW(make(options), core::OptionError);
    options = {};
    options.expansion.rotation_quality = -0.1;
    EXPECT_THROW(make(options), core::OptionError);
    EXPECT_NO_THROW(make({}));
}

// Light of one frame by the blocks of an engine.
struct LitRoom {
    explicit LitRoom(const PreparedRoom& p) : blocks(p.coefficients.layout, p.coefficients.static_blocks) {
        std::vector<double> M, rho;
        for (const auto& shape : p.shapes) {
            const model::Material& material = p.room.scene.materials[shape.material.value];
            areas.push_back(shape.area);
            M.push_back(material.exitance[0]);
            reflectance.push_back(material.reflectance[0]);
        }
        exitance = solve::constant_coefficients(p.coefficients.layout, 1, areas, M);
    }
    std::vector<double> solve(const FrameBlocks& frame) {
        blocks.replace(frame.pairs, frame.blocks);
        return solve::solve_system({blocks, 1, exitance, reflectance, areas}, {.tolerance = 1e-10}, {})
            .radiosity;
    }

    solve::BlockOperator blocks;
    std::vector<double> areas, reflectance, exitance;
};

double norm_of(std::span<const double> values) {
    return norm(std::vector<double>(values.begin(), values.end()));
}

// Bound of the L2 norm of B's error: rho / (1 - rho) times that of what errors of blocks do to G B, as ||G|| <= 1.
double solution_bound(const PreparedRoom& p, const FrameBlocks& frame, const std::vector<double>& B,
                      double rho) {
    const auto& layout = p.coefficients.layout;
    std::vector<double> error(layout.elements(), 0.0);
    const auto size = [&](std::size_t e) {
        return norm_of(std::span(B).subspan(layout.offsets[e], layout.count(e)));
    };
    for (const model::BlockEntry& entry : frame.blocks.entries) {
        error[entry.i] += static_cast<double>(entry.error) * size(entry.j);
        error[entry.j] += static_cast<double>(entry.error) * size(entry.i);
    }
    return rho / (1.0 - rho) * norm(error);
}

// Largest relative error of the light on what does not emit, over some frames; each must be within the bound of its blocks.
double worst_light(PreparedRoom& p, const PaperOptions& options, bool within_bound) {
    ExactEngine exact(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options);
    PaperEngine paper(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options, options);
    LitRoom expected_light(p), light(p);
    double worst = 0.0;
    for (std::uint32_t frame = 0; frame < frames; ++frame) {
        const FrameBlocks exact_blocks = exact.advance(0.0, p.poses(frame));
        const FrameBlocks blocks = paper.advance(0.0, p.poses(frame));
        const auto expected = expected_light.solve(exact_blocks);
        const auto B = light.solve(blocks);
        std::vector<double> off(B.size()), reflected = expected;
        for (std::size_t u = 0; u < B.size(); ++u) {
            off[u] = B[u] - expected[u];
            reflected[u] -= light.exitance[u];
        }
        const double bound = solution_bound(p, blocks, B, 0.6) + solution_bound(p, exact_blocks, B, 0.6);
        if (within_bound) {
            EXPECT_LE(norm(off), bound + 1e-9 * norm(B)) << "frame " << frame;
        }
        for (std::size_t u = 0; u < B.size(); ++u)
            if (light.exitance[u] != 0.0) off[u] = 0.0;
        worst = std::max(worst, norm(off) / norm(reflected));
    }
    return worst;
}

TEST(PaperEngine, light_of_a_moving_lamp_is_within_the_bound_in_every_frame) {
    for (const auto& [name, keys] :
         {std::pair("slide", slide()), std::pair("bend", bend()), std::pair("spin", spin())}) {
        PreparedRoom p(LampRoom(keys), 3);
        const double worst = worst_light(p, with(ExpansionRule::Printed, PaperOcclusion::Exact), true);
        printf("%-5s error of reflected light at most %.2e\n", name, worst);
        EXPECT_LT(worst, 0.03) << name;
    }
}

TEST(PaperEngine, ignored_shadows_of_a_mover_cost_more_than_the_expansions) {
    PreparedRoom p(LampRoom(slide(), Shelf::Moving), 3);
    const double exact = worst_light(p, with(ExpansionRule::Printed, PaperOcclusion::Exact), true);
    const double publication =
        worst_light(p, with(ExpansionRule::Printed, PaperOcclusion::Publication), false);
    printf("error of reflected light at most %.2e with exact occlusion, %.2e with the publication's\n", exact,
           publication);
    EXPECT_GT(publication, 2.0 * exact);
}

TEST(PaperEngine, shadows_of_movers_on_pairs_at_rest_are_ignored_unless_a_source_is_part_of_them) {
    PreparedRoom p(LampRoom(slide(), Shelf::Moving), 2);
    p.room.plan.moving_objects = {ObjectId(2)}; // the lamp rests, the shelf moves
    p.occluders = [&] {
        auto bodies = visibility::bodies_of(p.room.set, p.room.scene);
        bodies[2].moves = true;
        return visibility::Occluders(std::move(bodies));
    }();
    p.coefficients =
        coefficients::compute_coefficients(p.shapes, p.room.scene, p.room.plan, p.occluders, p.options, 1e6);
    ExactEngine exact(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options);
    PaperEngine paper(p.coefficients, p.shapes, p.room.plan, p.occluders, p.options,
                      with(ExpansionRule::Printed, PaperOcclusion::Publication));
    const auto at_rest = [&](const model::ElementPair& pair) {
        return p.shapes[pair.i].object != ObjectId(2) && p.shapes[pair.j].object != ObjectId(2);
    };
    const auto lit_by_lamp = [&](const model::ElementPair& pair) {
        return p.shapes[pair.i].material == MaterialId(1) || p.shapes[pair.j].material == MaterialId(1);
    };
    std::size_t of_lamp = 0, ignored = 0;
    for (std::uint32_t frame = 0; frame < 3; ++frame) {
        const auto expected = blocks_of(exact.advance(0.0, p.poses(frame)));
        const auto actual = blocks_of(paper.advance(0.0, p.poses(frame)));
        for (const auto& [pair, block] : expected) {
            if (!at_rest(pair)) continue;
            const auto found = actual.find(pair);
            if (lit_by_lamp(pair)) {
                ++of_lamp;
                ASSERT_NE(found, actual.end());
                EXPECT_EQ(found->second.values, block.values);
            } else {
                ++ignored;
                EXPECT_EQ(found, actual.end());
            }
        }
    }
    EXPECT_GT(of_lamp, 0u);
    EXPECT_GT(ignored, 0u);
}

} // namespace
} // namespace kinelux::motion
