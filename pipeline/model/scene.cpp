// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/scene.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "core/error.h"

namespace kinelux::model {

namespace {

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// A rotation further from a unit quaternion than this is a mistake of ours or of the file, not rounding.
constexpr double unit_tolerance = 1e-6;

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
    throw core::OptionError(where + ": " + what);
}

void check_material(const Material& material, const Scene& scene) {
    const std::string where = "material '" + material.name + "'";
    const std::size_t channels = scene.channels.size();
    const auto expect_size = [&](const std::vector<double>& values, const char* what) {
        if (values.size() != channels)
            refuse(where, std::string(what) + " has " + std::to_string(values.size()) +
                              " values, the scene has " + std::to_string(channels) + " channels");
    };
    expect_size(material.reflectance, "reflectance");
    expect_size(material.exitance, "exitance");
    for (const double rho : material.reflectance)
        if (!(rho >= 0.0 && rho < 1.0))
            refuse(where, "reflectance " + std::to_string(rho) + " is not in [0, 1)");
    for (const double exitance : material.exitance)
        if (!(exitance >= 0.0 && std::isfinite(exitance)))
            refuse(where, "exitance " + std::to_string(exitance) + " is not a finite number >= 0");
    if (material.dimming && material.dimming->value >= scene.dimmings.size())
        refuse(where, "names dimming " + std::to_string(material.dimming->value) + " of " +
                          std::to_string(scene.dimmings.size()));
}

void check_dimming(const Dimming& dimming) {
    const std::string where = "dimming '" + dimming.name + "'";
    if (dimming.keys.empty()) refuse(where, "has no keyframe; give it at least one");
    if (dimming.interpolation == Interpolation::Cubic) refuse(where, "is interpolated by steps or linearly");
    for (std::size_t k = 0; k < dimming.keys.size(); ++k) {
        const Dimming::Key& key = dimming.keys[k];
        const std::string which = "keyframe " + std::to_string(k + 1);
        if (!std::isfinite(key.time_s)) refuse(where, which + " is not finite");
        if (!(key.factor >= 0.0 && std::isfinite(key.factor)))
            refuse(where, which + " has the factor " + std::to_string(key.factor) +
                              ", which is not a finite number >= 0");
        if (k > 0 && !(key.time_s > dimming.keys[k - 1].time_s))
            refuse(where, which + " is not later than the one before it; times must increase");
    }
}

void check_keyframe(const Keyframe& key, const Motion& motion, const std::string& where) {
    if (!std::isfinite(key.time_s) || !is_finite(key.translation)) refuse(where, "is not finite");
    // Between the given keys of a spline of quaternions lie others that are not unit, which is how they are joined.
    const double length = glm::length(key.rotation);
    const bool spline = motion.rotation_interpolation == Interpolation::Cubic;
    if (!(spline ? length > unit_tolerance && std::isfinite(length)
                 : std::abs(length - 1.0) <= unit_tolerance))
        refuse(where, "has a rotation that is not a unit quaternion");
    if (key.turn && !is_finite(*key.turn)) refuse(where, "has a turn that is not finite");
    if (key.tangents.has_value() != motion.keyframes.front().tangents.has_value())
        refuse(where, "has tangents where others of its motion have none, or none where they have");
    if (spline && !key.tangents) refuse(where, "has no tangents, which its spline of rotations needs");
}

void check_motion(const Motion& motion, const Scene& scene) {
    const std::string where = "motion '" + motion.name + "'";
    if (motion.keyframes.empty()) refuse(where, "has no keyframe; give it at least one");
    if (!is_finite(motion.pivot)) refuse(where, "its pivot is not finite");
    for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
        const std::string which = "keyframe " + std::to_string(k + 1);
        check_keyframe(motion.keyframes[k], motion, std::string(where).append(": ").append(which));
        if (k > 0 && !(motion.keyframes[k].time_s > motion.keyframes[k - 1].time_s))
            refuse(where, which + " is not later than the one before it; times must increase");
    }
    std::size_t ancestors = 0;
    for (auto parent = motion.parent; parent; parent = scene.motions[parent->value].parent) {
        if (parent->value >= scene.motions.size())
            refuse(where, "names parent " + std::to_string(parent->value) + " of " +
                              std::to_string(scene.motions.size()) + " motions");
        if (++ancestors > scene.motions.size()) refuse(where, "its parents lead round in a circle");
    }
}

void check_object(const Object& object, const Scene& scene) {
    const std::string where = "object '" + object.name + "'";
    if (object.mesh.triangles.empty()) throw core::GeometryError(where + " has no faces");
    check(object.mesh, where);
    for (const MaterialId material : object.mesh.materials)
        if (material.value >= scene.materials.size())
            throw core::GeometryError(where + " names material " + std::to_string(material.value) + " of " +
                                      std::to_string(scene.materials.size()));
    if (object.motion && object.motion->value >= scene.motions.size())
        refuse(where, "names motion " + std::to_string(object.motion->value) + " of " +
                          std::to_string(scene.motions.size()));
}

