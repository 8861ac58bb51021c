// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scene_schema.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <sstream>

#include <toml++/toml.h>

#include "core/error.h"
#include "io/read_scene.h"

namespace kinelux::io {

namespace {

constexpr int newest_format = 1;

enum class Kind { Boolean, Integer, Number, Fraction, Numbers, Integers, Text, Texts, Vector };

struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_open = false, high_open = false;

    bool contains(double value) const {
        return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
    }
};

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr Range any_number{};
constexpr Range positive{0.0, infinite, true, true};
constexpr Range not_negative{0.0, infinite, false, true};
constexpr Range count_range{1.0, 1e9}; // far below what 32 bits hold
constexpr Range open_unit{0.0, 1.0, true, true};
constexpr Range reflectance_range{0.0, 1.0, false, true};

enum class Presence { Optional, Required };

struct SectionSchema {
    std::string_view name;
    bool is_list;
    std::string_view help;
};

struct KeySchema {
    std::string_view section, key;
    Kind kind;
    Range range;
    std::string_view choices; ///< separated by blanks; empty: any
    std::string_view unit;
    Presence presence;
    std::string_view standard; ///< what an absent key means
    std::string_view help;
};

constexpr SectionSchema section_table[] = {
    {"", false, "At the top, before any section."},
    {"scene", false, "What the numbers of the file mean."},
    {"accuracy", false, "The one number that all others follow from."},
    {"time", false, "The frames; frame f is at start_s + f (end_s - start_s) / (frames - 1)."},
    {"material", true,
     "A diffuse surface. It replaces, whole, the material of the same name in every mesh file; other "
     "materials of the "
     "mesh files are taken as they are."},
    {"object", true, "A body: one mesh that rests or moves rigidly."},
    {"motion", true, "A rigid path: its keyframes, or a CSV file, or an animated node of a glTF file."},
    {"motion.keyframe", true, "One stop of a motion, relative to the place at rest; times increase."},
    {"dimming", true,
     "How bright lamps are in time: the exitance of the objects and materials that name it is multiplied by "
     "a factor. "
     "Its keyframes or a CSV file."},
    {"dimming.keyframe", true,
     "One stop of a dimming; times increase. Before the first and after the last one the factor stays."},
    {"meter", true, "A rectangle of sensor points that face edge_u x edge_v."},
    {"effects", false, "Decisions taken out of the plan's hands."},
    {"view", false, "The camera of pictures."},
    {"export", false, "What is written for viewing."},
};

constexpr auto optional_key = Presence::Optional;
constexpr auto required_key = Presence::Required;

constexpr KeySchema key_table[] = {
    {"", "format", Kind::Integer, any_number, "", "", required_key, "", "version of this format: 1"},

    {"scene", "title", Kind::Text, any_number, "", "", optional_key, "the file's name",
     "for reports and pictures"},
    {"scene", "length_unit", Kind::Text, any_number, "m cm mm in ft", "", optional_key, "m",
     "unit of all lengths in this file and of mesh files that state none"},
    {"scene", "up_axis", Kind::Text, any_number, "x y z", "", optional_key,
     "what the mesh files state (glTF: y), else z", "which axis points up; the world is not turned"},
    {"scene", "quantity", Kind::Text, any_number, "radiometric photometric", "", optional_key, "radiometric",
     "W and W/m2, or lm, lm/m2 and lx"},
    {"scene", "channels", Kind::Texts, any_number, "", "", optional_key, "red, green, blue",
     "names of the bands that light is computed in; three take the RGB of mesh files, any other number its "
     "mean"},

    {"accuracy", "target", Kind::Fraction, open_unit, "", "1", optional_key, "0.03",
     "relative L2 error of radiosity per frame, 0.03 or \"3%\""},
    {"accuracy",
     "degree",
     Kind::Integer,
     {0.0, 3.0},
     "",
     "",
     optional_key,
     "follows from target",
     "degree of the polynomials on patches"},
    {"accuracy", "element_size", Kind::Number, positive, "", "length", optional_key, "follows from target",
     "largest edge of an element"},

    {"time", "start_s", Kind::Number, any_number, "", "s", optional_key, "0", "time of the first frame"},
    {"time", "end_s", Kind::Number, any_number, "", "s", optional_key, "start_s", "time of the last frame"},
    {"time", "frames", Kind::Integer, count_range, "", "", optional_key, "1", "number of frames"},

    {"material", "name", Kind::Text, any_number, "", "", required_key, "",
     "what objects and mesh files call it"},
    {"material", "reflectance", Kind::Numbers, reflectance_range, "", "1", required_key, "",
     "share of light reflected, one number or one per channel"},
    {"material", "exitance", Kind::Numbers, not_negative, "", "W/m2 or lm/m2", optional_key, "0",
     "light emitted per area, one number or one per channel"},
    {"material", "sides", Kind::Text, any_number, "auto front both", "", optional_key, "auto",
     "which sides exchange light; auto: the outside of closed parts, both sides of sheets"},
    {"material", "dimming", Kind::Text, any_number, "", "", optional_key, "steady",
     "name of the dimming that its exitance follows"},
    {"material", "two_sided", Kind::Boolean, any_number, "", "", optional_key, "",
     "true: sides = both, false: front"},

    {"object", "name", Kind::Text, any_number, "", "", required_key, "", "for reports, meters and pictures"},
    {"object", "mesh", Kind::Text, any_number, "", "path", required_key, "",
     "mesh file, relative to this file"},
    {"object", "group", Kind::Text, any_number, "", "", optional_key, "the whole file",
     "OBJ group or object, or node with all nodes below it, that is taken from the file"},
    {"object", "material", Kind::Text, any_number, "", "", optional_key, "those of the mesh file",
     "material of all its faces, from this file or the mesh file"},
    {"object", "exitance", Kind::Numbers, not_negative, "", "W/m2 or lm/m2", optional_key,
     "that of its materials", "light emitted per area by all its faces, one number or one per channel"},
    {"object", "flux", Kind::Numbers, not_negative, "", "W or lm", optional_key, "",
     "instead of exitance: light emitted in all, in each channel; divided by the area that emits (both sides "
     "of "
     "two-sided faces)"},
    {"object", "sides", Kind::Text, any_number, "auto front both", "", optional_key, "that of its materials",
     "as in [[material]]"},
    {"object", "two_sided", Kind::Boolean, any_number, "", "", optional_key, "",
     "true: sides = both, false: front"},
    {"object", "motion", Kind::Text, any_number, "", "", optional_key, "rests",
     "name of the motion it follows"},
    {"object", "dimming", Kind::Text, any_number, "", "", optional_key, "that of its materials",
     "name of the dimming that the exitance of all its faces follows"},
    {"object", "scale", Kind::Number, positive, "", "1", optional_key, "1",
     "factor on the mesh file's coordinates"},
    {"object", "rotation_axis", Kind::Vector, any_number, "", "1", optional_key, "", "axis of rotation_deg"},
    {"object", "rotation_deg", Kind::Number, any_number, "", "degrees", optional_key, "0",
     "turn at rest about the origin, after scale"},
    {"object", "translation", Kind::Vector, any_number, "", "length", optional_key, "[0, 0, 0]",
     "shift at rest, after rotation"},
    {"object", "up_axis", Kind::Text, any_number, "x y z", "", optional_key, "what the mesh file states",
     "up axis of the mesh file; where it differs from the scene's, the mesh is turned"},

    {"motion", "name", Kind::Text, any_number, "", "", required_key, "",
     "what objects, meters and other motions call it; some must"},
    {"motion", "parent", Kind::Text, any_number, "", "", optional_key, "the world",
     "name of the motion that carries this one: first this moves the body, then the parent does"},
    {"motion", "interpolation", Kind::Text, any_number, "step linear cubic", "", optional_key, "linear",
     "of translations (cubic: Catmull-Rom); rotations evenly about one axis between keyframes, or in steps"},
    {"motion", "pivot", Kind::Vector, any_number, "", "length", optional_key, "[0, 0, 0]",
     "centre of rotations, in the place at rest"},
    {"motion", "csv", Kind::Text, any_number, "", "path", optional_key, "",
     "table with the columns time_s, x, y, z and, if it turns, axis_x, axis_y, axis_z, angle_deg"},
    {"motion", "gltf_node", Kind::Text, any_number, "", "", optional_key, "",
     "animated node of the glTF file of the object that moves"},

    {"motion.keyframe", "time_s", Kind::Number, any_number, "", "s", required_key, "", "when"},
    {"motion.keyframe", "translation", Kind::Vector, any_number, "", "length", optional_key, "[0, 0, 0]",
     "shift from the place at rest"},
    {"motion.keyframe", "rotation_axis", Kind::Vector, any_number, "", "1", optional_key, "",
     "axis of rotation_deg"},
    {"motion.keyframe", "rotation_deg", Kind::Number, any_number, "", "degrees", optional_key, "0",
     "turn about the pivot; several times round where keyframes share their axis, else the shortest way"},

    {"dimming", "name", Kind::Text, any_number, "", "", required_key, "",
     "what objects and materials call it; some must"},
    {"dimming", "interpolation", Kind::Text, any_number, "step linear", "", optional_key, "linear",
     "between keyframes"},
    {"dimming", "csv", Kind::Text, any_number, "", "path", optional_key, "",
     "table with the columns time_s, factor"},

    {"dimming.keyframe", "time_s", Kind::Number, any_number, "", "s", required_key, "", "when"},
    {"dimming.keyframe", "factor", Kind::Number, not_negative, "", "1", required_key, "",
     "on the exitance; 0: switched off"},

    {"meter", "name", Kind::Text, any_number, "", "", required_key, "", "its name in meters.csv"},
    {"meter", "origin", Kind::Vector, any_number, "", "length", required_key, "",
     "a corner of the rectangle"},
    {"meter", "edge_u", Kind::Vector, any_number, "", "length", required_key, "", "edge from that corner"},
    {"meter", "edge_v", Kind::Vector, any_number, "", "length", required_key, "",
     "other edge from that corner"},
    {"meter", "count_u", Kind::Integer, count_range, "", "", optional_key, "1",
     "sensors along edge_u, at cell centres"},
    {"meter", "count_v", Kind::Integer, count_range, "", "", optional_key, "1", "sensors along edge_v"},
    {"meter", "motion", Kind::Text, any_number, "", "", optional_key, "rests",
     "name of the motion that carries its points and the way they face"},

    {"effects", "interreflection", Kind::Boolean, any_number, "", "", optional_key, "the plan decides",
     "false: direct light only"},
    {"effects", "static_occlusion", Kind::Boolean, any_number, "", "", optional_key, "the plan decides",
     "false: no shadows between bodies at rest"},
    {"effects", "moving_occlusion", Kind::Boolean, any_number, "", "", optional_key, "the plan decides",
     "false: bodies that move cast no shadow"},

    {"view", "eye", Kind::Vector, any_number, "", "length", optional_key, "outside the scene",
     "where the camera is"},
    {"view", "target", Kind::Vector, any_number, "", "length", optional_key, "the scene's middle",
     "what it looks at"},
    {"view", "up", Kind::Vector, any_number, "", "1", optional_key, "up_axis", "what is up in the picture"},
    {"view",
     "field_of_view_deg",
     Kind::Number,
     {0.0, 180.0, true, true},
     "",
     "degrees",
     optional_key,
     "45",
     "vertical angle of view"},

    {"export", "cell_size", Kind::Number, positive, "", "length", optional_key, "half an element",
     "largest edge of a displayed cell; along shadows they are smaller"},
    {"export", "frames", Kind::Integers, not_negative, "", "", optional_key, "all",
     "numbers of the frames written"},
};

std::string printed(double value) {
    char text[32];
    const auto result = std::to_chars(text, text + sizeof text, value);
    return {text, result.ptr};
}

std::string range_text(const Range& range) {
    const bool below = std::isfinite(range.low),
               above = std::isfinite(range.high) && range.high < count_range.high;
    if (!below && !above) return {};
    if (!above) return (range.low_open ? "> " : ">= ") + printed(range.low);
    return (range.low_open ? "in (" : "in [") + printed(range.low) + ", " + printed(range.high) +
           (range.high_open ? ")" : "]");
}

std::vector<std::string> words(std::string_view text) {
    std::istringstream stream{std::string(text)};
    std::vector<std::string> result;
    for (std::string word; stream >> word;) result.push_back(word);
    return result;
}

std::string quoted_list(const std::vector<std::string>& items) {
    std::string text;
    for (const std::string& item : items) text += (text.empty() ? "\"" : ", \"") + item + "\"";
    return text;
}

std::string type_text(const KeySchema& key) {
    const char* const names[] = {"true or false",
                                 "whole number",
                                 "number",
                                 "number or \"n%\"",
                                 "number or list of them",
                                 "list of whole numbers",
                                 "text",
                                 "list of texts",
                                 "[x, y, z]"};
    std::string text =
        key.choices.empty() ? names[static_cast<std::size_t>(key.kind)] : quoted_list(words(key.choices));
    const std::string range = range_text(key.range);
    return range.empty() ? text : text + " " + range;
}

std::string section_label(std::string_view name, bool is_list) {
    if (name.empty()) return "the top of the file";
    return (is_list ? "[[" : "[") + std::string(name) + (is_list ? "]]" : "]");
}

const SectionSchema* find_section(const std::string& name) {
    const auto* found = std::find_if(std::begin(section_table), std::end(section_table),
                                     [&](const SectionSchema& section) { return section.name == name; });
    return found == std::end(section_table) ? nullptr : found;
}

const KeySchema* find_key(const std::string& section, const std::string& key) {
    const auto* found =
        std::find_if(std::begin(key_table), std::end(key_table), [&](const KeySchema& candidate) {
            return candidate.section == section && candidate.key == key;
        });
    return found == std::end(key_table) ? nullptr : found;
}

int line_of_node(const toml::node& node) { return static_cast<int>(node.source().begin.line); }

// Walks the TOML tree along the schema.
class Reader {
public:
    explicit Reader(SceneDocument& document) : document_(document) {}

