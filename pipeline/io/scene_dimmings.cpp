// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include "io/scene_objects.h"

namespace kinelux::io {

void SceneBuilder::add_dimmings() {
    for (const SceneSection* section : document_.all("dimming")) {
        const std::string name = *section->text("name");
        if (dimmings_.count(name) > 0)
            document_.fail(section->line_of("name"), "there are two dimmings '" + name + "'");
        if (section->has("csv") != section->children.empty())
            document_.fail(section->line, "dimming '" + name + "' needs one of: [[dimming.keyframe]], 'csv'");
        model::Dimming dimming;
        dimming.name = name;
        if (section->text("interpolation").value_or("linear") == "step")
            dimming.interpolation = model::Interpolation::Step;
        dimming.keys = section->has("csv") ? dimming_from_csv(*section) : dimming_keys(*section);
        dimmings_[name] = {section, DimmingId(scene_.dimmings.size()), false};
        scene_.dimmings.push_back(std::move(dimming));
    }
}

std::vector<model::Dimming::Key> SceneBuilder::dimming_keys(const SceneSection& section) const {
    std::vector<model::Dimming::Key> keys;
    for (const SceneSection& stop : section.children) {
        keys.push_back({*stop.number("time_s"), *stop.number("factor")});
        if (keys.size() > 1 && !(keys.back().time_s > keys[keys.size() - 2].time_s))
            document_.fail(stop.line_of("time_s"), "keyframes must be in the order of increasing time_s");
    }
    return keys;
}

std::vector<model::Dimming::Key> SceneBuilder::dimming_from_csv(const SceneSection& section) const {
    const NumberTable table = read_csv(section, {{"time_s", "factor"}});
    std::vector<model::Dimming::Key> keys;
    for (const auto& [line, values] : table.rows) {
        if (!(values[1] >= 0.0)) table.fail(line, "the factor is below 0");
        keys.push_back({values[0], values[1]});
    }
    return keys;
}

DimmingId SceneBuilder::dimming_of(const SceneSection& section) {
    const std::string name = *section.text("dimming");
    const auto found = dimmings_.find(name);
    if (found == dimmings_.end()) {
        std::vector<std::string> known;
        for (const auto& [own, entry] : dimmings_) known.push_back(own);
        const auto meant = nearest(name, known);
        document_.fail(section.line_of("dimming"), "there is no dimming '" + name + "'; there are: " +
                                                       (known.empty() ? "none" : short_list(known)) +
                                                       (meant ? "; did you mean '" + *meant + "'?" : ""));
    }
    found->second.used = true;
    return found->second.id;
}

} // namespace kinelux::io
