// SPDX-License-Identifier: GPL-3.0-or-later
// Ten thousand frames of a lamp that slides forth and back: errors must not add up.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "support/sliding_lamp.h"

namespace kinelux::solve {
namespace {

constexpr std::uint32_t frames = 10'000, hundred = 100;

const support::SlidingLamp& lamp() {
    static const support::SlidingLamp room(40, 1, 1);
    return room;
}

struct Truth {
    double rho;
    std::vector<double> exitance = lamp().exitance(1), reflectance = lamp().reflectance(rho, 1);
    std::vector<std::vector<double>> radiosity; ///< of one period, solved to rounding

    explicit Truth(double walls) : rho(walls) {
        BlockOperator blocks(lamp().layout(), lamp().static_blocks());
        for (std::uint32_t f = 0; f < lamp().period(); ++f) {
            lamp().move(blocks, f);
            radiosity.push_back(solve_system({blocks, 1, exitance, reflectance, lamp().areas()},
                                             {.method = Method::ConjugateGradients, .tolerance = 1e-12}, {})
                                    .radiosity);
        }
    }
    double error(const std::vector<double>& found, std::uint32_t frame) const {
        const auto& truth = radiosity[frame % lamp().period()];
        double difference = 0.0, size = 0.0;
        const auto& layout = lamp().layout();
        for (std::size_t e = 0; e < layout.elements(); ++e) {
            if (exitance[layout.offsets[e]] > 0.0) continue;
            for (std::size_t k = layout.offsets[e]; k < layout.offsets[e + 1]; ++k) {
                difference += (found[k] - truth[k]) * (found[k] - truth[k]);
                size += truth[k] * truth[k];
            }
        }
        return std::sqrt(difference / size);
    }
};

/// The largest error over the whole periods that end at frame 100 and at the last one.
struct Errors {
    double early = 0.0, late = 0.0;

    void note(std::uint32_t frame, double error) {
        if (frame <= hundred && frame + lamp().period() > hundred) early = std::max(early, error);
        if (frame + lamp().period() >= frames) late = std::max(late, error);
    }
};

Errors errors_of(const Truth& truth, const SolveOptions& options) {
    BlockOperator blocks(lamp().layout(), lamp().static_blocks());
    TemporalSolver solver(1, truth.reflectance, lamp().areas(), options);
    Errors errors;
    for (std::uint32_t f = 0; f < frames; ++f) {
        lamp().move(blocks, f);
        errors.note(f, truth.error(solver.solve_frame(blocks, truth.exitance).radiosity, f));
    }
    return errors;
}

// The paper's update as it is printed, with rho_i: what a frame leaves unshot is dropped by the next.
Errors errors_when_leftovers_are_dropped(const Truth& truth, double tolerance) {
    BlockOperator blocks(lamp().layout(), lamp().static_blocks());
    const auto& layout = lamp().layout();
    std::vector<double> radiosity = truth.radiosity.front(), unshot(radiosity.size()),
                        arriving(unshot.size());
    const auto reflect = [&](std::vector<double>& light) {
        for (std::size_t e = 0; e < layout.elements(); ++e)
            for (std::size_t k = layout.offsets[e]; k < layout.offsets[e + 1]; ++k)
                light[k] *= truth.reflectance[e];
    };
    Errors errors;
    lamp().move(blocks, 0);
    for (std::uint32_t f = 1; f < frames; ++f) {
        lamp().move(blocks, f);
        blocks.apply_change(1, radiosity, unshot);
        reflect(unshot);
        const auto norm = [](const std::vector<double>& x) {
            double sum = 0.0;
            for (const double value : x) sum += value * value;
            return std::sqrt(sum);
        };
        const double enough = tolerance * norm(radiosity) * (1.0 - truth.rho);
        while (norm(unshot) > enough) {
            std::size_t shooter = 0;
            for (std::size_t e = 1; e < layout.elements(); ++e)
                if (std::abs(unshot[layout.offsets[e]]) > std::abs(unshot[layout.offsets[shooter]]))
                    shooter = e;
            const std::size_t first = layout.offsets[shooter], count = layout.count(shooter);
            std::fill(arriving.begin(), arriving.end(), 0.0);
            blocks.scatter(shooter, 1, std::span<const double>(unshot).subspan(first, count), arriving);
            for (std::size_t k = first; k < first + count; ++k) {
                radiosity[k] += unshot[k];
                unshot[k] = 0.0;
            }
            reflect(arriving);
            for (std::size_t k = 0; k < unshot.size(); ++k) unshot[k] += arriving[k];
        }
        errors.note(f, truth.error(radiosity, f));
    }
    return errors;
}

void record(const std::string& name, const Errors& errors) {
    ::testing::Test::RecordProperty(name, std::to_string(errors.early) + " " + std::to_string(errors.late));
    std::printf("%s: error %.2e around frame 100, %.2e at the end\n", name.c_str(), errors.early,
                errors.late);
}

TEST(Drift, ten_thousand_frames_end_with_the_error_of_the_first_hundred) {
    for (const double rho : {0.8, 0.95}) {
        const Truth truth(rho);
        for (const auto& [name, method] : {std::pair("temporal shooting", Method::TemporalShooting),
                                           std::pair("Gauss-Seidel", Method::GaussSeidel),
                                           std::pair("conjugate gradients", Method::ConjugateGradients)})
            for (const Start start : {Start::LastFrame, Start::Extrapolated}) {
                const Errors errors = errors_of(truth, {.method = method, .tolerance = 1e-3, .start = start});
                record(name + std::string(start == Start::LastFrame ? " from the last frame" : "") +
                           ", rho " + std::to_string(rho),
                       errors);
                EXPECT_LE(errors.late, 1.5 * errors.early);
                EXPECT_LE(errors.late, 1e-3);
            }
    }
}

TEST(Drift, a_closed_loop_returns_to_its_first_frame) {
    const Truth truth(0.9);
    BlockOperator blocks(lamp().layout(), lamp().static_blocks());
    TemporalSolver solver(1, truth.reflectance, lamp().areas(), {.method = Method::TemporalShooting});
    for (std::uint32_t f = 0; f <= lamp().period(); ++f) {
        lamp().move(blocks, f);
        const auto frame = solver.solve_frame(blocks, truth.exitance);
        if (f % lamp().period() == 0) {
            EXPECT_LE(truth.error(frame.radiosity, 0), 1e-4);
        }
    }
}

TEST(Drift, dropping_what_is_left_unshot_drifts) {
    for (const double rho : {0.8, 0.95}) {
        const Errors errors = errors_when_leftovers_are_dropped(Truth(rho), 1e-3);
        record("leftover dropped, rho " + std::to_string(rho), errors);
        EXPECT_GT(errors.late, 3e-3);
    }
}

} // namespace
} // namespace kinelux::solve
