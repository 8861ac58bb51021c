// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.h"
#include "core/vec.h"
#include "model/mesh.h"

namespace kinelux::model {

/// What the numbers mean: radiosity in W/m2 and irradiance in W/m2, or lm/m2 and lx.
enum class Quantity : std::uint8_t { Radiometric, Photometric };

/// Unit of radiosity and exitance, "W/m2" or "lm/m2"; unit of irradiance, "W/m2" or "lx"; unit of flux, "W" or "lm".
std::string radiosity_unit(Quantity quantity);
std::string irradiance_unit(Quantity quantity);
std::string flux_unit(Quantity quantity);

/// Which sides of a face exchange light. Auto is resolved by clean: the outside of closed parts, both sides of sheets.
enum class Sides : std::uint8_t { Auto, Front, Both };

/// A Lambertian surface.
struct Material {
    std::string name;
    std::vector<double> reflectance; ///< rho per channel [1], in [0, 1)
    std::vector<double> exitance;    ///< M emitted per channel [W/m2 or lm/m2], >= 0
    Sides sides = Sides::Auto;
    std::optional<DimmingId> dimming = {}; ///< what scales the exitance in time; unset: steady

    bool emits() const; ///< whether any channel's exitance, not dimmed, is above 0
};

enum class Interpolation : std::uint8_t { Step, Linear, Cubic };

/// Rates of change on either side of a keyframe, for splines through given slopes.
struct KeyTangents {
    Vec3 translation_in{0.0}, translation_out{0.0};                         ///< [m/s]
    Quat rotation_in{0.0, 0.0, 0.0, 0.0}, rotation_out{0.0, 0.0, 0.0, 0.0}; ///< [1/s]
    bool operator==(const KeyTangents&) const = default;
};

/// One stop of a motion; the pose of a body relative to its rest position.
struct Keyframe {
    double time_s = 0.0;
    Vec3 translation{0.0};             ///< [m]
    Quat rotation{1.0, 0.0, 0.0, 0.0}; ///< about the motion's pivot
    std::optional<Vec3> turn =
        {}; ///< from the keyframe before: axis x angle [rad], which may be beyond a half turn;
            ///< unset: the shortest way
    std::optional<KeyTangents> tangents = {}; ///< on all keyframes of a motion or on none
    bool operator==(const Keyframe&) const = default;
};

/// A rigid path in time. Before the first and after the last keyframe the body rests.
struct Motion {
    std::string name;
    Interpolation interpolation =
        Interpolation::Linear;       ///< of translations; cubic: by tangents, else Catmull-Rom
    Vec3 pivot{0.0};                 ///< rotation centre in the rest position [m]
    std::vector<Keyframe> keyframes; ///< at least one, times strictly increasing
    Interpolation rotation_interpolation = Interpolation::Linear; ///< linear: slerp; cubic: by tangents
    std::optional<MotionId> parent = {}; ///< carries this motion: world = parent (own (rest)); no circles
};

/// The exitance of lamps in time, as a factor. Before the first and after the last key it keeps their factor.
struct Dimming {
    struct Key {
        double time_s = 0.0;
        double factor = 1.0; ///< on the exitance [1], >= 0
        bool operator==(const Key&) const = default;
    };
    std::string name;
    Interpolation interpolation = Interpolation::Linear; ///< step or linear
    std::vector<Key> keys;                               ///< at least one, times strictly increasing

    double factor_at(double time_s) const; ///< [1]
};

/// A body: one mesh in world metres at rest, optionally moving. Its faces name their materials.
struct Object {
    std::string name;
    Mesh mesh;
    std::optional<MotionId> motion;
    std::string source; ///< "file" or "file:group" it was read from, for messages
};

struct TimeAxis {
    double start_s = 0.0;
    double end_s = 0.0;
    std::uint32_t frames = 1; ///< >= 1; frame f is at start + f (end - start) / (frames - 1)

    double time_of_frame(std::uint32_t frame) const; ///< [s]
};

struct Accuracy {
    double target = 0.03;               ///< relative L2 error of radiosity per frame asked for [1], in (0, 1)
    std::optional<int> degree;          ///< of the polynomial bases, 0..3; unset: chosen from the target
    std::optional<double> element_size; ///< largest edge of an element [m]; unset: chosen from the target
};

/// A rectangle of sensor points, for meters.csv.
struct GridMeter {
    std::string name;
    Vec3 origin{0.0};                       ///< corner [m]
    Vec3 edge_u{1.0, 0.0, 0.0};             ///< [m]
    Vec3 edge_v{0.0, 1.0, 0.0};             ///< [m]; sensors face edge_u x edge_v
    std::uint32_t count_u = 1, count_v = 1; ///< points at cell centres
    std::optional<MotionId> motion = {};    ///< that carries the points and the way they face; unset: rests
};

/// A camera for pictures; unset parts are chosen from the scene's bounds.
struct View {
    std::optional<Vec3> eye;    ///< [m]
    std::optional<Vec3> target; ///< [m]
    Vec3 up{0.0, 0.0, 1.0};
    double field_of_view_deg = 45.0;
};

/// A switch that the user may take out of the plan's hands; unset: the plan decides.
struct EffectOverrides {
    std::optional<bool> interreflection;  ///< false: direct light only
    std::optional<bool> static_occlusion; ///< false: no shadows between bodies at rest
    std::optional<bool> moving_occlusion; ///< false: bodies that move cast no shadow
};

/// What the export stage writes.
struct ExportOptions {
    std::optional<double>
        cell_size; ///< largest edge of a displayed cell [m]; unset: chosen from the elements
    std::optional<std::vector<std::uint32_t>> frames; ///< numbers of the frames written; unset: all
};

/// Everything a case is computed from, as read: units applied (metres, z free), names resolved.
struct Scene {
    std::string title;
    Quantity quantity = Quantity::Radiometric;
    std::vector<std::string> channels; ///< names, at least one
    Vec3 up{0.0, 0.0, 1.0};
    Accuracy accuracy;
    TimeAxis time;
    EffectOverrides effects;
    View view;
    ExportOptions exported;
    std::vector<Material> materials;
    std::vector<Object> objects;
    std::vector<Motion> motions;
    std::vector<Dimming> dimmings;
    std::vector<GridMeter> meters;
    std::filesystem::path source; ///< the scene file or mesh it came from
};

/// Light emitted at a time, dimmed: one list over channels per material [W/m2 or lm/m2].
std::vector<std::vector<double>> exitances_at(const Scene& scene, double time_s);

/// Whether some lamp is dimmed to different factors in two frames.
bool exitance_changes(const Scene& scene);

/// Checks what every stage relies on: sizes per channel, reflectance in [0,1), ids in range, increasing keyframe times,
/// parents without circles, finite coordinates, at least one face.
/// @throws OptionError, GeometryError  naming the material, object, motion or dimming
void check(const Scene& scene);

} // namespace kinelux::model
