// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "motion/pair_nodes.h"

namespace kinelux::motion {

// Notation: r = x_j - x_i [m], kept while surfaces turn (the publication's r' = r); R turns the normals of one surface;
// K = -(n_i.r)(n_j.r) / (pi r^4) [1/m2].

/// Which of a pair's surfaces turns.
enum class Turning : std::uint8_t { First, Second };

/// k with K = n.k, n the normal of the surface that turns: -(n_i.r) r / (pi r^4) where j turns, -(n_j.r) r / (pi r^4) where
/// i turns [1/m2]. @cite Biri et al. 2003, section 3.2.3 (whose first line has pi r^2 for pi r^4)
Vec3 turning_vector(const Vec3& r, const Vec3& n_i, const Vec3& n_j, Turning turning);

/// What the change of K is linear in, projected onto the bases: three blocks of k where the turning surface is planar,
/// nine of n[m % 3] k[m / 3] where it is not. @return  3 or 9 x size(a) x size(b) [1]
/// @cite equations (18), (19)
std::vector<double> rotation_blocks(const PairNodes& nodes, Turning turning, bool planar);

/// values += scale * ((R - I) n).k. @param blocks  of rotation_blocks; @param normal  of a planar surface before the turn
/// @cite equations (17)-(19), n'_j - n_j for the printed n_j - n_i
void add_rotation(std::span<const double> blocks, const Mat3& R, const Vec3& normal, double scale,
                  std::span<double> values);

/// The publication's condition: sin(angle) < r S / (4 a) for r < 1, sin(angle) < S / (2 a) for r > 1, r and a in metres.
/// Depends on the unit of length. @param a  longest distance between the axis and a point of the surface [m];
/// @param angle  turned since the coefficients were computed [rad], >= 0; from a quarter turn on the answer is no
/// @param S  quality [1]; @cite equation (20)
bool rotation_condition_printed(double r, double a, double angle, double S);

/// The same without a unit: a turn moves no point further than 2 a sin(angle/2), and the error of K is at most
/// 2 (that) / r in units of 1/(pi r^2) to first order: 2 a sin(angle/2) / r <= S / 2.
bool rotation_condition_scale_free(double r, double a, double angle, double S);

} // namespace kinelux::motion
