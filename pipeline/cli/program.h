// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace kinelux::cli {

/// Thrown where work stops because the user asked for it; the program ends with 128 + the signal (Ctrl-C: 130).
struct Interrupted {};

/// The signal that asked the program to stop (SIGINT, SIGTERM), 0 while there is none. A second one ends it at once.
int stop_signal();

/// Runs a program's body and turns what it throws into one line on stderr and an exit code: core::Error its own,
/// memory exhausted 6, anything else 1, said to be a bug; Interrupted 128 + signal with a line how to go on.
/// @param arguments  argv without the program's name
int run_program(const std::string& name, int argc, char** argv,
                const std::function<int(const std::vector<std::string>& arguments)>& body);

/// Where this program's executable lies; the other programs lie beside it.
std::filesystem::path program_folder();

/// Replaces this process by the program `name` beside it. @throws FileError  it cannot be started
[[noreturn]] void become_program(const std::string& name, const std::vector<std::string>& arguments);

/// Runs the program `name` beside this one and waits. A stop signal reaches it, too.
/// @return  its exit code; 128 + signal when it was stopped
/// @throws ResourceError  it was killed, or no process can be started
int call_program(const std::string& name, const std::vector<std::string>& arguments);

} // namespace kinelux::cli
