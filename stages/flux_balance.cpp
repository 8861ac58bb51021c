// SPDX-License-Identifier: GPL-3.0-or-later
#include "flux_balance.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/log.h"

namespace kinelux::stages {

FluxBalance flux_balance(const model::Scene& scene, std::span<const MaterialId> materials,
                         std::span<const double> areas, const model::UnknownLayout& layout,
                         const model::FrameSolution& frame) {
    const std::size_t channels = scene.channels.size();
    const auto exitance = model::exitances_at(scene, frame.time_s);
    FluxBalance balance;
    double leaving = 0.0, arriving = 0.0;
    for (std::size_t e = 0; e < areas.size(); ++e)
        for (std::size_t c = 0; c < channels; ++c) {
            // The first basis function is 1 / sqrt(area): its coefficient has the mean.
            const std::size_t mean = layout.offsets[e] * channels + c;
            const double root = std::sqrt(areas[e]);
            const double here = root * (frame.irradiance_direct[mean] + frame.irradiance_indirect[mean]);
            const double sent = root * frame.radiosity[mean];
            balance.emitted += exitance[materials[e].value][c] * areas[e];
            balance.absorbed += (1.0 - scene.materials[materials[e].value].reflectance[c]) * here;
            balance.negative -= std::min(sent, 0.0);
            leaving += sent;
            arriving += here;
        }
    balance.lost = leaving - arriving;
    balance.unsolved = balance.emitted - balance.absorbed - balance.lost;
    return balance;
}

void report_balances(const model::Scene& scene, std::span<const MaterialId> materials,
                     std::span<const double> areas, const model::Solution& solution, cli::Stage& stage) {
    const double allowed = scene.accuracy.target;
    const std::string unit = model::flux_unit(scene.quantity);
    stage.record().set("flux_unit", unit);
    for (std::size_t f = 0; f < solution.frames.size(); ++f) {
        const model::FrameSolution& frame = solution.frames[f];
        const FluxBalance balance = flux_balance(scene, materials, areas, solution.layout, frame);
        const std::string key = fmt::format("frames/{}/", f);
        stage.record().set(key + "emitted_flux", balance.emitted);
        stage.record().set(key + "absorbed_flux", balance.absorbed);
        stage.record().set(key + "lost_flux", balance.lost);
        stage.record().set(key + "unsolved_flux", balance.unsolved);
        stage.record().set(key + "negative_flux", balance.negative);
        const auto warn = [&](double flux, const char* what) {
            if (flux > allowed * balance.emitted)
                core::log_warning(fmt::format("frame {}: {:.2g} {} of {:.2g} {} emitted {}", frame.frame,
                                              flux, unit, balance.emitted, unit, what));
        };
        warn(std::abs(balance.unsolved), "are not accounted for: lower --tolerance");
        warn(-balance.lost, "are made of nothing: surfaces lie on each other twice, or blocks are far off");
        warn(balance.negative, "leave elements whose radiosity is below 0: raise the accuracy");
    }
}

} // namespace kinelux::stages
