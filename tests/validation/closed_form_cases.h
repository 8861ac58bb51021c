// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/patch_set.h"

namespace kinelux::validation {

/// A scene whose form factor from one group of patches to another is known; all other patches stand between.
struct ClosedFormCase {
    std::string name, source;
    model::PatchSet set;
    double expected;                     ///< [1]
    double tolerance;                    ///< relative, at an accuracy of 1e-6
    std::vector<std::uint32_t> group_of; ///< group of each patch; empty: each is its own
    std::uint32_t to = 1;                ///< the group that receives; 0 sends
    bool open = false;                   ///< nothing stands between
};

/// All cases of docs/validation.md, in its order.
std::vector<ClosedFormCase> closed_form_cases();

/// Those with curved patches: spheres, cylinders, discs.
std::vector<ClosedFormCase> curved_form_cases();

/// The factor from group 0 to group `to` through coefficients::compute_coefficients and form_factors, one element per
/// patch. @param accuracy  of blocks [1]
double computed_factor(const ClosedFormCase& item, double accuracy);

} // namespace kinelux::validation
