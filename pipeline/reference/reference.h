// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "model/scene.h"

namespace kinelux::reference {

struct ReferenceOptions {
    std::uint32_t paths = 1024; ///< per point, 4..1e6
    std::uint64_t seed = 1;
    double noise =
        0.0; ///< RMS standard error / RMS of the readings to stop at [1]; paths are then the most. 0: all
};

/// A point of the scene's own triangles in world position at the time asked for.
struct SensorPoint {
    ObjectId object;
    std::uint32_t triangle = 0; ///< of that object's mesh
    Vec3 position;              ///< [m]
    Vec3 normal;                ///< unit, to the side that is judged
};

struct SensorReading {
    std::vector<double> irradiance;     ///< per channel [W/m2 or lx]
    std::vector<double> standard_error; ///< per channel, same unit
};

/// Points spread evenly over the area of all faces that do not emit, at a time; on faces that exchange light on both
/// sides, either side is judged with equal chance. A mesh without two_sided flags counts as two-sided unless its
/// material says Front. Where a face of another object lies in the same plane, looking the same way, neither has one:
/// which of them is seen there is not defined.
/// @param count  about how many, 1..1e6
std::vector<SensorPoint> sensor_points(const model::Scene& scene, double time_s, std::uint32_t count,
                                       std::uint64_t seed);

/// Unbiased irradiance by path tracing on the scene's own triangles: next-event estimation to the area sources at each
/// vertex, cosine-distributed bounces, Russian roulette by reflectance. Independent of patches, bases and blocks.
/// With a noise to stop at, all points are traced anew with more paths until it is reached: how many are taken depends
/// on earlier readings, and these are dropped, so that the mean stays unbiased. Same bytes at any thread count.
std::vector<SensorReading> trace_irradiance(const model::Scene& scene, double time_s,
                                            std::span<const SensorPoint> points,
                                            const ReferenceOptions& options);

/// RMS standard error / RMS of readings [1]; 0 where all is dark.
double noise_of(std::span<const SensorReading> readings);

/// How far values at the sensor points are from the reference.
struct Comparison {
    double relative_rms = 0.0;     ///< RMS difference / RMS of the reference, all points and channels [1]
    double relative_to_mean = 0.0; ///< RMS difference / mean of the reference [1]
    double reference_noise = 0.0;  ///< RMS standard error / RMS of the reference [1]
    double bias = 0.0;             ///< mean difference / mean of the reference [1]
    std::uint64_t points = 0;      ///< compared
    std::uint64_t unmatched = 0;   ///< without a value; they count nowhere else
};
/// @param values  one per sensor point, each with one value per channel
/// @throws GeometryError  sizes that do not fit
Comparison compare(std::span<const SensorReading> reference, std::span<const std::vector<double>> values);
Comparison compare(std::span<const SensorReading> reference,
                   std::span<const std::optional<std::vector<double>>> values);

} // namespace kinelux::reference
