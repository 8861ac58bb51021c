// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

// Private to io.
namespace kinelux::io {

/// What a foreign reader may take.
struct ImportLimits {
    double cpu_s = 60.0;     ///< [s]
    double memory_gib = 4.0; ///< of address space beyond what is in use [GiB]
};

/// Runs an import in a child process first and drops what it makes: readers of other projects crash, hang or eat all memory
/// on broken files, and none of that may reach this process. The work is done twice: results of any size need no second form to
/// come back in. What the import throws is not its concern: the import
/// that follows throws it again.
/// @param what  for messages, the file's name
/// @throws FileError  it crashed, took longer or more memory than allowed
void rehearse(const std::string& what, const ImportLimits& limits, const std::function<void()>& import);

} // namespace kinelux::io
