// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/program.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/text.h"
#include "core/error.h"
#include "core/log.h"

namespace kinelux::cli {

namespace {

volatile std::sig_atomic_t stopped_by = 0;
volatile std::sig_atomic_t child = 0; ///< process id of the program we wait for; 0: none

extern "C" void note_stop(int signal, siginfo_t* info, void*) {
    // The handler is gone after the first signal (SA_RESETHAND), so that a second one ends the program.
    stopped_by = signal;
    if (child != 0) {
        // The terminal sends Ctrl-C to the child as well; kill does not.
        if (info->si_code == SI_USER) kill(static_cast<pid_t>(child), signal);
        return;
    }
    constexpr char text[] = "\nstopping after this step; once more stops at once\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text, sizeof text - 1);
}

void handle_stop_signals() {
    struct sigaction action {};
    action.sa_sigaction = note_stop;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_SIGINFO);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    std::signal(SIGPIPE, SIG_DFL);
}

/// One line on stderr and in the log file.
int fail(const std::string& name, const std::string& message, int code) {
    const std::string line = fmt::format("{}: {}", name, one_line(message));
    fmt::print(stderr, "{}\n", line);
    core::configure_log(core::Verbosity::Quiet, {});
    core::log_info(line);
    return code;
}

} // namespace

int stop_signal() { return stopped_by; }

std::filesystem::path program_folder() {
    return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

void become_program(const std::string& name, const std::vector<std::string>& arguments) {
    const std::string file = (program_folder() / name).string();
    std::vector<std::string> words{file};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execv(file.c_str(), argv.data());
    throw core::FileError(fmt::format("{}: cannot be started: {}", file, std::strerror(errno)));
}

int call_program(const std::string& name, const std::vector<std::string>& arguments) {
    std::fflush(nullptr); // what is still buffered must not be written twice
    const pid_t started = fork();
    if (started < 0)
        throw core::ResourceError(fmt::format("{} cannot be started: {}", name, std::strerror(errno)));
    if (started == 0) {
        try {
            become_program(name, arguments);
        } catch (const core::Error& error) {
            fmt::print(stderr, "{}: error: {}\n", name, error.what());
            _exit(static_cast<int>(error.code()));
        }
    }
    child = started;
    int status = 0;
    while (waitpid(started, &status, 0) < 0 && errno == EINTR) {
    }
    child = 0;
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    const int signal = WTERMSIG(status);
    if (signal == SIGINT || signal == SIGTERM) return 128 + signal;
    if (signal == SIGKILL)
        throw core::ResourceError(fmt::format("{} was killed, probably for lack of memory", name));
    throw std::runtime_error(fmt::format("{} ended by signal {}", name, signal));
}

int run_program(const std::string& name, int argc, char** argv,
                const std::function<int(const std::vector<std::string>& arguments)>& body) {
    handle_stop_signals();
    try {
        return body(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc));
    } catch (const Interrupted&) {
        return fail(name,
                    "interrupted; nothing that was there is lost. The same command takes this step up again, "
                    "kinelux run goes on with what is missing",
                    128 + stop_signal());
    } catch (const core::Error& error) {
        return fail(name, fmt::format("error: {}", error.what()), static_cast<int>(error.code()));
    } catch (const std::bad_alloc&) {
        return fail(
            name,
            "error: out of memory; ask for less accuracy (--accuracy) or larger elements (--element-size)",
            static_cast<int>(core::ExitCode::Resources));
    } catch (const std::exception& error) {
        return fail(
            name,
            fmt::format("internal error: {}; this is a bug of Kinelux, please report it with its input",
                        error.what()),
            static_cast<int>(core::ExitCode::Bug));
    } catch (...) {
        return fail(
            name, "internal error of unknown kind; this is a bug of Kinelux, please report it with its input",
            static_cast<int>(core::ExitCode::Bug));
    }
}

} // namespace kinelux::cli
