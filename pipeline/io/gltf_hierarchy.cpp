// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gltf_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

namespace kinelux::io {

namespace {

// Linear pieces per interval where a path is not a straight or cubic one between the keys.
constexpr int pieces_per_interval = 16;

// Deviation of R^T R from 1 that single precision files show.
constexpr double rigid_tolerance = 1e-4;

bool is_rigid(const Mat3& m) {
    const Mat3 deviation = glm::transpose(m) * m - Mat3(1.0);
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            if (!(std::abs(deviation[c][r]) < rigid_tolerance)) return false;
    return glm::determinant(m) > 0.0;
}

std::vector<double> subdivided(const std::set<double>& times) {
    std::vector<double> result;
    for (auto next = times.begin(); next != times.end();) {
        const double start = *next++;
        result.push_back(start);
        for (int i = 1; next != times.end() && i < pieces_per_interval; ++i)
            result.push_back(start + (*next - start) * i / pieces_per_interval);
    }
    return result;
}

} // namespace

Quat GltfTrack::at(double time_s) const {
    const auto after = std::upper_bound(times_s.begin(), times_s.end(), time_s);
    if (after == times_s.begin()) return values.front();
    const auto k = static_cast<std::size_t>(after - times_s.begin()) - 1;
    if (after == times_s.end() || interpolation == model::Interpolation::Step) return values[k];
    const double length = times_s[k + 1] - times_s[k];
    const double s = (time_s - times_s[k]) / length;
    if (interpolation == model::Interpolation::Cubic) {
        // Hermite spline of the glTF 2.0 specification, appendix C.
        const double s2 = s * s, s3 = s2 * s;
        const Quat value = values[k] * (2.0 * s3 - 3.0 * s2 + 1.0) +
                           out_tangents[k] * (length * (s3 - 2.0 * s2 + s)) +
                           values[k + 1] * (3.0 * s2 - 2.0 * s3) + in_tangents[k + 1] * (length * (s3 - s2));
        return is_rotation ? glm::normalize(value) : value;
    }
    return is_rotation ? glm::slerp(values[k], values[k + 1], s) : values[k] * (1.0 - s) + values[k + 1] * s;
}

Mat4 GltfHierarchy::local_at(int node, std::optional<double> time_s) const {
    const GltfNode& self = nodes[static_cast<std::size_t>(node)];
    if (self.matrix) return *self.matrix;
    Vec3 translation = self.translation;
    Quat rotation = self.rotation;
    for (const GltfTrack& track : tracks) {
        if (!time_s || track.node != node) continue;
        const Quat value = track.at(*time_s);
        if (track.is_rotation)
            rotation = value;
        else
            translation = {value.x, value.y, value.z};
    }
    return glm::translate(Mat4(1.0), translation) * glm::mat4_cast(rotation) *
           glm::scale(Mat4(1.0), self.scale);
}

Mat4 GltfHierarchy::world_at(int node, std::optional<double> time_s) const {
    Mat4 world = local_at(node, time_s);
    for (int parent = nodes[static_cast<std::size_t>(node)].parent; parent >= 0;
         parent = nodes[static_cast<std::size_t>(parent)].parent)
        world = local_at(parent, time_s) * world;
    return world;
}

Mat4 GltfHierarchy::rest_world_from_node(int node) const { return world_at(node, std::nullopt); }

int GltfHierarchy::mover_of(int node) const {
    for (; node >= 0; node = nodes[static_cast<std::size_t>(node)].parent)
        if (std::any_of(tracks.begin(), tracks.end(), [&](const GltfTrack& t) { return t.node == node; }))
            return node;
    return -1;
}

std::optional<model::Motion> GltfHierarchy::motion_of(int mover, std::vector<std::string>& notes) const {
    model::Motion motion;
    motion.name = nodes[static_cast<std::size_t>(mover)].name;
    std::set<double> key_times;
    std::set<model::Interpolation> kinds;
    std::size_t moving_nodes = 0;
    for (int node = mover; node >= 0; node = nodes[static_cast<std::size_t>(node)].parent) {
        bool moves = false;
        for (const GltfTrack& track : tracks) {
            if (track.node != node) continue;
            moves = true;
            key_times.insert(track.times_s.begin(), track.times_s.end());
            kinds.insert(track.interpolation);
        }
        moving_nodes += moves ? 1 : 0;
    }
    const bool in_pieces =
        kinds.size() > 1 || (moving_nodes > 1 && *kinds.begin() != model::Interpolation::Step);
    motion.interpolation = in_pieces ? model::Interpolation::Linear : *kinds.begin();
    if (!in_pieces && motion.interpolation == model::Interpolation::Cubic)
        notes.push_back("animation of node '" + motion.name +
                        "': the tangents of its cubic splines are replaced by those of a Catmull-Rom spline");

    const Mat4 rest = rest_world_from_node(mover);
    if (std::abs(glm::determinant(Mat3(rest))) == 0.0) return std::nullopt;
    const Mat4 node_from_world = glm::inverse(rest);
    motion.pivot = Vec3(rest[3]);
    for (const double time :
         in_pieces ? subdivided(key_times) : std::vector<double>(key_times.begin(), key_times.end())) {
        const Mat4 world_from_rest = world_at(mover, time) * node_from_world;
        const Mat3 rotation(world_from_rest);
        if (!is_rigid(rotation)) return std::nullopt;
        const Vec3 moved(world_from_rest * glm::dvec4(motion.pivot, 1.0));
        motion.keyframes.push_back({time, moved - motion.pivot, glm::normalize(glm::quat_cast(rotation))});
    }
    return motion;
}

} // namespace kinelux::io
