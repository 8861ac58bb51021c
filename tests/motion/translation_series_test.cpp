// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/translation_series.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "motion/staircase.h"

namespace kinelux::motion {
namespace {

double kernel(const Vec3& r, const Vec3& n_i, const Vec3& n_j) {
    const double r2 = glm::dot(r, r);
    return -glm::dot(n_i, r) * glm::dot(n_j, r) / (std::numbers::pi * r2 * r2);
}

class Random {
public:
    explicit Random(unsigned seed) : generator_(seed) { printf("seed %u\n", seed); }
    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(generator_);
    }
    Vec3 direction() {
        std::normal_distribution<double> normal;
        return glm::normalize(Vec3(normal(generator_), normal(generator_), normal(generator_)));
    }
    Vec3 perpendicular_to(const Vec3& v) { return glm::normalize(glm::cross(v, direction())); }

private:
    std::mt19937 generator_;
};

// What a truncated series of K(r + p p0) is off by, in units of 1/(pi r^2).
double series_error(const Vec3& r, const Vec3& n_i, const Vec3& n_j, const Vec3& p0, double p, int order) {
    std::array<double, most_orders + 1> terms;
    translation_terms(r, n_i, n_j, p0, std::span(terms).first(static_cast<std::size_t>(order) + 1));
    double sum = 0.0;
    for (int n = order; n >= 0; --n) sum = sum * p + terms[static_cast<std::size_t>(n)];
    return std::abs(sum - kernel(r + p * p0, n_i, n_j)) * std::numbers::pi * glm::dot(r, r);
}

TEST(TranslationSeries, error_stays_below_the_proven_tail_for_any_geometry) {
    Random random(1);
    constexpr double rounding = 1e-12;
    for (int trial = 0; trial < 20000; ++trial) {
        const double distance = std::pow(10.0, random.between(-3, 3)), t = random.between(0.0, 0.98);
        const Vec3 r = distance * random.direction();
        const Vec3 p0 = trial % 4 == 0 ? random.perpendicular_to(r) : random.direction();
        const int order = static_cast<int>(random.between(1.0, 16.999));
        const double error = series_error(r, random.direction(), random.direction(), p0, t * distance, order);
        EXPECT_LE(error, series_tail(t, order) * (1.0 + 1e-9) + rounding / ((1 - t) * (1 - t)))
            << "trial " << trial << " t " << t << " order " << order;
    }
}

TEST(TranslationSeries, terms_of_the_inversion_have_length_r_to_the_minus_n_minus_1) {
    Random random(2);
    for (int trial = 0; trial < 2000; ++trial) {
        const double distance = std::pow(10.0, random.between(-2, 2));
        const Vec3 r = distance * random.direction();
        const Vec3 p0 = trial % 3 == 0 ? random.perpendicular_to(r) : random.direction();
        std::array<std::array<double, most_orders + 1>, 3> v;
        for (int c = 0; c < 3; ++c) {
            Vec3 axis(0.0);
            axis[c] = 1.0;
            inversion_terms(r, p0, axis, v[static_cast<std::size_t>(c)]);
        }
        for (std::size_t n = 0; n <= most_orders; ++n) {
            const double length = std::hypot(v[0][n], v[1][n], v[2][n]);
            EXPECT_NEAR(length * std::pow(distance, static_cast<double>(n) + 1.0), 1.0, 2e-13) << n;
        }
    }
}

TEST(TranslationSeries, coefficients_are_at_most_n_plus_1_over_pi_r_to_the_n_plus_2_and_reach_it) {
    Random random(3);
    std::array<double, most_orders + 1> terms;
    const auto scaled = [&](std::size_t n, double distance) {
        return std::abs(terms[n]) * std::numbers::pi * std::pow(distance, static_cast<double>(n) + 2.0) /
               (static_cast<double>(n) + 1.0);
    };
    for (int trial = 0; trial < 5000; ++trial) {
        const double distance = random.between(0.1, 10.0);
        translation_terms(distance * random.direction(), random.direction(), random.direction(),
                          random.direction(), terms);
        for (std::size_t n = 0; n <= most_orders; ++n) EXPECT_LE(scaled(n, distance), 1.0 + 1e-12);
    }
    const Vec3 e(0.0, 0.6, 0.8);
    translation_terms(3.0 * e, e, e, -e, terms);
    for (std::size_t n = 0; n <= most_orders; ++n) EXPECT_NEAR(scaled(n, 3.0), 1.0, 1e-12) << n;
}

TEST(TranslationSeries, a_move_perpendicular_to_the_connection_gives_numbers) {
    // The printed xi_n divide by alpha = p0.r, which is exactly 0 here.
    std::array<double, 7> terms;
    const Vec3 n_i = glm::normalize(Vec3(0.3, 0.1, 1.0)), n_j = glm::normalize(Vec3(0.2, -0.4, -1.0));
    translation_terms(Vec3(0, 0, 2), n_i, n_j, Vec3(1, 0, 0), terms);
    for (const double term : terms) EXPECT_TRUE(std::isfinite(term));
    EXPECT_LT(series_error(Vec3(0, 0, 2), n_i, n_j, Vec3(1, 0, 0), 0.2, 6), series_tail(0.1, 6));
}

TEST(TranslationSeries, condition_14_admits_the_errors_of_the_table_in_mathematics) {
    // Largest errors at t = 1 / (1 + sqrt 2) by order; the paper's order is 6. They are met: at normals and direction along r.
    struct Row {
        int order;
        double admitted;
    };
    const double t = 1.0 / (1.0 + std::numbers::sqrt2);
    const Vec3 e(0.0, 0.0, 1.0);
    for (const Row& row :
         {Row{2, 5.7e-1}, Row{4, 1.4e-1}, Row{6, 3.1e-2}, Row{8, 6.6e-3}, Row{12, 2.7e-4}, Row{16, 9.9e-6}}) {
        const double met = series_error(e, e, e, -e, t, row.order);
        printf("order %2d: (14) admits %.3g\n", row.order, met);
        EXPECT_NEAR(met, row.admitted, 0.03 * row.admitted) << row.order;
        EXPECT_NEAR(met, series_tail(t, row.order), 1e-9 * met + 1e-14) << "the tail is sharp";
    }
    EXPECT_TRUE(series_condition(1.0, 0.999 * t));
    EXPECT_FALSE(series_condition(1.0, 1.001 * t));
}

TEST(TranslationSeries, the_tail_reaches_as_far_as_the_table_in_mathematics_says) {
    struct Row {
        int order;
        double reach_1e_2, reach_1e_4;
    };
    for (const Row& row : {Row{2, .128, .029}, Row{4, .259, .108}, Row{6, .358, .193}, Row{8, .432, .268}}) {
        EXPECT_NEAR(series_tail(row.reach_1e_2, row.order), 1e-2, 4e-4) << row.order;
        EXPECT_NEAR(series_tail(row.reach_1e_4, row.order), 1e-4, 6e-6) << row.order;
    }
}

TEST(TranslationSeries, sums_over_several_axes_stay_below_their_bound) {
    Random random(4);
    const auto& axes = predefined_axes();
    double closest = 0.0;
    for (int trial = 0; trial < 5000; ++trial) {
        const Vec3 r = random.direction(), n_i = random.direction(), n_j = random.direction();
        const int order = 1 + trial % 8;
        std::array<double, axis_count> shares{};
        std::array<double, most_orders + 1> terms;
        Vec3 moved(0.0);
        double sum = kernel(r, n_i, n_j);
        for (int used = 0; used < 1 + trial % 4; ++used) {
            const auto a = static_cast<std::size_t>(random.between(0.0, 12.999));
            if (shares[a] > 0.0) continue;
            const double step = random.between(-0.2, 0.2);
            translation_terms(r, n_i, n_j, axes[a],
                              std::span(terms).first(static_cast<std::size_t>(order) + 1));
            for (int n = 1; n <= order; ++n) sum += terms[static_cast<std::size_t>(n)] * std::pow(step, n);
            shares[a] = std::abs(step);
            moved += step * axes[a];
        }
        const double bound = staircase_tail(shares, glm::length(moved), order);
        const double error = std::abs(sum - kernel(r + moved, n_i, n_j)) * std::numbers::pi;
        EXPECT_LE(error, bound + 1e-12) << trial;
        if (bound > 1e-6) closest = std::max(closest, error / bound);
    }
    printf("largest share of the bound %.2f\n", closest);
    EXPECT_GT(closest, 0.1) << "a bound that nothing comes near says little";
}

} // namespace
} // namespace kinelux::motion
