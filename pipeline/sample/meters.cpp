// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>

#include "core/parallel.h"
#include "core/sequence.h"
#include "sample/gather.h"
#include "sample/sampler.h"

namespace kinelux::sample {

namespace {

constexpr std::uint64_t grid_stream = 0x67726964; ///< apart from the streams of display points

/// Integrals over an object's area, per channel.
struct ObjectSums {
    double area = 0.0;
    std::vector<double> flux, emitted, irradiance, flux_error, irradiance_error;
    explicit ObjectSums(std::size_t channels)
        : flux(channels),
          emitted(channels),
          irradiance(channels),
          flux_error(channels),
          irradiance_error(channels) {}
};

// Basis function 0 is 1 / sqrt(area), so sqrt(area) times its coefficient is the integral of the field.
void add_element(const geometry::ElementShape& element, std::size_t index,
                 std::span<const double> reflectance, std::span<const double> exitance,
                 const model::UnknownLayout& layout, const model::FrameSolution& frame, ObjectSums& sums) {
    const std::size_t channels = sums.flux.size();
    const double root = std::sqrt(element.area);
    const double error = index < frame.element_error.size()
                             ? static_cast<double>(frame.element_error[index]) * element.area
                             : 0.0;
    sums.area += element.area;
    for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t first = layout.offsets[index] * channels + c;
        sums.flux[c] += root * frame.radiosity[first];
        sums.emitted[c] += element.area * exitance[c];
        sums.irradiance[c] += root * (frame.irradiance_direct[first] + frame.irradiance_indirect[first]);
        sums.irradiance_error[c] += error;
        sums.flux_error[c] += reflectance[c] * error;
    }
}

/// Appends readings of one frame.
class Table {
public:
    Table(const model::Scene& scene, const model::FrameSolution& frame) : scene_(scene), frame_(frame) {}

    void add(const std::string& meter, const std::string& quantity, std::size_t channel, double value,
             const std::string& unit, double error) {
        readings_.push_back(
            {frame_.frame, frame_.time_s, meter, quantity, scene_.channels[channel], value, unit, error});
    }
    std::vector<model::MeterReading> take() { return std::move(readings_); }

private:
    const model::Scene& scene_;
    const model::FrameSolution& frame_;
    std::vector<model::MeterReading> readings_;
};

void add_objects(std::span<const geometry::ElementShape> elements, const model::Scene& scene,
                 const model::UnknownLayout& layout, const model::FrameSolution& frame, Table& table) {
    const std::size_t channels = scene.channels.size();
    const auto exitances = model::exitances_at(scene, frame.time_s);
    std::vector<ObjectSums> sums(scene.objects.size(), ObjectSums(channels));
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const std::uint32_t material = elements[e].material.value;
        add_element(elements[e], e, scene.materials[material].reflectance, exitances[material], layout, frame,
                    sums[elements[e].object.value]);
    }
    for (std::size_t o = 0; o < sums.size(); ++o) {
        const ObjectSums& s = sums[o];
        const std::string& name = scene.objects[o].name;
        for (std::size_t c = 0; c < channels && s.area > 0.0; ++c) {
            table.add(name, "radiosity", c, s.flux[c] / s.area, model::radiosity_unit(scene.quantity),
                      s.flux_error[c] / s.area);
            table.add(name, "irradiance", c, s.irradiance[c] / s.area, model::irradiance_unit(scene.quantity),
                      s.irradiance_error[c] / s.area);
            table.add(name, "flux", c, s.flux[c], model::flux_unit(scene.quantity), s.flux_error[c]);
            table.add(name, "emitted flux", c, s.emitted[c], model::flux_unit(scene.quantity), 0.0);
        }
    }
}

