// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "model/plan.h"

namespace kinelux::cli {

/// A plan for people: effect, decision, error risked, reason; then degrees, unknowns, blocks and memory.
std::string plan_table(const model::Plan& plan);

} // namespace kinelux::cli
