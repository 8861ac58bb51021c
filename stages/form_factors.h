// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace kinelux::stages {

/// `kinelux form-factors SCENE|CASE`: a CSV of form factors, and their row sums. @return  exit code
int form_factors_command(const std::vector<std::string>& arguments);

} // namespace kinelux::stages
