// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/element_shape.h"
#include "kernel/transport.h"
#include "model/coefficients.h"
#include "model/plan.h"
#include "motion/posed_elements.h"
#include "visibility/occluders.h"
#include "visibility/shaft.h"

namespace kinelux::motion {

/// What is known of a pair's block at one time without integrating it.
enum class Change : std::uint8_t {
    None,    ///< the static block holds, or there is none
    Zero,    ///< the elements face away from each other
    Clear,   ///< in relative motion, nothing stands between
    Horizon, ///< the same, and the plane of one cuts the other
    Near, ///< Clear or Horizon, and moving further in a frame than they are apart: what is exact in one says little of the next
    Shaded ///< something that moves relative to one of both may hide a part: its polygon reaches into the shaft
};

/// The constant moment of a block as a few segments see it, between points that stay the same.
struct Glimpse {
    static constexpr std::size_t segments = 32;
    double visible = 0.0; ///< past what stands between [1]
    double whole = 0.0;   ///< with nothing in between [1]
};

/// Which pairs at rest relative to each other are watched for bodies that come between.
enum class Watched : std::uint8_t {
    Listed, ///< those that the scene's own motions lead through (Coefficients::crossed_pairs)
    All     ///< all that exchange light: bodies may go anywhere
};

/// The pairs whose blocks may differ from the static ones, and which of them do at one time: pairs in relative motion, and
/// pairs at rest (or on one body that moves) whose shaft another body enters. The shaft test is exact for convex planar
/// elements (docs/theory.md, Visibility); balls around the moving bodies come first.
class ChangingPairs {
public:
    /// All arguments must outlive this. @param occluders  is moved to the poses
    ChangingPairs(const model::Coefficients& coefficients,
                  std::span<const geometry::ElementShape> rest_elements, const model::Plan& plan,
                  visibility::Occluders& occluders, const kernel::TransportOptions& options,
                  Watched watched = Watched::Listed);

    std::span<const model::ElementPair> pairs() const { return pairs_; } ///< sorted
    bool in_relative_motion(std::size_t k) const { return kinds_[k] == Kind::Moving; }

    /// Moves bodies and elements. @param poses  world_from_rest, one per object
    /// @param wanted  one per element: 0 = belongs to no pair that is asked for; empty: all may be
    void set_poses(std::span<const geometry::Pose> poses, std::span<const std::uint8_t> wanted = {});

    /// Of pair number k at the poses set. May run in parallel.
    /// @param step_m  how far the two may move relative to each other from one frame to the next [m]; 0: never Near
    Change change(std::size_t k, double step_m = 0.0) const;
    /// Its changes tell of shadows that come; it is not exact.
    Glimpse glimpse(std::size_t k) const;
    /// Its block, integrated. @param change  what change(k) says
    kernel::TransportBlock block(std::size_t k, Change change) const;

private:
    enum class Kind : std::uint8_t { Moving, Resting, Riding };
    struct Ball {
        Vec3 centre{0.0};
        double radius = 0.0;
    };

    void list_pairs(Watched watched);
    void find_others();
    void bound_movers();
    bool moves(std::size_t element) const { return moving_[rest_[element].object.value] != 0; }
    Change unshaded(const model::ElementPair& pair, double step_m) const;
    bool mover_near(const model::ElementPair& pair) const;

    const model::Coefficients& coefficients_;
    std::span<const geometry::ElementShape> rest_;
    const model::Plan& plan_;
    visibility::Occluders& occluders_;
    kernel::TransportOptions options_;
    std::vector<model::ElementPair> pairs_;
    std::vector<Kind> kinds_;
    std::vector<std::uint8_t> moving_; ///< per object
    std::vector<std::vector<std::uint8_t>>
        others_;                             ///< per moving object, per object: 1 = not carried along with it
    std::vector<visibility::ShaftEnd> ends_; ///< per element
    std::optional<PosedElements> elements_;
    std::vector<Ball> movers_;
};

} // namespace kinelux::motion
