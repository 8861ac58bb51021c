// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"
#include "motion/pair_nodes.h"

namespace kinelux::motion {

// Notation: r = x_j - x_i [m]; surface j moves by p along the unit vector p0; K = -(n_i.r)(n_j.r) / (pi r^4) [1/m2].

constexpr int most_orders = 16; ///< of the series

/// Terms of the inversion w = r' / |r'|^2, r' = r + p p0, as a power series in p, along one direction:
///   u.w = sum_n p^n u.v_n,   v_0 = r/r^2,  v_1 = (p0 - 2 alpha v_0)/r^2,  v_(n+1) = -(2 alpha v_n + v_(n-1))/r^2,
/// alpha = p0.r. No division by alpha, which may be 0; |v_n| = r^-(n+1). Converges for p < r.
/// @param r      not 0
/// @param terms  u.v_0 ... u.v_M [1/m^(n+1)], set
void inversion_terms(const Vec3& r, const Vec3& p0, const Vec3& u, std::span<double> terms);

/// phi_0 ... phi_M of K(r + p p0) = sum_n p^n phi_n: K being a product of two inversions,
///   phi_n = -(1/pi) sum_m (n_i.v_m)(n_j.v_(n-m)),   |phi_n| <= (n + 1) / (pi r^(n+2)), attained.
/// The same as (15) and (16) with xi_n as printed, which is 0/0 where p0 is perpendicular to r.
/// @param terms  [1/m^(n+2)], at most most_orders + 1, set
/// @cite Biri et al. 2003, equations (11), (15), appendix 7.1 (whose last sum starts at n = 1)
void translation_terms(const Vec3& r, const Vec3& n_i, const Vec3& n_j, const Vec3& p0,
                       std::span<double> terms);

/// Largest error of the series after order M, over all directions and normals, in units of 1/(pi r^2):
/// t^(M+1) ((M + 2) - (M + 1) t) / (1 - t)^2, attained at n_i = n_j = -p0 = r/|r|; infinite for t >= 1.
/// @param t  |p| / r, >= 0
double series_tail(double t, int order);

/// Bound of the error when the series along several axes are added up, K(r + sum_a p_a) - K(r) ~ sum_a sum_(n<=M), in units
/// of 1/(pi r^2): the tail of the whole displacement, and the products between axes that the sum leaves out,
///   sum_(n=2..M) (n + 1) (T^n - sum_a t_a^n),  T = sum_a t_a,
/// since the symmetric form behind the terms of degree n is at most (n + 1) / (pi r^(n+2)) in any directions (Banach 1938: on
/// a Hilbert space it is nowhere larger than on its diagonal). Infinite for T >= 1.
/// @param shares  t_a = |p_a| / r
/// @param t       |sum_a p_a| / r
double staircase_tail(std::span<const double> shares, double t, int order);

/// The publication's condition for its series: r > (1 + sqrt 2) p. @cite equation (14)
bool series_condition(double r, double p);

/// phi_1 ... phi_M projected onto the bases by the nodes of a pair. @return  M x size(a) x size(b) [1/m^n]
/// @cite equation (16), bases orthonormal in area
std::vector<double> translation_blocks(const PairNodes& nodes, const Vec3& p0, int order);

/// values += scale * sum_(n>=1) p^n phi_n. @param blocks  of translation_blocks
void add_translation(std::span<const double> blocks, double p, double scale, std::span<double> values);

} // namespace kinelux::motion
