// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gltf_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

namespace kinelux::io {

namespace {

// Deviation of R^T R from 1 that single precision files show.
constexpr double rigid_tolerance = 1e-4;

bool near(const Mat3& a, const Mat3& b) {
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            if (!(std::abs(a[c][r] - b[c][r]) < rigid_tolerance)) return false;
    return true;
}

// The rotation in a matrix that turns, scales along its own axes and may mirror.
Quat rotation_in(Mat3 m) {
    if (glm::determinant(m) < 0.0) m = -m;
    const Vec3 x = glm::normalize(m[0]);
    const Vec3 y = glm::normalize(m[1] - glm::dot(m[1], x) * x);
    return glm::normalize(glm::quat_cast(Mat3(x, y, glm::cross(x, y))));
}

Mat4 local(const GltfNode& node) {
    if (node.matrix) return *node.matrix;
    return glm::translate(Mat4(1.0), node.translation) * glm::mat4_cast(node.rotation) *
           glm::scale(Mat4(1.0), node.scale);
}

Vec3 vector_of(const Quat& q) { return {q.x, q.y, q.z}; }

// Those of a track that is a spline, else zero.
std::pair<Quat, Quat> slopes_of(const GltfTrack* track, double time_s) {
    if (track != nullptr && track->interpolation == model::Interpolation::Cubic)
        return track->slopes_at(time_s);
    return {Quat(0.0, 0.0, 0.0, 0.0), Quat(0.0, 0.0, 0.0, 0.0)};
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
        return values[k] * (2.0 * s3 - 3.0 * s2 + 1.0) + out_tangents[k] * (length * (s3 - 2.0 * s2 + s)) +
               values[k + 1] * (3.0 * s2 - 2.0 * s3) + in_tangents[k + 1] * (length * (s3 - s2));
    }
    return is_rotation ? glm::slerp(values[k], values[k + 1], s) : values[k] * (1.0 - s) + values[k + 1] * s;
}

std::pair<Quat, Quat> GltfTrack::slopes_at(double time_s) const {
    const Quat zero(0.0, 0.0, 0.0, 0.0);
    const auto next = std::lower_bound(times_s.begin(), times_s.end(), time_s);
    if (next == times_s.end()) return {zero, zero};
    const auto k = static_cast<std::size_t>(next - times_s.begin());
    if (*next == time_s)
        return {k > 0 ? in_tangents[k] : zero, k + 1 < times_s.size() ? out_tangents[k] : zero};
    if (k == 0) return {zero, zero};
    const double length = times_s[k] - times_s[k - 1];
    const double s = (time_s - times_s[k - 1]) / length;
    const Quat slope = (values[k] - values[k - 1]) * (6.0 * s * (1.0 - s) / length) +
                       out_tangents[k - 1] * (1.0 - 4.0 * s + 3.0 * s * s) +
                       in_tangents[k] * (3.0 * s * s - 2.0 * s);
    return {slope, slope};
}

Mat4 GltfHierarchy::rest_world_from_node(int node) const {
    Mat4 world = local(nodes[static_cast<std::size_t>(node)]);
    for (int parent = nodes[static_cast<std::size_t>(node)].parent; parent >= 0;
         parent = nodes[static_cast<std::size_t>(parent)].parent)
        world = local(nodes[static_cast<std::size_t>(parent)]) * world;
    return world;
}

const GltfTrack* GltfHierarchy::track_of(int node, bool is_rotation) const {
    const auto found = std::find_if(tracks.begin(), tracks.end(), [&](const GltfTrack& track) {
        return track.node == node && track.is_rotation == is_rotation;
    });
    return found == tracks.end() ? nullptr : &*found;
}

int GltfHierarchy::mover_of(int node) const {
    for (; node >= 0; node = nodes[static_cast<std::size_t>(node)].parent)
        if (std::any_of(tracks.begin(), tracks.end(), [&](const GltfTrack& t) { return t.node == node; }))
            return node;
    return -1;
}

// A node's transform is P(t) T(t) R(t) S, with P its parents'. While they rest, what lies below it at rest is moved by
//     P T(t) R(t) R0^-1 T0^-1 P^-1,
// a turn by Q R(t) R0^-1 Q^-1 about P T0 and a shift by P's linear part times T(t) - T0, where Q is the rotation in P.
// That is linear in the values of the tracks, so splines stay the splines they are.
std::optional<model::Motion> GltfHierarchy::motion_of(int mover) const {
    const GltfNode& node = nodes[static_cast<std::size_t>(mover)];
    const Mat4 parents = node.parent >= 0 ? rest_world_from_node(node.parent) : Mat4(1.0);
    const Mat3 linear(parents);
    if (std::abs(glm::determinant(linear)) == 0.0) return std::nullopt;
    const Quat turn = rotation_in(linear);
    const auto turned = [&](const Quat& value) {
        return turn * (value * glm::conjugate(node.rotation)) * glm::conjugate(turn);
    };
    const GltfTrack* translations = track_of(mover, false);
    const GltfTrack* rotations = track_of(mover, true);

    model::Motion motion;
    motion.name = node.name;
    motion.pivot = Vec3(parents * glm::dvec4(node.translation, 1.0));
    std::set<double> times;
    bool splines = false;
    for (const GltfTrack* track : {translations, rotations}) {
        if (track == nullptr) continue;
        times.insert(track->times_s.begin(), track->times_s.end());
        splines = splines || track->interpolation == model::Interpolation::Cubic;
        (track->is_rotation ? motion.rotation_interpolation : motion.interpolation) = track->interpolation;
    }
    for (const double time_s : times) {
        const Quat rotation = rotations == nullptr ? node.rotation : rotations->at(time_s);
        const Vec3 place = translations == nullptr ? node.translation : vector_of(translations->at(time_s));
        const Mat3 own = glm::mat3_cast(glm::normalize(rotation * glm::conjugate(node.rotation)));
        const Mat3 seen = glm::mat3_cast(glm::normalize(turned(rotation)));
        if (!near(linear * own * glm::inverse(linear), seen)) return std::nullopt;
        motion.keyframes.push_back({time_s, linear * (place - node.translation), turned(rotation)});
        if (!splines) continue;
        const auto [shift_in, shift_out] = slopes_of(translations, time_s);
        const auto [turn_in, turn_out] = slopes_of(rotations, time_s);
        motion.keyframes.back().tangents.emplace(model::KeyTangents{
            linear * vector_of(shift_in), linear * vector_of(shift_out), turned(turn_in), turned(turn_out)});
    }
    return motion;
}

} // namespace kinelux::io
