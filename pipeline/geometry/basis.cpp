// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/error.h"

namespace kinelux::geometry {

namespace {

// A function whose part orthogonal to the earlier ones is below this share of it is not determined by the domain: its
// coefficients would be so large that their rounding shows in the basis.
constexpr double rank_tolerance = 1e-5;
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

} // namespace kinelux::geometry