    void read(const toml::table& root) {
        check_format(root);
        document_.sections.push_back(section("", root, 1));
    }

private:
    void check_format(const toml::table& root) const {
        const toml::node* format = root.get("format");
        if (format == nullptr) document_.fail(1, "expected 'format = 1' at the top of the file");
        const auto version = format->value<std::int64_t>();
        if (!format->is_integer() || *version < 1)
            document_.fail(line_of_node(*format), "expected 'format = 1'");
        if (*version > newest_format)
            document_.fail(line_of_node(*format), "the file is of format " + std::to_string(*version) +
                                                      ", this program reads up to " +
                                                      std::to_string(newest_format) +
                                                      "; use a newer version of it");
    }

    SceneSection section(const std::string& name, const toml::table& table, int line) {
        SceneSection result{name, line, {}, {}};
        const std::string prefix = name.empty() ? "" : name + ".";
        for (const auto& [toml_key, node] : table) {
            const std::string key(toml_key.str());
            const std::string inner = prefix + key;
            const int key_line = line_of_node(node) > 0 ? line_of_node(node) : line;
            if (const SectionSchema* schema = find_section(inner))
                read_inner(*schema, node, key_line, result);
            else if (const KeySchema* known = find_key(name, key))
                result.values[key] = value(*known, node, key_line);
            else
                refuse_unknown(name, key, key_line);
        }
        for (const KeySchema& key : key_table)
            if (key.section == name && key.presence == Presence::Required &&
                !result.has(std::string(key.key)))
                document_.fail(line, label(name) + " lacks the key '" + std::string(key.key) + "'");
        return result;
    }

