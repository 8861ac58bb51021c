// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "support/flat_pieces.h"

namespace kinelux::support {

/// integral over a flat piece of phi_l(y) cos cos' / (pi r^2) dA for all l at once, at any point in front of it: by
/// Gauss products where the point is far, else by polar integration about its foot, closed along the radius, Gauss in
/// asinh(u / distance to the side) along each side. A compact piece is taken whole, along its loops; a long one is
/// bisected until each part is far or compact.
class PointIntegral {
public:
    PointIntegral(const FlatPiece& piece, const geometry::Basis& basis);

    /// Adds the integral at a receiver to `sums`. @param normal  unit; the whole piece must lie in front of it
    void add(const Vec3& x, const Vec3& normal, std::span<double> sums);

private:
    struct Part {
        std::array<Vec2, 3> corners;
        double size;                 ///< longest side [m]
        double area;                 ///< [m2]
        std::size_t first_child = 0; ///< 0: not bisected
        std::vector<Vec2> nodes;     ///< of the Gauss product; empty: not visited
        std::vector<double> weights; ///< [m2]
        std::vector<double> basis;   ///< nodes x basis size
    };
    /// A receiver in the coordinates of the piece's plane.
    struct Receiver {
        Vec3 x, normal;
        Vec2 foot;
        double height; ///< over the plane [m]
        double facing; ///< minus the product of both normals
        Vec2 slope;    ///< the receiver's normal along the plane's axes
        std::span<double> sums;
    };

    static Part make_part(const std::array<Vec2, 3>& corners);
    void add_part(const Receiver& receiver, std::size_t index);
    void bisect(std::size_t index);
    void add_gauss(const Receiver& receiver, Part& part) const;
    void add_polar(const Receiver& receiver, std::span<const Line> sides) const;
    double distance_to_parts(const Receiver& receiver) const;
    void fill_nodes(Part& part) const;

    Plane plane_;
    const geometry::Basis& basis_;
    std::vector<Part> parts_;
    std::size_t roots_ = 0;
    std::vector<Line> sides_;   ///< of all loops; empty: the piece is not compact
    double size_ = 0.0;         ///< of the piece [m]
    double compact_size_ = 0.0; ///< longest side of a part fit for polar integration [m]
};

} // namespace kinelux::support
