// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kinelux::core {

enum class Verbosity { Quiet, Normal, Verbose };

/// How much is printed, and a file that receives every line as well (empty: none).
void configure_log(Verbosity verbosity, const std::filesystem::path& log_file);

void log_info(std::string_view line);    ///< to stderr unless quiet
void log_detail(std::string_view line);  ///< to stderr when verbose
void log_warning(std::string_view line); ///< "warning: ..." to stderr, always
std::vector<std::string> warnings();     ///< all that log_warning was given so far, in order

/// Progress of one step: a bar with the time left on a terminal, a plain line every 10 % (and at least 2 s apart) when
/// piped, nothing when quiet. advance() may be called from any thread.
class Progress {
public:
    Progress(std::string title, std::size_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    /// @param note  shown behind the bar, e.g. "frame 3/60, unshot 0.2 %"
    void advance(std::size_t steps = 1, std::string_view note = {});

private:
    struct State;
    State* state_;
};

} // namespace kinelux::core
