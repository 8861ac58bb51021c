// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/mesh_import.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include "core/error.h"

namespace kinelux::io {

namespace fs = std::filesystem;

namespace {

// A white that mesh files write as 1 would never lose energy; this is about fresh white paint.
constexpr double highest_reflectance = 0.95;
constexpr double default_reflectance = 0.5;

} // namespace

FolderTree::FolderTree(const fs::path& root, Outside outside) : outside_(outside) {
    std::error_code error;
    root_ = fs::weakly_canonical(root.empty() ? fs::path(".") : root, error);
    if (error) throw core::FileError(root.string() + ": cannot be resolved: " + error.message());
}

bool FolderTree::contains(const fs::path& file) const {
    std::error_code error;
    const fs::path real = fs::weakly_canonical(file, error);
    if (error) return false;
    const fs::path relative = real.lexically_relative(root_);
    return !relative.empty() && *relative.begin() != "..";
}

void FolderTree::require(const fs::path& file) const {
    if (outside_ == Outside::Allowed || contains(file)) return;
    throw core::FileError(file.string() + ": lies outside the scene's folder " + root_.string() +
                          "; move it there or pass --allow-outside");
}

std::string read_bytes(const fs::path& file) {
    std::error_code error;
    if (!fs::exists(file, error)) throw core::FileError(file.string() + ": there is no such file");
    if (!fs::is_regular_file(file, error)) throw core::FileError(file.string() + ": is not a file");
    std::ifstream stream(file, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    if (stream.bad() || !stream.is_open()) throw core::FileError(file.string() + ": cannot be read");
    return bytes;
}

std::string unique_name(const std::string& wanted, std::set<std::string>& taken) {
    std::string name = wanted;
    for (int number = 2; !taken.insert(name).second; ++number)
        name = wanted + " (" + std::to_string(number) + ")";
    return name;
}

std::string short_list(const std::vector<std::string>& names) {
    constexpr std::size_t longest = 8;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), longest); ++i) text += (i > 0 ? ", " : "") + names[i];
    if (names.size() > longest) text += " and " + std::to_string(names.size() - longest) + " more";
    return text;
}

std::vector<double> MaterialCollector::per_channel(const Vec3& rgb) const {
    if (channels_ == 3) return {rgb.x, rgb.y, rgb.z};
    return std::vector<double>(channels_, (rgb.x + rgb.y + rgb.z) / 3.0);
}

MaterialId MaterialCollector::add(const std::string& name, const Vec3& reflectance, const Vec3& exitance,
                                  model::Sides sides) {
    model::Material material;
    material.name = unique_name(name.empty() ? "unnamed" : name, names_);
    material.sides = sides;
    bool changed = false;
    const auto clamped = [&](const Vec3& rgb, double highest) {
        Vec3 result{0.0};
        for (int c = 0; c < 3; ++c) {
            if (!std::isfinite(rgb[c]))
                throw core::FileError("material '" + name + "' has a colour that is not finite");
            result[c] = std::clamp(rgb[c], 0.0, highest);
            changed = changed || result[c] != rgb[c];
        }
        return per_channel(result);
    };
    material.reflectance = clamped(reflectance, highest_reflectance);
    material.exitance = clamped(exitance, std::numeric_limits<double>::max());
    if (changed) clamped_.push_back(material.name);
    materials_.push_back(std::move(material));
    return MaterialId(materials_.size() - 1);
}

MaterialId MaterialCollector::default_grey() { return undescribed(""); }

MaterialId MaterialCollector::undescribed(const std::string& name) {
    const auto known = grey_.find(name);
    if (known != grey_.end()) return known->second;
    const MaterialId id =
        add(name.empty() ? "default" : name, Vec3(default_reflectance), Vec3(0.0), model::Sides::Auto);
    undescribed_.push_back(materials_.back().name);
    return grey_[name] = id;
}

void MaterialCollector::finish(ImportedMeshes& result) {
    if (!clamped_.empty())
        result.notes.push_back("reflectance or emission brought into range (reflectance 0 to 0.95) in: " +
                               short_list(clamped_));
    if (!undescribed_.empty())
        result.notes.push_back("no description of the material; grey with reflectance 0.5 is used for: " +
                               short_list(undescribed_));
    result.materials = std::move(materials_);
}

} // namespace kinelux::io
