// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of docs/theory.md, Solving: sweeps per frame by method, start and reflectance, and what channels cost. A
// closed room with a shelf, or with a wall; a lamp that slides by 1 % of the room's length per frame. --small: one row, few elements.
#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <string_view>

#include "core/log.h"
#include "core/parallel.h"
#include "support/sliding_lamp.h"

namespace {

using namespace kinelux;
using solve::Method;
using solve::Start;

constexpr std::uint32_t frames_before = 4; // until there are three frames to extrapolate from

double sweeps_per_frame(const support::SlidingLamp& lamp, double rho, const solve::SolveOptions& options) {
    solve::BlockOperator blocks(lamp.layout(), lamp.static_blocks());
    const std::vector<double> exitance = lamp.exitance(1);
    solve::TemporalSolver solver(1, lamp.reflectance(rho, 1), lamp.areas(), options);
    double sum = 0.0;
    const std::uint32_t frames = lamp.period() / 2 + 1;
    for (std::uint32_t f = 0; f < frames; ++f) {
        lamp.move(blocks, f);
        const double sweeps = solver.solve_frame(blocks, exitance).sweeps;
        sum += f >= frames_before ? sweeps : 0.0;
    }
    return sum / (frames - frames_before);
}

double cold_sweeps(const support::SlidingLamp& lamp, double rho, const solve::SolveOptions& options) {
    const solve::BlockOperator blocks(lamp.layout(), lamp.static_blocks());
    const std::vector<double> exitance = lamp.exitance(1), reflectance = lamp.reflectance(rho, 1);
    return solve::solve_system({blocks, 1, exitance, reflectance, lamp.areas()}, options, {}).sweeps;
}

// The first two eigenvalues of rho G, as the solver estimates them.
std::pair<double, double> eigenvalues(const support::SlidingLamp& lamp, double rho) {
    const solve::BlockOperator blocks(lamp.layout(), lamp.static_blocks());
    const std::vector<double> exitance = lamp.exitance(1), reflectance = lamp.reflectance(rho, 1);
    const solve::System system{blocks, 1, exitance, reflectance, lamp.areas()};
    std::size_t products = 0;
    const auto mode = solve::dominant_mode(system, {}, products);
    const double q = solve::returned_shares(system, mode).front();
    return {q, q * mode.second.front()};
}

void print_sweeps(const support::SlidingLamp& lamp, std::span<const double> reflectances) {
    std::printf("| rho | q, second | error | shooting: zero | last | extrapolated | Gauss-Seidel: cold | "
                "last | extrapolated "
                "| CG: cold | last | extrapolated |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const double rho : reflectances)
        for (const double tolerance : {1e-3, 1e-4, 1e-6}) {
            const auto [q, second] = eigenvalues(lamp, rho);
            std::printf("| %.2f | %.2f, %.2f | %.0e |", rho, q, second, tolerance);
            for (const Method method :
                 {Method::TemporalShooting, Method::GaussSeidel, Method::ConjugateGradients}) {
                solve::SolveOptions options{.method = method, .tolerance = tolerance, .max_sweeps = 1e5};
                if (method == Method::TemporalShooting) options.method = Method::Shooting;
                std::printf(" %.1f |", cold_sweeps(lamp, rho, options));
                options.method = method;
                for (const Start start : {Start::LastFrame, Start::Extrapolated}) {
                    options.start = start;
                    std::printf(" %.1f |", sweeps_per_frame(lamp, rho, options));
                }
            }
            std::printf("\n");
            std::fflush(stdout);
        }
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// CPU seconds of one call, the least of some rounds.
template <class Work>
double seconds_of(Work work) {
    double least = 1e9;
    for (int round = 0; round < 5; ++round) {
        const double start = cpu_seconds();
        int calls = 0;
        do {
            work();
            ++calls;
        } while (cpu_seconds() - start < 0.05);
        least = std::min(least, (cpu_seconds() - start) / calls);
    }
    return least;
}

void print_channels(int n, int degree) {
    const support::SlidingLamp lamp(2, n, degree, 0.1);
    const solve::BlockOperator blocks(lamp.layout(), lamp.static_blocks());
    core::set_thread_count(1);
    std::array<double, 2> product{}, gathers{};
    for (const std::size_t c : {std::size_t{0}, std::size_t{1}}) {
        const std::size_t channels = c == 0 ? 1 : 3;
        const std::vector<double> x(lamp.layout().unknowns() * channels, 0.5);
        std::vector<double> y(x.size());
        product[c] = seconds_of([&] { blocks.apply(channels, x, y); });
        gathers[c] = seconds_of([&] {
            for (std::size_t e = 0; e < lamp.layout().elements(); ++e)
                blocks.scatter(e, channels,
                               std::span(x).subspan(lamp.layout().offsets[e] * channels,
                                                    lamp.layout().count(e) * channels),
                               y);
        });
    }
    std::printf("| %d | %zu | %.3g | %.2f | %.3g | %.2f |\n", degree, lamp.layout().unknowns(),
                1e3 * product[0], product[1] / product[0], 1e3 * gathers[0], gathers[1] / gathers[0]);
}

} // namespace

int main(int argc, char** argv) {
    const bool small = argc > 1 && std::string_view(argv[1]) == "--small";
    core::configure_log(core::Verbosity::Quiet, {});
    const int poses = small ? 7 : 14;
    const support::SlidingLamp lamp(poses, small ? 1 : 3, 1, 0.02 * (poses - 1));
    constexpr std::array all{0.5, 0.7, 0.8, 0.9, 0.95, 0.99};
    print_sweeps(lamp, std::span(all).first(small ? 1 : all.size()));
    std::printf("\nTwo rooms:\n\n");
    const support::SlidingLamp walled(poses, small ? 1 : 3, 1, 0.02 * (poses - 1), support::Inside::Wall);
    print_sweeps(walled, std::span(all).first(small ? 1 : all.size()));
    std::printf("\n| degree | unknowns | product, 1 channel [ms] | 3 channels / 1 | all rows shot [ms] | 3 "
                "channels / 1 "
                "|\n|---|---|---|---|---|---|\n");
    for (const int degree : {0, 1, 2, 3}) print_channels(small ? 1 : 4 - degree / 2, degree);
}
