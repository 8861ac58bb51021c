// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/translation_series.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace kinelux::motion {

using geometry::SurfaceNode;

void inversion_terms(const Vec3& r, const Vec3& p0, const Vec3& u, std::span<double> terms) {
    const double inverse = 1.0 / glm::dot(r, r), twice_alpha = 2.0 * glm::dot(p0, r);
    terms[0] = glm::dot(u, r) * inverse;
    if (terms.size() > 1) terms[1] = (glm::dot(u, p0) - twice_alpha * terms[0]) * inverse;
    for (std::size_t n = 2; n < terms.size(); ++n)
        terms[n] = -(twice_alpha * terms[n - 1] + terms[n - 2]) * inverse;
}

void translation_terms(const Vec3& r, const Vec3& n_i, const Vec3& n_j, const Vec3& p0,
                       std::span<double> terms) {
    std::array<double, most_orders + 1> along_i, along_j;
    inversion_terms(r, p0, n_i, std::span(along_i).first(terms.size()));
    inversion_terms(r, p0, n_j, std::span(along_j).first(terms.size()));
    for (std::size_t n = 0; n < terms.size(); ++n) {
        double sum = 0.0;
        for (std::size_t m = 0; m <= n; ++m) sum += along_i[m] * along_j[n - m];
        terms[n] = -std::numbers::inv_pi * sum;
    }
}

double series_tail(double t, int order) {
    if (!(t < 1.0)) return std::numeric_limits<double>::infinity();
    return std::pow(t, order + 1) * ((order + 2) - (order + 1) * t) / ((1.0 - t) * (1.0 - t));
}

double staircase_tail(std::span<const double> shares, double t, int order) {
    double whole = 0.0;
    for (const double share : shares) whole += share;
    if (!(whole < 1.0)) return std::numeric_limits<double>::infinity();
    const double tail = series_tail(t, order);
    if (std::count_if(shares.begin(), shares.end(), [](double share) { return share > 0.0; }) < 2)
        return tail;
    double products = 0.0;
    for (int n = 2; n <= order; ++n) {
        double powers = 0.0;
        for (const double share : shares) powers += std::pow(share, n);
        products += (n + 1) * (std::pow(whole, n) - powers);
    }
    return tail + products;
}

bool series_condition(double r, double p) { return r > (1.0 + std::numbers::sqrt2) * p; }

std::vector<double> translation_blocks(const PairNodes& nodes, const Vec3& p0, int order) {
    const auto orders = static_cast<std::size_t>(order);
    std::array<double, most_orders + 1> all;
    const std::span<double> terms = std::span(all).first(orders + 1);
    return nodes.project(orders, [&](const SurfaceNode& x, const SurfaceNode& y, std::span<double> values) {
        translation_terms(y.position - x.position, x.normal, y.normal, p0, terms);
        std::copy(terms.begin() + 1, terms.end(), values.begin());
    });
}

void add_translation(std::span<const double> blocks, double p, double scale, std::span<double> values) {
    double power = scale;
    for (std::size_t first = 0; first < blocks.size(); first += values.size()) {
        power *= p;
        for (std::size_t v = 0; v < values.size(); ++v) values[v] += power * blocks[first + v];
    }
}

} // namespace kinelux::motion
