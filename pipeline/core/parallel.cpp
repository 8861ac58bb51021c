// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parallel.h"

#include <memory>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

namespace kinelux::core {

void set_thread_count(std::size_t threads) {
    static std::unique_ptr<tbb::global_control> control;
    control.reset();
    if (threads > 0)
        control =
            std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, threads);
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
    tbb::parallel_for(std::size_t{0}, count, body);
}

} // namespace kinelux::core