void check_meter(const GridMeter& meter, const Scene& scene) {
    const std::string where = "meter '" + meter.name + "'";
    if (!is_finite(meter.origin) || !is_finite(meter.edge_u) || !is_finite(meter.edge_v))
        refuse(where, "has a coordinate that is not finite");
    if (!(glm::length(glm::cross(meter.edge_u, meter.edge_v)) > 0.0))
        refuse(where, "edge_u and edge_v are parallel or zero; they must span a rectangle");
    if (meter.count_u < 1 || meter.count_v < 1) refuse(where, "needs at least one sensor along each edge");
    if (meter.motion && meter.motion->value >= scene.motions.size())
        refuse(where, "names motion " + std::to_string(meter.motion->value) + " of " +
                          std::to_string(scene.motions.size()));
}

void check_settings(const Scene& scene) {
    if (scene.channels.empty()) refuse("scene", "has no channels");
    if (!is_finite(scene.up) || !(glm::length(scene.up) > 0.0))
        refuse("scene", "its up direction is zero or not finite");
    const Accuracy& accuracy = scene.accuracy;
    if (!(accuracy.target > 0.0 && accuracy.target < 1.0)) refuse("accuracy", "target is not in (0, 1)");
    if (accuracy.degree && (*accuracy.degree < 0 || *accuracy.degree > 3))
        refuse("accuracy", "degree is not in 0..3");
    if (accuracy.element_size && !(*accuracy.element_size > 0.0 && std::isfinite(*accuracy.element_size)))
        refuse("accuracy", "element_size is not above 0");
    const TimeAxis& time = scene.time;
    if (!std::isfinite(time.start_s) || !std::isfinite(time.end_s) || time.frames < 1)
        refuse("time", "start_s and end_s must be finite and frames at least 1");
    if (time.end_s < time.start_s || (time.frames > 1 && time.end_s == time.start_s))
        refuse("time", "end_s must be later than start_s where there is more than one frame");
    const ExportOptions& exported = scene.exported;
    if (exported.cell_size && !(*exported.cell_size > 0.0 && std::isfinite(*exported.cell_size)))
        refuse("export", "cell_size is not above 0");
    for (const std::uint32_t frame : exported.frames.value_or(std::vector<std::uint32_t>{}))
        if (frame >= time.frames)
            refuse("export", "frame " + std::to_string(frame) + " does not exist; frames are 0.." +
                                 std::to_string(time.frames - 1));
}

} // namespace

std::string radiosity_unit(Quantity quantity) { return quantity == Quantity::Photometric ? "lm/m2" : "W/m2"; }
std::string irradiance_unit(Quantity quantity) { return quantity == Quantity::Photometric ? "lx" : "W/m2"; }
std::string flux_unit(Quantity quantity) { return quantity == Quantity::Photometric ? "lm" : "W"; }

bool Material::emits() const {
    return std::any_of(exitance.begin(), exitance.end(), [](double value) { return value > 0.0; });
}

double Dimming::factor_at(double time_s) const {
    const auto after = std::upper_bound(keys.begin(), keys.end(), time_s,
                                        [](double t, const Key& key) { return t < key.time_s; });
    if (after == keys.begin()) return keys.front().factor;
    const Key& before = *(after - 1);
    if (after == keys.end() || interpolation == Interpolation::Step) return before.factor;
    const double s = (time_s - before.time_s) / (after->time_s - before.time_s);
    return (1.0 - s) * before.factor + s * after->factor;
}

std::vector<std::vector<double>> exitances_at(const Scene& scene, double time_s) {
    std::vector<std::vector<double>> result;
    result.reserve(scene.materials.size());
    for (const Material& material : scene.materials) {
        result.push_back(material.exitance);
        if (!material.dimming) continue;
        const double factor = scene.dimmings[material.dimming->value].factor_at(time_s);
        for (double& value : result.back()) value *= factor;
    }
    return result;
}

bool exitance_changes(const Scene& scene) {
    const auto first = exitances_at(scene, scene.time.start_s);
    for (std::uint32_t frame = 1; frame < scene.time.frames && !scene.dimmings.empty(); ++frame)
        if (exitances_at(scene, scene.time.time_of_frame(frame)) != first) return true;
    return false;
}

double TimeAxis::time_of_frame(std::uint32_t frame) const {
    if (frames <= 1 || frame == 0) return start_s;
    if (frame + 1 >= frames) return end_s; // exactly, whatever the rounding before it
    return start_s + static_cast<double>(frame) * (end_s - start_s) / static_cast<double>(frames - 1);
}

void check(const Scene& scene) {
    check_settings(scene);
    for (const Material& material : scene.materials) check_material(material, scene);
    for (const Dimming& dimming : scene.dimmings) check_dimming(dimming);
    for (const Motion& motion : scene.motions) check_motion(motion, scene);
    for (const GridMeter& meter : scene.meters) check_meter(meter, scene);
    if (scene.objects.empty()) throw core::GeometryError("the scene has no objects");
    for (const Object& object : scene.objects) check_object(object, scene);
}

} // namespace kinelux::model