    void read_inner(const SectionSchema& schema, const toml::node& node, int line, SceneSection& parent) {
        const std::string name(schema.name);
        std::vector<SceneSection>& target = parent.name.empty() ? document_.sections : parent.children;
        if (!schema.is_list) {
            if (!node.is_table()) document_.fail(line, "'" + name + "' is a section; write " + label(name));
            SceneSection inner = section(name, *node.as_table(), line);
            target.push_back(std::move(inner));
            return;
        }
        if (!node.is_array()) document_.fail(line, "there may be several of these; write " + label(name));
        for (const toml::node& item : *node.as_array()) {
            if (!item.is_table()) document_.fail(line, "'" + name + "' is a section; write " + label(name));
            SceneSection inner = section(name, *item.as_table(), std::max(line_of_node(item), 1));
            target.push_back(std::move(inner));
        }
    }

    static std::string label(const std::string& name) {
        const SectionSchema* schema = find_section(name);
        return section_label(name, schema != nullptr && schema->is_list);
    }

    [[noreturn]] void refuse_unknown(const std::string& section, const std::string& key, int line) const {
        std::vector<std::string> known;
        for (const KeySchema& candidate : key_table)
            if (candidate.section == section) known.emplace_back(candidate.key);
        for (const SectionSchema& candidate : section_table)
            if (section.empty() && !candidate.name.empty()) known.emplace_back(candidate.name);
        std::string text =
            "unknown key '" + key + "' in " + (section.empty() ? label(section) : "[" + section + "]");
        if (const auto meant = nearest(key, known))
            text += "; did you mean '" + *meant + "'?";
        else
            text += "; known are: " + quoted_list(known);
        document_.fail(line, text);
    }

