// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "core/error.h"
#include "io/scene_objects.h"

namespace kinelux::io {

namespace {

// Axes that differ by less than this are one axis; and how near to a half turn the shortest way is not sure.
constexpr double same_axis = 1e-12, half_turn_margin_deg = 1e-6;
constexpr double half_turn_deg = 180.0;

// The turn between two keyframes whose axes are one: what the angles say, which may be several times round. Nothing where
// the axes differ or the shortest way is meant anyway.
std::optional<Vec3> long_turn(const AxisTurn& from, const AxisTurn& to) {
    const bool from_rest = from.degrees == 0.0, to_rest = to.degrees == 0.0;
    if (from_rest && to_rest) return std::nullopt;
    const Vec3 axis = to_rest ? from.axis : to.axis;
    const double along = from_rest ? 1.0 : glm::dot(from.axis, axis);
    if (std::abs(along) < 1.0 - same_axis) return std::nullopt;
    const double degrees = to.degrees - (along < 0.0 ? -from.degrees : from.degrees);
    if (std::abs(degrees) < half_turn_deg - half_turn_margin_deg) return std::nullopt;
    return glm::radians(degrees) * axis;
}

void set_rotations(const std::vector<AxisTurn>& turns, std::vector<model::Keyframe>& keyframes) {
    for (std::size_t k = 0; k < keyframes.size(); ++k) {
        keyframes[k].rotation = turns[k].rotation();
        if (k > 0) keyframes[k].turn = long_turn(turns[k - 1], turns[k]);
    }
}

model::Interpolation interpolation_of(const SceneSection& section) {
    const std::string word = section.text("interpolation").value_or("linear");
    return word == "step"    ? model::Interpolation::Step
           : word == "cubic" ? model::Interpolation::Cubic
                             : model::Interpolation::Linear;
}

} // namespace

Quat AxisTurn::rotation() const {
    if (degrees == 0.0) return {1.0, 0.0, 0.0, 0.0};
    return glm::angleAxis(glm::radians(degrees), axis);
}

void SceneBuilder::add_motions() {
    for (const SceneSection* section : document_.all("motion")) {
        const std::string name = *section->text("name");
        if (motions_.count(name) > 0)
            document_.fail(section->line_of("name"), "there are two motions '" + name + "'");
        const int ways = (section->has("csv") ? 1 : 0) + (section->has("gltf_node") ? 1 : 0) +
                         (section->children.empty() ? 0 : 1);
        if (ways != 1)
            document_.fail(section->line,
                           "motion '" + name + "' needs one of: [[motion.keyframe]], 'csv', 'gltf_node'");
        for (const char* key : {"pivot", "interpolation"})
            if (section->has("gltf_node") && section->has(key))
                document_.fail(section->line_of(key),
                               "'" + std::string(key) + "' of a glTF node comes from its file");
        MotionEntry entry;
        entry.section = section;
        if (!section->has("gltf_node")) {
            entry.id = MotionId(scene_.motions.size());
            scene_.motions.push_back(keyframed(*section));
            motion_names_.insert(name);
        }
        motions_[name] = std::move(entry);
    }
}

model::Motion SceneBuilder::keyframed(const SceneSection& section) const {
    model::Motion motion;
    motion.name = *section.text("name");
    motion.interpolation = interpolation_of(section);
    if (motion.interpolation == model::Interpolation::Step)
        motion.rotation_interpolation = model::Interpolation::Step;
    motion.pivot = metres_ * section.vec3("pivot").value_or(Vec3(0.0));
    motion.keyframes = section.has("csv") ? keyframes_from_csv(section) : keyframes_of(section);
    return motion;
}

std::vector<model::Keyframe> SceneBuilder::keyframes_of(const SceneSection& section) const {
    std::vector<model::Keyframe> keyframes;
    std::vector<AxisTurn> turns;
    for (const SceneSection& stop : section.children) {
        model::Keyframe key;
        key.time_s = *stop.number("time_s");
        key.translation = metres_ * stop.vec3("translation").value_or(Vec3(0.0));
        turns.push_back(turn_of(stop));
        if (!keyframes.empty() && !(key.time_s > keyframes.back().time_s))
            document_.fail(stop.line_of("time_s"), "keyframes must be in the order of increasing time_s");
        keyframes.push_back(key);
    }
    set_rotations(turns, keyframes);
    return keyframes;
}

NumberTable SceneBuilder::read_csv(const SceneSection& section,
                                   const std::vector<std::vector<std::string>>& headers) const {
    const std::filesystem::path file = path_of(*section.text("csv"));
    const std::string where = document_.where(section.line_of("csv")) + ": ";
    try {
        tree_.require(file);
        NumberTable table = read_number_table(file, headers);
        table.name.insert(0, where);
        return table;
    } catch (const core::FileError& error) {
        throw core::FileError(where + error.what());
    }
}

std::vector<model::Keyframe> SceneBuilder::keyframes_from_csv(const SceneSection& section) const {
    const std::vector<std::string> shifts{"time_s", "x", "y", "z"};
    std::vector<std::string> both = shifts;
    both.insert(both.end(), {"axis_x", "axis_y", "axis_z", "angle_deg"});
    const NumberTable table = read_csv(section, {shifts, both});
    std::vector<model::Keyframe> keyframes;
    std::vector<AxisTurn> turns;
    for (const auto& [line, values] : table.rows) {
        model::Keyframe key;
        key.time_s = values[0];
        key.translation = metres_ * Vec3(values[1], values[2], values[3]);
        keyframes.push_back(key);
        turns.emplace_back();
        if (values.size() == shifts.size() || values[7] == 0.0) continue;
        const Vec3 axis(values[4], values[5], values[6]);
        if (!(glm::length(axis) > 0.0)) table.fail(line, "the axis of the turn has no direction");
        turns.back() = {glm::normalize(axis), values[7]};
    }
    set_rotations(turns, keyframes);
    return keyframes;
}

SceneBuilder::MotionEntry& SceneBuilder::entry_of(const SceneSection& section, const std::string& key) {
    const std::string name = *section.text(key);
    const auto found = motions_.find(name);
    if (found != motions_.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& [own, entry] : motions_) known.push_back(own);
    const auto meant = nearest(name, known);
    document_.fail(section.line_of(key), "there is no motion '" + name +
                                             "'; there are: " + (known.empty() ? "none" : short_list(known)) +
                                             (meant ? "; did you mean '" + *meant + "'?" : ""));
}

MotionId SceneBuilder::motion_of(const SceneSection& section, const std::string& file,
                                 const ImportedMeshes& meshes, const Placement& placement) {
    MotionEntry& entry = entry_of(section, "motion");
    entry.used = true;
    return entry.id ? *entry.id : node_motion(entry, section, file, meshes, placement);
}

MotionId SceneBuilder::node_motion(MotionEntry& entry, const SceneSection& object, const std::string& file,
                                   const ImportedMeshes& meshes, const Placement& placement) {
    for (const FileMotion& known : entry.from_files)
        if (known.file == file && known.placement == placement) return known.id;
    const std::string node = *entry.section->text("gltf_node");
    const auto motion = std::find_if(meshes.motions.begin(), meshes.motions.end(),
                                     [&](const model::Motion& m) { return m.name == node; });
    if (motion == meshes.motions.end()) {
        std::vector<std::string> known;
        for (const model::Motion& m : meshes.motions) known.push_back(m.name);
        document_.fail(entry.section->line_of("gltf_node"),
                       "'" + file + "' of object '" + *object.text("name") + "' has no animated node '" +
                           node + "'; animated are: " + (known.empty() ? "none" : short_list(known)));
    }
    std::string name = *entry.section->text("name");
    if (!entry.from_files.empty()) name += " (" + *object.text("name") + ")";

    // The node and the animated ones above it, each carried by the next.
    FileMotion added{file, placement, MotionId(scene_.motions.size()), MotionId(0)};
    const model::Motion* link = &*motion;
    for (;;) {
        model::Motion own = placed(*link, placement);
        own.name = unique_name(link == &*motion ? name : name + ": " + link->name, motion_names_);
        own.parent.reset();
        scene_.motions.push_back(std::move(own));
        added.top = MotionId(scene_.motions.size() - 1);
        if (!link->parent) break;
        scene_.motions.back().parent = MotionId(scene_.motions.size());
        link = &meshes.motions[link->parent->value];
    }
    entry.from_files.push_back(added);
    return added.id;
}

MotionId SceneBuilder::carrier(const MotionEntry& entry, const SceneSection& section,
                               const std::string& key) const {
    if (entry.id) return *entry.id;
    if (entry.from_files.size() == 1) return entry.from_files.front().id;
    const std::string name = "motion '" + *section.text(key) + "' is a glTF node's and ";
    document_.fail(section.line_of(key),
                   name +
                       (entry.from_files.empty()
                            ? "no object says by motion = \"" + *section.text(key) + "\" which file's it is"
                            : "its objects lie in several files or places; follow a motion of its own"));
}

void SceneBuilder::add_parents() {
    for (auto& [name, entry] : motions_) {
        std::set<std::string> below{name};
        for (const MotionEntry* link = &entry; link->section->has("parent");) {
            const SceneSection& section = *link->section;
            MotionEntry& parent = entry_of(section, "parent");
            const std::string above = *section.text("parent");
            if (!below.insert(above).second)
                document_.fail(section.line_of("parent"),
                               "motion '" + *section.text("name") + "' is carried by '" + above +
                                   "', which it carries itself; take 'parent' from one of them");
            parent.used = parent.used || entry.used;
            link = &parent;
        }
    }
    for (auto& [name, entry] : motions_) {
        if (!entry.section->has("parent") || !entry.used) continue;
        const MotionId parent = carrier(entry_of(*entry.section, "parent"), *entry.section, "parent");
        if (entry.id) scene_.motions[entry.id->value].parent = parent;
        for (const FileMotion& from : entry.from_files) scene_.motions[from.top.value].parent = parent;
    }
}

void SceneBuilder::add_meters() {
    std::set<std::string> names;
    for (const SceneSection* section : document_.all("meter")) {
        model::GridMeter meter;
        meter.name = *section->text("name");
        if (!names.insert(meter.name).second)
            document_.fail(section->line_of("name"), "there are two meters '" + meter.name + "'");
        meter.origin = metres_ * *section->vec3("origin");
        meter.edge_u = metres_ * *section->vec3("edge_u");
        meter.edge_v = metres_ * *section->vec3("edge_v");
        meter.count_u = static_cast<std::uint32_t>(section->number("count_u").value_or(1.0));
        meter.count_v = static_cast<std::uint32_t>(section->number("count_v").value_or(1.0));
        if (!(glm::length(glm::cross(meter.edge_u, meter.edge_v)) > 0.0))
            document_.fail(section->line_of("edge_v"), "edge_u and edge_v must span a rectangle");
        if (section->has("motion")) {
            MotionEntry& entry = entry_of(*section, "motion");
            entry.used = true;
            meter.motion = carrier(entry, *section, "motion");
        }
        scene_.meters.push_back(std::move(meter));
    }
}

void SceneBuilder::refuse_unused() const {
    for (const auto& [name, entry] : motions_)
        if (!entry.used)
            document_.fail(entry.section->line,
                           fmt::format("motion '{0}' moves no object; write motion = \"{0}\" in one of: {1}",
                                       name, short_list({object_names_.begin(), object_names_.end()})));
    for (const auto& [name, entry] : dimmings_)
        if (!entry.used)
            document_.fail(entry.section->line,
                           fmt::format("dimming '{0}' dims no lamp; write dimming = \"{0}\" in "
                                       "an [[object]] or [[material]] that emits",
                                       name));
}

} // namespace kinelux::io
