// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "model/patch_set.h"

namespace kinelux::validation {

/// A scene whose form factor from patch 0 to patch 1 is known; further patches stand between.
struct ClosedFormCase {
    std::string name, source;
    model::PatchSet set;
    double expected;  ///< [1]
    double tolerance; ///< relative, at an accuracy of 1e-6
};

/// All planar cases of docs/validation.md, in its order.
std::vector<ClosedFormCase> closed_form_cases();

/// The factor from patch 0 to patch 1 through coefficients::compute_coefficients and form_factors, one element per
/// patch. @param accuracy  of blocks [1]
double computed_factor(const ClosedFormCase& item, double accuracy);

} // namespace kinelux::validation