/// Irradiance at the points of a grid in its pose: points x (channels + 1), the last is the error estimate.
std::vector<std::vector<double>> grid_values(const model::GridMeter& grid, const geometry::Pose& pose,
                                             std::size_t number, std::size_t channels,
                                             const DirectLight& direct_light, const Gather& gather) {
    const Vec3 normal = pose.direction(glm::normalize(glm::cross(grid.edge_u, grid.edge_v)));
    std::vector<std::vector<double>> values(std::size_t{grid.count_u} * grid.count_v);
    core::parallel_for(values.size(), [&](std::size_t p) {
        const std::size_t column = p % grid.count_u, row = p / grid.count_u;
        const double u = (static_cast<double>(column) + 0.5) / grid.count_u;
        const double v = (static_cast<double>(row) + 0.5) / grid.count_v;
        const Receiver receiver{pose.point(grid.origin + u * grid.edge_u + v * grid.edge_v), normal};
        std::vector<double> direct(channels);
        direct_light.irradiance(receiver, core::mix(core::mix(grid_stream, number), p), direct);
        values[p] = gather.indirect(receiver);
        for (std::size_t c = 0; c < channels; ++c) values[p][c] += direct[c];
    });
    return values;
}

/// A quotient and its error by the relative errors of both; nothing where it is not defined.
void add_quotient(const std::string& meter, const std::string& quantity, std::size_t channel,
                  const Vec2& part, const Vec2& whole, Table& table) {
    if (!(whole.x > 0.0)) return;
    const double value = part.x / whole.x;
    table.add(meter, quantity, channel, value, "1", std::hypot(part.y, value * whole.y) / whole.x);
}

void add_grid(const model::GridMeter& grid, const std::vector<std::vector<double>>& values,
              std::size_t channels, const std::string& unit, Table& table) {
    for (std::size_t c = 0; c < channels; ++c) {
        double sum = 0.0, error = 0.0;
        std::size_t least = 0, greatest = 0;
        for (std::size_t p = 0; p < values.size(); ++p) {
            sum += values[p][c];
            error += values[p][channels];
            least = values[p][c] < values[least][c] ? p : least;
            greatest = values[p][c] > values[greatest][c] ? p : greatest;
        }
        const auto n = static_cast<double>(values.size());
        table.add(grid.name, "mean irradiance", c, sum / n, unit, error / n);
        table.add(grid.name, "least irradiance", c, values[least][c], unit, values[least][channels]);
        table.add(grid.name, "greatest irradiance", c, values[greatest][c], unit, values[greatest][channels]);
        // EN 12464-1: U0 = least / mean; U1 = least / greatest.
        const Vec2 lowest(values[least][c], values[least][channels]);
        const Vec2 highest(values[greatest][c], values[greatest][channels]);
        add_quotient(grid.name, "uniformity U0", c, lowest, {sum / n, error / n}, table);
        add_quotient(grid.name, "uniformity U1", c, lowest, highest, table);
        for (std::size_t p = 0; p < values.size(); ++p) {
            const std::string place =
                "[" + std::to_string(p % grid.count_u) + "," + std::to_string(p / grid.count_u) + "]";
            table.add(grid.name + place, "irradiance", c, values[p][c], unit, values[p][channels]);
        }
    }
}

} // namespace

std::vector<model::MeterReading> meter_readings(std::span<const geometry::ElementShape> rest_elements,
                                                const model::Scene& scene, const model::UnknownLayout& layout,
                                                const model::FrameSolution& frame,
                                                std::span<const geometry::Pose> poses,
                                                const visibility::Occluders& occluders,
                                                const DirectLightOptions& options) {
    Table table(scene, frame);
    add_objects(rest_elements, scene, layout, frame, table);
    if (scene.meters.empty()) return table.take();
    std::vector<geometry::ElementShape> elements;
    elements.reserve(rest_elements.size());
    for (const geometry::ElementShape& element : rest_elements)
        elements.push_back(geometry::moved(element, poses[element.object.value]));
    const DirectLight direct_light(elements, scene, frame.time_s, occluders, options);
    const Gather gather(elements, scene, layout, frame, occluders);
    for (std::size_t g = 0; g < scene.meters.size(); ++g) {
        const model::GridMeter& grid = scene.meters[g];
        if (grid.count_u == 0 || grid.count_v == 0) continue;
        const geometry::Pose pose =
            grid.motion ? geometry::pose_at(scene, *grid.motion, frame.time_s) : geometry::Pose{};
        const auto values = grid_values(grid, pose, g, scene.channels.size(), direct_light, gather);
        add_grid(grid, values, scene.channels.size(), model::irradiance_unit(scene.quantity), table);
    }
    return table.take();
}

} // namespace kinelux::sample