    SceneValue value(const KeySchema& key, const toml::node& node, int line) const {
        const std::string name = "'" + std::string(key.key) + "'";
        const auto expected = [&] { document_.fail(line, name + ": expected " + type_text(key)); };
        const auto number = [&](const toml::node& item) {
            const bool whole = key.kind == Kind::Integer || key.kind == Kind::Integers;
            if (!(item.is_integer() || (item.is_floating_point() && !whole))) expected();
            const double result = *item.value<double>();
            if (!std::isfinite(result) || !key.range.contains(result)) {
                const std::string range = range_text(key.range);
                document_.fail(line, name + ": " + printed(result) + " is not " +
                                         (range.empty() ? "finite" : range));
            }
            return result;
        };
        const auto texts_of = [&](const toml::node& item) {
            if (!item.is_string()) expected();
            return *item.value<std::string>();
        };
        switch (key.kind) {
        case Kind::Boolean:
            if (!node.is_boolean()) expected();
            return {line, *node.value<bool>()};
        case Kind::Integer:
        case Kind::Number: return {line, number(node)};
        case Kind::Fraction:
            return {line, node.is_string() ? percent(key, *node.value<std::string>(), line) : number(node)};
        case Kind::Text: return {line, choice(key, texts_of(node), line)};
        case Kind::Texts: return {line, list<std::string>(node, texts_of, expected)};
        case Kind::Numbers:
            if (!node.is_array()) return {line, std::vector<double>{number(node)}};
            [[fallthrough]];
        default: break;
        }
        std::vector<double> numbers = list<double>(node, number, expected);
        if (key.kind == Kind::Vector && numbers.size() != 3) expected();
        return {line, std::move(numbers)};
    }

