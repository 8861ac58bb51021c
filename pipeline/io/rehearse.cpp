// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/rehearse.h"

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <new>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "core/error.h"

namespace kinelux::io {

namespace {

constexpr int out_of_memory = 77; // exit status of the child
constexpr double patience = 4.0;  // wall time over CPU time, on a machine that is busy

// Address space in use [B]; 0 where that is not known.
double address_space() {
    std::ifstream in("/proc/self/statm");
    double pages = 0.0;
    in >> pages;
    return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void limit(int resource, double value) {
    const auto most = static_cast<rlim_t>(value);
    const rlimit limits{most, most + 1}; // at the hard limit of CPU time the kernel kills without a word
    setrlimit(static_cast<__rlimit_resource_t>(resource), &limits);
}

[[noreturn]] void run_child(const ImportLimits& limits, const std::function<void()>& import) {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    limit(RLIMIT_CORE, 0.0);
    limit(RLIMIT_CPU, std::ceil(limits.cpu_s));
    alarm(
        static_cast<unsigned>(std::ceil(patience * limits.cpu_s))); // for one that waits and computes nothing
#if !defined(__SANITIZE_ADDRESS__)                                  // which takes terabytes of address space
    constexpr double gib = 1024.0 * 1024.0 * 1024.0;
    limit(RLIMIT_AS, address_space() + limits.memory_gib * gib);
#endif
    for (const int fault : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGALRM, SIGXCPU})
        std::signal(fault, SIG_DFL);
    try {
        import();
    } catch (const std::bad_alloc&) {
        _exit(out_of_memory);
    } catch (...) {
        // thrown again by the import that follows
    }
    _exit(0);
}

} // namespace

void rehearse(const std::string& what, const ImportLimits& limits, const std::function<void()>& import) {
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child < 0)
        throw core::FileError(fmt::format("{}: no process can be started to try the import in", what));
    if (child == 0) run_child(limits, import);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    const std::string advice = "; repair it, or export it in another format";
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGALRM))
        throw core::FileError(
            fmt::format("{}: reading it takes longer than {:.0f} s{}", what, limits.cpu_s, advice));
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
        throw core::FileError(
            fmt::format("{}: reading it was killed, for want of memory or by CPU time{}", what, advice));
    if (WIFSIGNALED(status))
        throw core::FileError(
            fmt::format("{}: the library that reads this format crashes on it (signal {}){}", what,
                        WTERMSIG(status), advice));
    if (WIFEXITED(status) && WEXITSTATUS(status) == out_of_memory)
        throw core::FileError(
            fmt::format("{}: reading it takes more than {:g} GiB{}", what, limits.memory_gib, advice));
}

} // namespace kinelux::io
