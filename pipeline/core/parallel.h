// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace kinelux::core {

/// Sets the number of worker threads of this process; 0 = all cores. Call once, before any work.
void set_thread_count(std::size_t threads);

/// Calls body(i) for i in [0, count), on all threads, in any order. The body may write only what belongs to i, so that
/// the result is the same at any thread count. The first exception thrown by a body is rethrown here.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

} // namespace kinelux::core
