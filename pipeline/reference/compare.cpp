// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <string>

#include "core/error.h"
#include "reference/reference.h"

namespace kinelux::reference {

namespace {

struct Sums {
    double difference = 0.0, squared_difference = 0.0;
    double reference = 0.0, squared_reference = 0.0, squared_noise = 0.0;
    double count = 0.0;

    void add(const SensorReading& reading, const std::vector<double>& values) {
        if (values.size() != reading.irradiance.size())
            throw core::GeometryError(
                "a sensor point has " + std::to_string(values.size()) + " values but the reference has " +
                std::to_string(reading.irradiance.size()) + " channels; compare results of the same scene");
        for (std::size_t c = 0; c < values.size(); ++c) {
            const double d = values[c] - reading.irradiance[c];
            difference += d;
            squared_difference += d * d;
            reference += reading.irradiance[c];
            squared_reference += reading.irradiance[c] * reading.irradiance[c];
            squared_noise += reading.standard_error[c] * reading.standard_error[c];
            count += 1.0;
        }
    }
};

void require_same_size(std::size_t readings, std::size_t values) {
    if (readings != values)
        throw core::GeometryError("the reference has " + std::to_string(readings) + " sensor points but " +
                                  std::to_string(values) + " values were given");
}

Comparison comparison_of(const Sums& sums) {
    Comparison result;
    if (sums.squared_reference > 0.0) {
        result.relative_rms = std::sqrt(sums.squared_difference / sums.squared_reference);
        result.reference_noise = std::sqrt(sums.squared_noise / sums.squared_reference);
    }
    if (sums.reference > 0.0) {
        result.relative_to_mean = std::sqrt(sums.squared_difference * sums.count) / sums.reference;
        result.bias = sums.difference / sums.reference;
    }
    return result;
}

} // namespace

Comparison compare(std::span<const SensorReading> reference, std::span<const std::vector<double>> values) {
    require_same_size(reference.size(), values.size());
    Sums sums;
    for (std::size_t i = 0; i < reference.size(); ++i) sums.add(reference[i], values[i]);
    Comparison result = comparison_of(sums);
    result.points = reference.size();
    return result;
}

Comparison compare(std::span<const SensorReading> reference,
                   std::span<const std::optional<std::vector<double>>> values) {
    require_same_size(reference.size(), values.size());
    Sums sums;
    std::uint64_t matched = 0;
    for (std::size_t i = 0; i < reference.size(); ++i)
        if (values[i]) {
            sums.add(reference[i], *values[i]);
            ++matched;
        }
    Comparison result = comparison_of(sums);
    result.points = matched;
    result.unmatched = reference.size() - matched;
    return result;
}

} // namespace kinelux::reference
