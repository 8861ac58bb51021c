// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/log.h"
#include "core/parallel.h"
#include "core/sequence.h"
#include "geometry/pose.h"
#include "reference/world.h"
#include "visibility/occluders.h"

// E(x) is the mean over paths of sum_vertices throughput x (light drawn + light found), where each vertex draws one
// point on the emitters, with density p per area, and sends one cosine-distributed bounce, which finds a point of an
// emitter with density g = cos cos' / (pi r^2). Both see the same light, so each is weighted with the balance heuristic
// own / (p + g): a drawn point counts M g / p x p / (p + g), a found one M x g / (p + g). Both are M g / (p + g) <= M,
// so points next to a lamp have a small variance too.

namespace kinelux::reference {

namespace {

using visibility::Occluders;

constexpr std::uint32_t batches = 16; ///< independent scrambles per point; their spread is the standard error
constexpr std::uint32_t first_paths = 64;             ///< of a point before noise is looked at
constexpr double fewest_more = 1.5, most_more = 16.0; ///< times the paths of a round in the next

enum Stream : std::uint64_t { LightStream, BounceStream, RouletteStream, StreamCount };

double largest(const std::vector<double>& values) {
    return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

/// The faces that emit, drawn with a probability proportional to area x exitance.
class Lights {
public:
    /// @param exitances  per material, at the time asked for
    Lights(const World& world, const std::vector<std::vector<double>>& exitances) {
        for (const WorldTriangle& triangle : world.triangles) {
            const double exitance = largest(exitances[triangle.material.value]);
            if (!(exitance > 0.0) || !(triangle.area > 0.0)) continue;
            faces_.push_back(&triangle);
            cumulative_.push_back((cumulative_.empty() ? 0.0 : cumulative_.back()) +
                                  triangle.area * exitance);
        }
    }

    struct Draw {
        const WorldTriangle* face;
        Vec3 position;
    };
    bool empty() const { return faces_.empty(); }
    Draw draw(Vec2 square) const {
        const double flux = square.x * cumulative_.back();
        const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, flux);
        const auto i = static_cast<std::size_t>(found - cumulative_.begin());
        const double before = i > 0 ? cumulative_[i - 1] : 0.0;
        square.x = std::clamp((flux - before) / (cumulative_[i] - before), 0.0, 1.0); // stays stratified
        return {faces_[i], faces_[i]->point(square)};
    }
    /// Density per area of a point on a face with this exitance [1/m2].
    double density(const std::vector<double>& exitance) const {
        return largest(exitance) / cumulative_.back();
    }

private:
    std::vector<const WorldTriangle*> faces_;
    std::vector<double> cumulative_; ///< area x largest exitance
};

/// Where a path stands.
struct Vertex {
    Vec3 position;
    Vec3 normal; ///< to the lit side
};

// cos cos' / (pi r^2) between a vertex and a point of a face that emits; 0 where they do not face each other.
double exchange(const Vertex& from, const Vec3& to, const WorldTriangle& face) {
    const Vec3 way = to - from.position;
    const double r2 = glm::dot(way, way);
    const double here = glm::dot(way, from.normal);
    const double there = face.both_sides ? std::abs(glm::dot(way, face.normal)) : -glm::dot(way, face.normal);
    if (!(here > 0.0) || !(there > 0.0) || !(r2 > 0.0)) return 0.0;
    return here * there / (std::numbers::pi * r2 * r2);
}

Vec3 cosine_direction(const Vec3& normal, const Vec2& square) {
    const double radius = std::sqrt(square.x), angle = 2.0 * std::numbers::pi * square.y;
    const Vec3 helper = std::abs(normal.x) < 0.6 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
    const Vec3 u = glm::normalize(glm::cross(helper, normal));
    const Vec3 v = glm::cross(normal, u);
    return radius * std::cos(angle) * u + radius * std::sin(angle) * v + std::sqrt(1.0 - square.x) * normal;
}

class Tracer {
public:
    Tracer(const model::Scene& scene, double time_s)
        : scene_(scene),
          world_(scene, time_s),
          exitances_(model::exitances_at(scene, time_s)),
          lights_(world_, exitances_),
          occluders_(visibility::bodies_of(scene)) {
        occluders_.set_poses(geometry::object_poses(scene, time_s));
    }

    SensorReading read(const SensorPoint& point, std::uint64_t seed, std::uint32_t paths) const;

private:
    struct Path {
        std::uint32_t index;             ///< in its batch
        std::uint64_t seed;              ///< of its batch
        std::vector<double> throughput;  ///< per channel
        std::vector<double>& irradiance; ///< per channel, added to
    };
    void trace(Vertex vertex, Path& path) const;
    void add_light(const Vertex& vertex, std::uint32_t bounce, Path& path) const;
    bool bounce(Vertex& vertex, std::uint32_t bounce, Path& path) const;
    static Vec2 sample(const Path& path, std::uint32_t bounce, Stream stream) {
        return core::sobol_2d(path.index, core::mix(path.seed, bounce * StreamCount + stream));
    }

