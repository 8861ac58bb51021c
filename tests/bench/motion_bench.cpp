// SPDX-License-Identifier: GPL-3.0-or-later
// The figures of docs/motion.md: what engines of motion cost against integrating anew what changes, and what they are off by.
//   motion_bench [FRAMES [ELEMENTS_PER_EDGE]]
#include <sys/resource.h>

#include <cstdlib>
#include <functional>

#include <fmt/format.h>

#include "core/log.h"
#include "support/moving_rooms.h"

using namespace kinelux;

namespace {

double cpu_ms() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto ms = [](const timeval& t) {
        return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
    };
    return ms(usage.ru_utime) + ms(usage.ru_stime);
}

struct Timed {
    double build_ms = 0.0, frames_ms = 0.0, largest = 0.0, mean = 0.0;
    std::uint64_t integrated = 0, changing = 0;
    std::size_t bytes = 0;
    std::vector<std::vector<double>> light;
};

Timed timed(support::PreparedRoom& room, const std::function<std::unique_ptr<motion::Engine>()>& make,
            const Timed* exact) {
    Timed result;
    double start = cpu_ms();
    const auto engine = make();
    result.build_ms = cpu_ms() - start;
    const auto frames = room.all_frames();
    for (const std::uint32_t frame : frames) {
        const auto poses = room.poses(frame);
        start = cpu_ms();
        const auto blocks = engine->advance(room.time(frame), poses);
        result.frames_ms += cpu_ms() - start;
        if (engine->prepared() == 0) result.integrated += blocks.computed;
        result.changing += blocks.pairs.size();
        result.light.push_back(room.light(blocks));
        if (exact == nullptr) continue;
        const double off = room.difference(result.light.back(), exact->light[frame]);
        result.largest = std::max(result.largest, off);
        result.mean += off / static_cast<double>(frames.size());
    }
    result.integrated += engine->prepared();
    result.bytes = engine->bytes();
    return result;
}

void row(const std::string& room, const std::string& engine, const Timed& timed, const Timed& exact,
         std::size_t frames) {
    const double count = static_cast<double>(frames);
    const double all = timed.build_ms + timed.frames_ms;
    fmt::print(
        "| {} | {} | {:.2f} | {:.1f}x | {:.3f} | {:.0f}x | {} | {:.1f}x | {:.3f} | {:.3f} | {:.2f} |\n", room,
        engine, all / count, exact.frames_ms / all, timed.frames_ms / count,
        exact.frames_ms / timed.frames_ms, timed.integrated,
        static_cast<double>(exact.integrated) / static_cast<double>(timed.integrated), 100.0 * timed.largest,
        100.0 * timed.mean, static_cast<double>(timed.bytes) / 1048576.0);
}

void measure(const std::string& name, support::MovingRoom made) {
    support::PreparedRoom room(std::move(made));
    const std::size_t frames = room.room.scene.time.frames;
    const Timed exact = timed(
        room, [&] { return room.exact(); }, nullptr);
    row(name, "exact", exact, exact, frames);
    for (const double tolerance : {1e-2, 1e-3}) {
        const std::string to = fmt::format(" {:g} %", 100.0 * tolerance);
        row(name, "online" + to,
            timed(
                room, [&] { return room.online(tolerance); }, &exact),
            exact, frames);
        row(name, "offline" + to,
            timed(
                room, [&] { return room.offline(tolerance); }, &exact),
            exact, frames);
    }
}

} // namespace

int main(int argc, char** argv) {
    const auto frames = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 60);
    const int n = argc > 2 ? std::atoi(argv[2]) : 3;
    core::configure_log(core::Verbosity::Quiet, {});
    fmt::print("CPU, all threads; ratios are to exact in the same run.\n"
               "| room | engine | ms/frame | gain | playback ms/frame | gain | integrated | fewer | max "
               "error % | mean "
               "error % | MiB |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    measure("sliding lamp", support::sliding_lamp(frames, n));
    measure("spinning lamp", support::turning_lamp(frames, false, 360.0, n));
    measure("orbiting lamp", support::turning_lamp(frames, true, 360.0, n));
    measure("sliding panel", support::sliding_panel(frames, n));
    measure("crossing movers", support::crossing_movers(frames, n));
    return 0;
}
