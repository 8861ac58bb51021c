// SPDX-License-Identifier: GPL-3.0-or-later
#include "coefficients/light_estimate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/hierarchy.h"

namespace kinelux::coefficients {

namespace {

constexpr int bounces = 4;          ///< of light through links: what comes later is spread evenly
constexpr double least_share = 0.1; ///< of the even light, for what near elements send

double mean(const std::vector<double>& channels) {
    return std::accumulate(channels.begin(), channels.end(), 0.0) / static_cast<double>(channels.size());
}

// Of each material in the frames: what a lamp is worth that is dimmed now and then.
std::vector<std::vector<double>> brightest_exitances(const model::Scene& scene) {
    auto result = model::exitances_at(scene, scene.time.start_s);
    for (std::uint32_t frame = 1; frame < scene.time.frames && !scene.dimmings.empty(); ++frame) {
        const auto now = model::exitances_at(scene, scene.time.time_of_frame(frame));
        for (std::size_t m = 0; m < result.size(); ++m) result[m] = std::max(result[m], now[m]);
    }
    return result;
}

} // namespace

LightEstimate even_light(std::span<const geometry::ElementShape> elements, const model::Scene& scene) {
    LightEstimate light;
    const auto brightest = brightest_exitances(scene);
    double area = 0.0, flux = 0.0, reflected = 0.0;
    for (const geometry::ElementShape& element : elements) {
        const model::Material& material = scene.materials[element.material.value];
        light.exitance.push_back(mean(brightest[element.material.value]));
        light.reflectance.push_back(mean(material.reflectance));
        area += element.area;
        flux += element.area * light.exitance.back();
        reflected += element.area * light.reflectance.back();
    }
    const bool dark = !(flux > 0.0);
    const double irradiance = dark ? 1.0 : flux / (area - reflected);
    light.irradiance.assign(elements.size(), irradiance);
    for (std::size_t e = 0; e < elements.size(); ++e)
        light.radiosity.push_back(dark ? 1.0 : light.exitance[e] + light.reflectance[e] * irradiance);
    return light;
}

LightEstimate linked_light(const LightEstimate& even, std::span<const geometry::ElementShape> elements,
                           const model::Hierarchy& hierarchy) {
    LightEstimate light = even;
    const auto& offsets = hierarchy.layout.offsets;
    const std::size_t unknowns = offsets[elements.size()];
    for (int bounce = 0; bounce < bounces; ++bounce) {
        std::vector<double> sent(unknowns, 0.0), arrived(unknowns, 0.0);
        for (std::size_t e = 0; e < elements.size(); ++e)
            sent[offsets[e]] = light.radiosity[e] * std::sqrt(elements[e].area);
        model::add_link_transport(hierarchy, 1, sent, arrived);
        for (std::size_t e = 0; e < elements.size(); ++e) {
            light.irradiance[e] =
                std::max(arrived[offsets[e]] / std::sqrt(elements[e].area), least_share * even.irradiance[e]);
            light.radiosity[e] = light.exitance[e] + light.reflectance[e] * light.irradiance[e];
        }
    }
    return light;
}

} // namespace kinelux::coefficients
