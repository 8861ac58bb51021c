// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "coefficients/coefficients.h"
#include "solve/solve.h"
#include "support/shapes.h"

namespace kinelux::support {

/// What stands in the room of a sliding lamp: a shelf, or a wall that leaves a seventh of the room's section open.
enum class Inside : std::uint8_t { Shelf, Wall };

/// A closed room and a lamp, a thin box that slides under the ceiling and casts a shadow itself. The blocks of every pose
/// are computed beforehand, so that an animation costs nothing but its solver.
class SlidingLamp {
public:
    /// @param poses  along the way, >= 2; @param n  elements along an edge of each patch
    /// @param way  of the lamp in a room 2 m long [m], at most 1.4, or 0.3 before a wall
    SlidingLamp(int poses, int n, int degree, double way = 1.2, Inside inside = Inside::Shelf) {
        for (int p = 0; p < poses; ++p) add_pose(way * p / (poses - 1), n, degree, inside);
        for (Pose& pose : poses_) keep_what_differs(pose);
    }

    const model::UnknownLayout& layout() const { return layout_; }
    const model::BlockSet& static_blocks() const { return static_; }
    const std::vector<double>& areas() const { return areas_; }
    /// Frames in which the lamp goes forth and back once.
    std::uint32_t period() const { return 2 * static_cast<std::uint32_t>(poses_.size()) - 2; }

    void move(solve::BlockOperator& blocks, std::uint32_t frame) const {
        const std::uint32_t phase = frame % period(), last = static_cast<std::uint32_t>(poses_.size()) - 1;
        const Pose& pose = poses_[phase <= last ? phase : period() - phase];
        blocks.replace(pose.pairs, pose.blocks);
    }
    /// The lamp's underside shines; each further channel by half as much.
    std::vector<double> exitance(std::size_t channels) const {
        std::vector<double> values(areas_.size() * channels, 0.0);
        for (std::size_t e = 0; e < areas_.size(); ++e)
            for (std::size_t c = 0; c < channels && shines_[e]; ++c)
                values[e * channels + c] = 10.0 * std::pow(0.5, static_cast<double>(c));
        return solve::constant_coefficients(layout_, channels, areas_, values);
    }
    /// Walls of `rho`, a shelf and a lamp of 3/4 of that; each further channel 3/4 of the one before.
    std::vector<double> reflectance(double rho, std::size_t channels) const {
        std::vector<double> values;
        for (const bool is_wall : is_wall_)
            for (std::size_t c = 0; c < channels; ++c)
                values.push_back((is_wall ? rho : 0.75 * rho) * std::pow(0.75, static_cast<double>(c)));
        return values;
    }

private:
    struct Pose {
        std::vector<model::ElementPair> pairs;
        model::BlockSet blocks;
    };

    void add_pose(double shift, int n, int degree, Inside inside) {
        model::PatchSet set;
        set.patches = box(Vec3(0), Vec3(2.0, 1.6, 1.4), Facing::Inwards);
        const Vec3 lamp(0.2 + shift, 0.6, 1.2);
        const auto obstacle = inside == Inside::Shelf
                                  ? std::pair(Vec3(0.7, 0.4, 0.4), Vec3(1.3, 1.2, 0.45))
                                  : std::pair(Vec3(0.95, 0.01, 0.01), Vec3(1.05, 1.59, 1.2));
        for (const auto& [low, high] : {obstacle, std::pair(lamp, lamp + Vec3(0.4, 0.4, 0.05))})
            for (const auto& patch : box(low, high, Facing::Outwards)) set.patches.push_back(patch);
        const auto scene = plain_scene(1);
        const auto shapes = shapes_of(set, n, degree);
        const auto occluders = occluders_of(set, scene);
        auto all = coefficients::compute_coefficients(shapes, scene, {.degree = degree}, occluders,
                                                      {.tolerance = 1e-3}, 1e6);
        poses_.push_back({{}, std::move(all.static_blocks)});
        if (poses_.size() > 1) return;
        layout_ = all.layout;
        static_ = poses_.front().blocks;
        const auto per_patch = static_cast<std::size_t>(n) * static_cast<std::size_t>(n),
                   underside = 12 * per_patch;
        for (std::size_t e = 0; e < shapes.size(); ++e) {
            areas_.push_back(shapes[e].area);
            is_wall_.push_back(e < 6 * per_patch);
            shines_.push_back(e >= underside && e < underside + per_patch);
        }
    }

    std::vector<float> values_of(const model::BlockSet& set, std::size_t k) const {
        const model::BlockEntry& entry = set.entries[k];
        const auto first = set.values.begin() + static_cast<std::ptrdiff_t>(entry.offset);
        return {first, first + static_cast<std::ptrdiff_t>(layout_.count(entry.i) * layout_.count(entry.j))};
    }

    // Leaves only the blocks that are not the static ones.
    void keep_what_differs(Pose& pose) const {
        model::BlockSet kept;
        std::size_t s = 0;
        const auto pair_of = [](const model::BlockEntry& entry) {
            return model::ElementPair{entry.i, entry.j};
        };
        for (std::size_t k = 0; k <= pose.blocks.entries.size(); ++k) {
            const bool end = k == pose.blocks.entries.size();
            while (s < static_.entries.size() &&
                   (end || pair_of(static_.entries[s]) < pair_of(pose.blocks.entries[k])))
                pose.pairs.push_back(pair_of(static_.entries[s++]));
            if (end) break;
            const std::vector<float> values = values_of(pose.blocks, k);
            const bool both =
                s < static_.entries.size() && pair_of(static_.entries[s]) == pair_of(pose.blocks.entries[k]);
            const bool same = both && values_of(static_, s) == values;
            if (both) ++s;
            if (same) continue;
            model::BlockEntry entry = pose.blocks.entries[k];
            entry.offset = kept.values.size();
            pose.pairs.push_back(pair_of(entry));
            kept.entries.push_back(entry);
            kept.values.insert(kept.values.end(), values.begin(), values.end());
        }
        pose.blocks = std::move(kept);
    }

    model::UnknownLayout layout_;
    model::BlockSet static_;
    std::vector<double> areas_;
    std::vector<bool> is_wall_, shines_;
    std::vector<Pose> poses_;
};

} // namespace kinelux::support