    template <class Item, class Convert, class Expected>
    static std::vector<Item> list(const toml::node& node, const Convert& convert, const Expected& expected) {
        if (!node.is_array() || node.as_array()->empty()) expected();
        std::vector<Item> items;
        for (const toml::node& item : *node.as_array()) items.push_back(convert(item));
        return items;
    }

    std::string choice(const KeySchema& key, std::string text, int line) const {
        const std::string name = "'" + std::string(key.key) + "'";
        const std::vector<std::string> choices = words(key.choices);
        if (text.empty()) document_.fail(line, name + " is empty");
        if (!choices.empty() && std::find(choices.begin(), choices.end(), text) == choices.end())
            document_.fail(line, name + ": \"" + text + "\" is none of " + quoted_list(choices));
        return text;
    }

    double percent(const KeySchema& key, const std::string& text, int line) const {
        double value = 0.0;
        const char* end = text.data() + text.size();
        const auto [rest, error] = std::from_chars(text.data(), end, value);
        const std::string tail(rest, end);
        const bool good =
            error == std::errc{} && (tail == "%" || tail == " %") && key.range.contains(value / 100.0);
        if (!good) document_.fail(line, "'" + std::string(key.key) + "': expected " + type_text(key));
        return value / 100.0;
    }

    SceneDocument& document_;
};

// Edits (insert, drop, replace) that lead from one word to the other.
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row[b.size()];
}

} // namespace

