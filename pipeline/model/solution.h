// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/coefficients.h"

namespace kinelux::model {

/// The light of one frame, as basis coefficients: vectors of unknowns x channels, channel fastest. A field's value at
/// a point of element e is the sum over its basis functions phi_k of coefficient[(offsets[e] + k) * channels + c].
struct FrameSolution {
    std::uint32_t frame = 0;
    double time_s = 0.0;
    std::vector<double> radiosity;           ///< B [W/m2 or lm/m2]
    std::vector<double> irradiance_direct;   ///< E straight from sources, G M [W/m2 or lx]
    std::vector<double> irradiance_indirect; ///< E by interreflection, G (B - M)
    double sweeps = 0.0;                     ///< solver work, in passes over all blocks
    double residual = 0.0;                   ///< ||M + rho G B - B|| / ||M|| [1]
    double unshot = 0.0;                     ///< flux not yet shot / flux emitted [1]
    double solver_error =
        0.0; ///< what the solver left of it: estimated relative L2 error over non-emitting elements [1]
    double error_estimate = 0.0;      ///< estimated relative L2 error of B over non-emitting elements [1]
    std::vector<float> element_error; ///< estimated RMS error of irradiance per element [W/m2 or lx]
    bool converged = true;
    std::uint32_t blocks_recomputed =
        0; ///< blocks integrated at this frame; other changing ones were expanded
    std::uint32_t blocks_changing =
        0;                ///< pairs whose block is not the static one; not part of the file's bytes
    double seconds = 0.0; ///< spent on this frame; not part of the file's bytes
};

struct Solution {
    UnknownLayout layout;
    std::uint32_t channels = 1;
    std::vector<FrameSolution> frames;
};

/// The slowest part of light's decay in a scene: what is left of any light after many bounces, per channel.
struct DominantMode {
    std::vector<double> shape;  ///< z, its irradiance; unknowns x channels, any scale
    std::vector<double> image;  ///< G rho z
    std::vector<double> margin; ///< per channel: what the eigenvalue may exceed its Rayleigh quotient by [1]
    std::vector<double>
        second; ///< per channel: the second eigenvalue of rho G by the first [1], 1 = as large
};

/// What the solver of the next frame needs of the frames before: vectors of unknowns x channels solved.
struct SolverState {
    std::vector<std::vector<double>>
        reflected; ///< R = B - M of up to three frames, newest first [W/m2 or lm/m2]
    std::vector<std::vector<double>> irradiance; ///< G R of the same, with G of the last frame [W/m2 or lx]
    DominantMode mode;                           ///< of the last frame
    std::uint32_t frames_since_exact = 0;        ///< frames in which irradiance was only added to

    bool empty() const { return mode.shape.empty(); }
};

/// An animation of which the first frames are solved.
struct SolutionSoFar {
    Solution solution;
    SolverState state;
};

} // namespace kinelux::model
