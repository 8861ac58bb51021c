// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/vec.h"

// The keys of a scene file: one table parses, checks and documents them. Private to io.
namespace kinelux::io {

struct SceneValue {
    int line = 0;
    std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>> value;
};

/// One section of a scene file with the keys that were given. The schema has checked their types and ranges, so each
/// getter is called with the type that the schema states.
struct SceneSection {
    std::string name;
    int line = 0;
    std::map<std::string, SceneValue> values;
    std::vector<SceneSection> children; ///< motion.keyframe, dimming.keyframe

    bool has(const std::string& key) const { return values.count(key) > 0; }
    int line_of(const std::string& key) const; ///< of the section where the key was not given
    std::optional<bool> boolean(const std::string& key) const;
    std::optional<double> number(const std::string& key) const;
    std::optional<std::string> text(const std::string& key) const;
    std::optional<Vec3> vec3(const std::string& key) const;
    std::optional<std::vector<double>> numbers(const std::string& key) const; ///< a single number: one entry
    std::optional<std::vector<std::string>> texts(const std::string& key) const;

private:
    template <class Type>
    std::optional<Type> get(const std::string& key) const;
};

struct SceneDocument {
    std::filesystem::path file;
    std::vector<SceneSection> sections; ///< in the order of the file

    const SceneSection& one(const std::string& name) const; ///< empty where the file has none
    std::vector<const SceneSection*> all(const std::string& name) const;
    std::string where(int line) const; ///< "file:line"
    [[noreturn]] void fail(int line, const std::string& what) const;
};

/// Parses TOML and checks every key against the schema.
/// @throws OptionError  "file:line: ..."
SceneDocument parse_scene_document(const std::string& text, const std::filesystem::path& file);

/// The candidate that differs least from a misspelt word, if it is near enough to be meant.
std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& candidates);

} // namespace kinelux::io