std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& candidates) {
    std::optional<std::string> best;
    std::size_t fewest = word.size() / 2 + 1;
    for (const std::string& candidate : candidates) {
        const std::size_t edits = edit_distance(word, candidate);
        if (edits >= fewest) continue;
        fewest = edits;
        best = candidate;
    }
    return best;
}

int SceneSection::line_of(const std::string& key) const {
    const auto found = values.find(key);
    return found == values.end() ? line : found->second.line;
}

template <class Type>
std::optional<Type> SceneSection::get(const std::string& key) const {
    const auto found = values.find(key);
    if (found == values.end()) return std::nullopt;
    return std::get<Type>(found->second.value);
}

std::optional<bool> SceneSection::boolean(const std::string& key) const { return get<bool>(key); }
std::optional<double> SceneSection::number(const std::string& key) const { return get<double>(key); }
std::optional<std::string> SceneSection::text(const std::string& key) const { return get<std::string>(key); }

std::optional<std::vector<double>> SceneSection::numbers(const std::string& key) const {
    return get<std::vector<double>>(key);
}

std::optional<std::vector<std::string>> SceneSection::texts(const std::string& key) const {
    return get<std::vector<std::string>>(key);
}

std::optional<Vec3> SceneSection::vec3(const std::string& key) const {
    const auto values_given = numbers(key);
    if (!values_given) return std::nullopt;
    return Vec3((*values_given)[0], (*values_given)[1], (*values_given)[2]);
}

const SceneSection& SceneDocument::one(const std::string& name) const {
    static const SceneSection absent;
    const auto found =
        std::find_if(sections.begin(), sections.end(), [&](const auto& s) { return s.name == name; });
    return found == sections.end() ? absent : *found;
}

std::vector<const SceneSection*> SceneDocument::all(const std::string& name) const {
    std::vector<const SceneSection*> result;
    for (const SceneSection& section : sections)
        if (section.name == name) result.push_back(&section);
    return result;
}

std::string SceneDocument::where(int line) const { return file.string() + ":" + std::to_string(line); }

void SceneDocument::fail(int line, const std::string& what) const {
    throw core::OptionError(where(line) + ": " + what);
}

SceneDocument parse_scene_document(const std::string& text, const std::filesystem::path& file) {
    SceneDocument document{file, {}};
    try {
        const toml::table root = toml::parse(text, file.string());
        Reader(document).read(root);
    } catch (const toml::parse_error& error) {
        document.fail(static_cast<int>(error.source().begin.line), std::string(error.description()));
    }
    return document;
}

std::string scene_format_table() {
    std::string text;
    for (const SectionSchema& section : section_table) {
        const std::string name(section.name);
        text += "### " + (name.empty() ? std::string("Top of the file")
                                       : "`" + section_label(name, section.is_list) + "`");
        text += "\n\n" + std::string(section.help) +
                "\n\n| key | type | unit | default | meaning |\n|---|---|---|---|---|\n";
        for (const KeySchema& key : key_table) {
            if (key.section != section.name) continue;
            const std::string standard =
                key.presence == Presence::Required ? "required" : std::string(key.standard);
            for (const std::string& cell : {"`" + std::string(key.key) + "`", type_text(key),
                                            std::string(key.unit), standard, std::string(key.help)})
                text += "| " + cell + (cell.empty() ? "" : " ");
            text += "|\n";
        }
        text += "\n";
    }
    text.pop_back();
    return text;
}

} // namespace kinelux::io