    const model::Scene& scene_;
    World world_;
    std::vector<std::vector<double>> exitances_; ///< per material
    Lights lights_;
    Occluders occluders_;
};

void Tracer::add_light(const Vertex& vertex, std::uint32_t bounce, Path& path) const {
    const Lights::Draw light = lights_.draw(sample(path, bounce, LightStream));
    const double g = exchange(vertex, light.position, *light.face);
    if (!(g > 0.0) || occluders_.occluded(vertex.position, light.position)) return;
    const std::vector<double>& exitance = exitances_[light.face->material.value];
    const double weight = g / (lights_.density(exitance) + g);
    for (std::size_t c = 0; c < path.irradiance.size(); ++c)
        path.irradiance[c] += path.throughput[c] * exitance[c] * weight;
}

// Moves on to the surface seen in a random direction; false where the path ends.
bool Tracer::bounce(Vertex& vertex, std::uint32_t bounce, Path& path) const {
    const Vec3 direction = cosine_direction(vertex.normal, sample(path, bounce, BounceStream));
    const auto hit = occluders_.first_hit(vertex.position, direction);
    if (!hit) return false;
    const WorldTriangle& face = world_.at(hit->body, hit->triangle);
    const bool front = glm::dot(hit->normal, direction) < 0.0;
    if (!front && !face.both_sides) return false;
    const model::Material& material = scene_.materials[face.material.value];
    const std::vector<double>& exitance = exitances_[face.material.value];
    if (largest(exitance) > 0.0) {
        const double g = exchange(vertex, hit->position, face);
        const double weight = g / (lights_.density(exitance) + g);
        for (std::size_t c = 0; c < path.irradiance.size() && g > 0.0; ++c)
            path.irradiance[c] += path.throughput[c] * exitance[c] * weight;
    }
    const double survival = largest(material.reflectance);
    if (!(sample(path, bounce, RouletteStream).x < survival)) return false;
    for (std::size_t c = 0; c < path.throughput.size(); ++c)
        path.throughput[c] *= material.reflectance[c] / survival;
    vertex = {hit->position, front ? hit->normal : -hit->normal};
    return true;
}

void Tracer::trace(Vertex vertex, Path& path) const {
    for (std::uint32_t b = 0;; ++b) {
        add_light(vertex, b, path);
        if (!bounce(vertex, b, path)) return;
    }
}

/// Mean over the batches of each channel, and the standard error of that mean.
SensorReading reading_of(const std::vector<std::vector<double>>& sums, std::uint32_t paths_per_batch) {
    const std::size_t channels = sums.front().size();
    const auto n = static_cast<double>(sums.size());
    SensorReading reading{std::vector<double>(channels, 0.0), std::vector<double>(channels, 0.0)};
    for (std::size_t c = 0; c < channels; ++c) {
        double mean = 0.0, squares = 0.0;
        for (const std::vector<double>& sum : sums) mean += sum[c] / paths_per_batch;
        mean /= n;
        for (const std::vector<double>& sum : sums)
            squares += (sum[c] / paths_per_batch - mean) * (sum[c] / paths_per_batch - mean);
        reading.irradiance[c] = mean;
        reading.standard_error[c] = std::sqrt(squares / (n * (n - 1.0)));
    }
    return reading;
}

SensorReading Tracer::read(const SensorPoint& point, std::uint64_t seed, std::uint32_t paths) const {
    const std::size_t channels = scene_.channels.size();
    const std::uint32_t used_batches = std::clamp(paths, 2u, batches);
    const std::uint32_t all = std::max(1u, (paths + used_batches - 1) / used_batches);
    std::vector<std::vector<double>> sums(used_batches, std::vector<double>(channels, 0.0));
    if (lights_.empty()) return reading_of(sums, all);
    for (std::uint32_t batch = 0; batch < used_batches; ++batch) {
        Path path{0, core::mix(seed, batch), std::vector<double>(channels, 1.0), sums[batch]};
        for (path.index = 0; path.index < all; ++path.index) {
            std::fill(path.throughput.begin(), path.throughput.end(), 1.0);
            trace({point.position, point.normal}, path);
        }
    }
    return reading_of(sums, all);
}

// The paths that the noise of a round says are needed (it falls at least with their root), and a little more.
std::uint32_t next_paths(std::uint32_t paths, double noise, const ReferenceOptions& options) {
    const double ratio = 1.1 * (noise / options.noise) * (noise / options.noise);
    return static_cast<std::uint32_t>(std::min(static_cast<double>(options.paths),
                                               std::ceil(paths * std::clamp(ratio, fewest_more, most_more))));
}

} // namespace

std::vector<SensorReading> trace_irradiance(const model::Scene& scene, double time_s,
                                            std::span<const SensorPoint> points,
                                            const ReferenceOptions& options) {
    const Tracer tracer(scene, time_s);
    std::vector<SensorReading> readings(points.size());
    std::uint64_t seed = options.seed;
    std::uint32_t paths = options.noise > 0.0 ? std::min(first_paths, options.paths) : options.paths;
    for (;; seed = core::mix(seed, paths)) {
        core::Progress progress("tracing the reference", points.size());
        core::parallel_for(points.size(), [&](std::size_t i) {
            readings[i] = tracer.read(points[i], core::mix(seed, i), paths);
            progress.advance();
        });
        const double noise = options.noise > 0.0 ? noise_of(readings) : 0.0;
        if (paths == options.paths || noise <= options.noise) return readings;
        paths = next_paths(paths, noise, options);
    }
}

double noise_of(std::span<const SensorReading> readings) {
    double noise = 0.0, all = 0.0;
    for (const SensorReading& reading : readings)
        for (std::size_t c = 0; c < reading.irradiance.size(); ++c) {
            noise += reading.standard_error[c] * reading.standard_error[c];
            all += reading.irradiance[c] * reading.irradiance[c];
        }
    return all > 0.0 ? std::sqrt(noise / all) : 0.0;
}

} // namespace kinelux::reference
