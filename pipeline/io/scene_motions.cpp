// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "core/error.h"
#include "io/scene_objects.h"

namespace kinelux::io {

namespace {

std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> result;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) {
        const std::size_t first = cell.find_first_not_of(" \t\r");
        const std::size_t last = cell.find_last_not_of(" \t\r");
        result.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
    }
    return result;
}

// A table of numbers with a line of column names.
class MotionTable {
public:
    MotionTable(const std::filesystem::path& file, double metres) : file_(file), metres_(metres) {}

    std::vector<model::Keyframe> read() {
        std::istringstream stream(read_bytes(file_));
        std::vector<model::Keyframe> keyframes;
        for (std::string line; std::getline(stream, line);) {
            ++line_;
            const std::vector<std::string> row = cells(line);
            if (line.starts_with('#') || row.empty() || (row.size() == 1 && row.front().empty())) continue;
            if (columns_ == 0)
                read_header(row);
            else
                keyframes.push_back(keyframe(row));
            if (keyframes.size() > 1 && !(keyframes.back().time_s > keyframes[keyframes.size() - 2].time_s))
                fail("time_s does not increase");
        }
        if (keyframes.empty()) fail("holds no rows of numbers");
        return keyframes;
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw core::FileError(file_.string() + ":" + std::to_string(line_) + ": " + what);
    }

    void read_header(const std::vector<std::string>& row) {
        const std::vector<std::string> names{"time_s", "x",      "y",      "z",
                                             "axis_x", "axis_y", "axis_z", "angle_deg"};
        const bool good = (row.size() == 4 || row.size() == names.size()) &&
                          std::equal(row.begin(), row.end(), names.begin());
        if (!good)
            fail("expected the column names time_s,x,y,z or time_s,x,y,z,axis_x,axis_y,axis_z,angle_deg");
        columns_ = row.size();
    }

    model::Keyframe keyframe(const std::vector<std::string>& row) const {
        if (row.size() != columns_)
            fail("expected " + std::to_string(columns_) + " numbers, found " + std::to_string(row.size()));
        std::vector<double> values;
        for (const std::string& cell : row) {
            double value = 0.0;
            const char* end = cell.data() + cell.size();
            const auto [rest, error] = std::from_chars(cell.data(), end, value);
            if (error != std::errc{} || rest != end || !std::isfinite(value))
                fail("'" + cell + "' is not a number");
            values.push_back(value);
        }
        model::Keyframe key;
        key.time_s = values[0];
        key.translation = metres_ * Vec3(values[1], values[2], values[3]);
        if (columns_ == 4 || values[7] == 0.0) return key;
        const Vec3 axis(values[4], values[5], values[6]);
        if (!(glm::length(axis) > 0.0)) fail("the axis of the turn has no direction");
        key.rotation = glm::angleAxis(glm::radians(values[7]), glm::normalize(axis));
        return key;
    }

    std::filesystem::path file_;
    double metres_;
    std::size_t columns_ = 0;
    std::size_t line_ = 0;
};

} // namespace

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
    const std::string interpolation = section.text("interpolation").value_or("linear");
    motion.interpolation = interpolation == "step"    ? model::Interpolation::Step
                           : interpolation == "cubic" ? model::Interpolation::Cubic
                                                      : model::Interpolation::Linear;
    motion.pivot = metres_ * section.vec3("pivot").value_or(Vec3(0.0));
    motion.keyframes = section.has("csv") ? read_csv(section) : keyframes_of(section);
    return motion;
}

std::vector<model::Keyframe> SceneBuilder::keyframes_of(const SceneSection& section) const {
    std::vector<model::Keyframe> keyframes;
    for (const SceneSection& stop : section.children) {
        model::Keyframe key;
        key.time_s = *stop.number("time_s");
        key.translation = metres_ * stop.vec3("translation").value_or(Vec3(0.0));
        key.rotation = rotation_of(stop);
        if (!keyframes.empty() && !(key.time_s > keyframes.back().time_s))
            document_.fail(stop.line_of("time_s"), "keyframes must be in the order of increasing time_s");
        keyframes.push_back(key);
    }
    return keyframes;
}

std::vector<model::Keyframe> SceneBuilder::read_csv(const SceneSection& section) const {
    const std::filesystem::path file = path_of(*section.text("csv"));
    try {
        tree_.require(file);
        return MotionTable(file, metres_).read();
    } catch (const core::FileError& error) {
        throw core::FileError(document_.where(section.line_of("csv")) + ": " + error.what());
    }
}

MotionId SceneBuilder::motion_of(const SceneSection& section, const std::string& file,
                                 const ImportedMeshes& meshes, const Placement& placement) {
    const std::string name = *section.text("motion");
    const auto found = motions_.find(name);
    if (found == motions_.end()) {
        std::vector<std::string> known;
        for (const auto& [own, entry] : motions_) known.push_back(own);
        document_.fail(section.line_of("motion"), "there is no motion '" + name + "'; there are: " +
                                                      (known.empty() ? "none" : short_list(known)));
    }
    MotionEntry& entry = found->second;
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
    model::Motion own = placed(*motion, placement);
    const std::string name = *entry.section->text("name");
    own.name = unique_name(entry.from_files.empty() ? name : name + " (" + *object.text("name") + ")",
                           motion_names_);
    const MotionId id(scene_.motions.size());
    scene_.motions.push_back(std::move(own));
    entry.from_files.push_back({file, placement, id});
    return id;
}

} // namespace kinelux::io
