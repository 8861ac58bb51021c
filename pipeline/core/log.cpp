// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/log.h"

#include <atomic>
#include <chrono>
#include <fstream>
#include <mutex>

#include <fmt/format.h>
#include <unistd.h>

#include "core/error.h"

namespace kinelux::core {

namespace {

using Clock = std::chrono::steady_clock;

struct Log {
    std::mutex mutex;
    Verbosity verbosity = Verbosity::Normal;
    std::ofstream file;
    std::vector<std::string> warnings;
};

Log& the_log() {
    static Log log;
    return log;
}

void write_line(std::string_view line, bool shown) {
    Log& log = the_log();
    const std::scoped_lock lock(log.mutex);
    if (shown) fmt::print(stderr, "{}\n", line);
    if (log.file) log.file << line << std::endl;
}

} // namespace

void configure_log(Verbosity verbosity, const std::filesystem::path& log_file) {
    Log& log = the_log();
    log.verbosity = verbosity;
    if (log_file.empty()) return;
    log.file.open(log_file, std::ios::app);
    if (!log.file)
        throw FileError(fmt::format("{}: cannot be opened for the log; name a writable file with --log-file",
                                    log_file.string()));
}

void log_info(std::string_view line) { write_line(line, the_log().verbosity != Verbosity::Quiet); }
void log_detail(std::string_view line) { write_line(line, the_log().verbosity == Verbosity::Verbose); }
void log_warning(std::string_view line) {
    write_line(fmt::format("warning: {}", line), true);
    Log& log = the_log();
    const std::scoped_lock lock(log.mutex);
    log.warnings.emplace_back(line);
}

std::vector<std::string> warnings() {
    Log& log = the_log();
    const std::scoped_lock lock(log.mutex);
    return log.warnings;
}

struct Progress::State {
    State(std::string shown_title, std::size_t steps) : title(std::move(shown_title)), total(steps) {}

    std::string title;
    std::size_t total;
    std::atomic<std::size_t> done{0};
    std::mutex mutex;
    Clock::time_point started = Clock::now();
    Clock::time_point shown = Clock::now();
    std::size_t shown_tenth = 0;
    bool bar = isatty(STDERR_FILENO) == 1;
    bool bar_shown = false;

    void show(std::size_t now_done, std::string_view note) {
        const auto now = Clock::now();
        const double seconds = std::chrono::duration<double>(now - started).count();
        const double since_shown = std::chrono::duration<double>(now - shown).count();
        const double share = total > 0 ? static_cast<double>(now_done) / static_cast<double>(total) : 1.0;
        const double left = share > 0 ? seconds * (1.0 - share) / share : 0.0;
        const auto text = fmt::format("{:<13}{:5.1f} %  {:.0f} s left  {}", title, 100.0 * share, left, note);
        if (bar && since_shown > 0.1) {
            fmt::print(stderr, "\r\x1b[K{}", text);
            std::fflush(stderr);
            bar_shown = true;
            shown = now;
        } else if (const auto tenth = static_cast<std::size_t>(share * 10.0);
                   !bar && tenth > shown_tenth && since_shown > 2.0) {
            fmt::print(stderr, "{}\n", text);
            shown_tenth = tenth;
            shown = now;
        }
    }
};

Progress::Progress(std::string title, std::size_t total) : state_(new State(std::move(title), total)) {}

Progress::~Progress() {
    if (state_->bar_shown) fmt::print(stderr, "\r\x1b[K");
    delete state_;
}

void Progress::advance(std::size_t steps, std::string_view note) {
    const std::size_t done = state_->done.fetch_add(steps) + steps;
    if (the_log().verbosity == Verbosity::Quiet) return;
    const std::unique_lock lock(state_->mutex, std::try_to_lock);
    if (lock) state_->show(done, note);
}

} // namespace kinelux::core
