// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/vec.h"
#include "model/scene.h"

namespace kinelux::io {

struct ViewScriptOptions {
    Vec3 low{0.0}, high{0.0};     ///< bounds over all frames [m]
    double irradiance_high = 1.0; ///< end of the colour map [W/m2 or lx]
    double exposure = 0.0;        ///< of the Color array; 0 = there is none
};

/// The text of view.py: what is particular to the case as JSON, then the same program for every case.
std::string view_script(const model::Scene& scene, const ViewScriptOptions& options);

} // namespace kinelux::io
