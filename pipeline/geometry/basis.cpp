// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/error.h"

namespace kinelux::geometry {

namespace {

// A function whose part orthogonal to the earlier ones is below this share of it is not determined by the domain.
constexpr double rank_tolerance = 1e-6;
double dot(std::span<const double> a, std::span<const double> b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

} // namespace

Basis::Basis(std::span<const DomainPoint> domain, int degree) : degree_(degree), frame_(domain) {
    if (degree < 0 || degree > max_degree)
        throw core::OptionError("basis degree " + std::to_string(degree) + " is not in 0.." +
                                std::to_string(max_degree));
    // The weighted Vandermonde matrix: column m holds sqrt(w) L_m at the points.
    const std::size_t n = size(), points = domain.size();
    std::vector<double> vandermonde(n * points), values(n);
    for (std::size_t p = 0; p < points; ++p) {
        frame_.products(domain[p].parameter, degree, values);
        for (std::size_t m = 0; m < n; ++m)
            vandermonde[m * points + p] = std::sqrt(domain[p].weight) * values[m];
    }

    // Gram-Schmidt on its columns, twice over with the columns computed afresh from the coefficients in between.
    coefficients_.assign(n * n, 0.0);
    for (std::size_t k = 0; k < n; ++k) coefficients_[k * n + k] = 1.0;
    std::vector<double> q(n * points);
    for (int pass = 0; pass < 2; ++pass)
        for (std::size_t k = 0; k < n; ++k) {
            const std::span<double> column(&q[k * points], points);
            std::fill(column.begin(), column.end(), 0.0);
            for (std::size_t m = 0; m <= k; ++m)
                for (std::size_t p = 0; p < points; ++p)
                    column[p] += coefficients_[k * n + m] * vandermonde[m * points + p];
            const double before = std::sqrt(dot(column, column));
            for (std::size_t j = 0; j < k; ++j) {
                const std::span<const double> earlier(&q[j * points], points);
                const double overlap = dot(column, earlier);
                for (std::size_t p = 0; p < points; ++p) column[p] -= overlap * earlier[p];
                for (std::size_t m = 0; m <= j; ++m)
                    coefficients_[k * n + m] -= overlap * coefficients_[j * n + m];
            }
            const double length = std::sqrt(dot(column, column));
            if (!(length > rank_tolerance * before)) {
                *this = Basis(domain, degree - 1);
                return;
            }
            for (double& x : column) x /= length;
            for (std::size_t m = 0; m <= k; ++m) coefficients_[k * n + m] /= length;
        }
}

void Basis::evaluate(const Vec2& parameter, std::span<double> values) const {
    std::array<double, basis_size(max_degree)> products;
    frame_.products(parameter, degree_, products);
    const std::size_t n = size();
    for (std::size_t k = 0; k < n; ++k) {
        double sum = 0.0;
        for (std::size_t m = 0; m <= k; ++m) sum += coefficients_[k * n + m] * products[m];
        values[k] = sum;
    }
}

std::vector<double> Basis::monomial_coefficients() const {
    // Row k of `legendre` holds the coefficients of P_k by powers.
    std::array<std::array<double, max_degree + 1>, max_degree + 1> legendre{};
    legendre[0][0] = 1.0;
    legendre[1][1] = 1.0;
    for (std::size_t k = 2; k <= max_degree; ++k)
        for (std::size_t p = 0; p <= k; ++p) {
            const auto order = static_cast<double>(k);
            const double raised = p > 0 ? (2.0 * order - 1.0) * legendre[k - 1][p - 1] : 0.0;
            legendre[k][p] = (raised - (order - 1.0) * legendre[k - 2][p]) / order;
        }
    const auto index = [](std::size_t x_power, std::size_t y_power) {
        const std::size_t total = x_power + y_power;
        return total * (total + 1) / 2 + y_power;
    };
    const std::size_t n = size();
    const auto degree = static_cast<std::size_t>(degree_);
    std::vector<double> result(n * n, 0.0);
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t total = 0; total <= degree; ++total)
            for (std::size_t j = 0; j <= total; ++j) {
                const double coefficient = coefficients_[k * n + index(total - j, j)];
                for (std::size_t p = 0; p <= total - j; ++p)
                    for (std::size_t q = 0; q <= j; ++q)
                        result[k * n + index(p, q)] += coefficient * legendre[total - j][p] * legendre[j][q];
            }
    return result;
}

} // namespace kinelux::geometry
