// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scene_json.h"

#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace kinelux::io {

namespace {

using Json = nlohmann::ordered_json;

// ---- small values

Json to_json(const Vec3& v) { return {v.x, v.y, v.z}; }
Json to_json(const Quat& q) { return {q.w, q.x, q.y, q.z}; }

Vec3 vec3_from(const Json& json) {
    const auto v = json.get<std::array<double, 3>>();
    return {v[0], v[1], v[2]};
}

Quat quat_from(const Json& json) {
    const auto q = json.get<std::array<double, 4>>();
    return {q[0], q[1], q[2], q[3]};
}

template <class Value>
Json optional_to_json(const std::optional<Value>& value) {
    return value ? Json(*value) : Json(nullptr);
}
Json optional_to_json(const std::optional<Vec3>& value) { return value ? to_json(*value) : Json(nullptr); }

template <class Value>
std::optional<Value> optional_from(const Json& json) {
    return json.is_null() ? std::nullopt : std::optional(json.get<Value>());
}
std::optional<Vec3> optional_vec3_from(const Json& json) {
    return json.is_null() ? std::nullopt : std::optional(vec3_from(json));
}

template <class Id>
Json id_to_json(const std::optional<Id>& id) {
    return id ? Json(id->value) : Json(nullptr);
}
template <class Id>
std::optional<Id> id_from(const Json& json) {
    return json.is_null() ? std::nullopt : std::optional(Id(json.get<std::uint32_t>()));
}

/// The words of an enumeration, in the order of its values.
template <class Enum, std::size_t count>
Enum enum_from(const Json& json, const std::array<const char*, count>& words) {
    const auto word = json.get<std::string>();
    for (std::size_t k = 0; k < count; ++k)
        if (word == words[k]) return static_cast<Enum>(k);
    throw core::FileError(fmt::format("'{}' is none of: {}", word, fmt::join(words, ", ")));
}

constexpr std::array quantity_words{"radiometric", "photometric"};
constexpr std::array sides_words{"auto", "front", "both"};
constexpr std::array interpolation_words{"step", "linear", "cubic"};

template <class Enum, std::size_t count>
Json enum_to_json(Enum value, const std::array<const char*, count>& words) {
    return words.at(static_cast<std::size_t>(value));
}

/// list of json(item)
template <class Items, class ToJson>
Json list_to_json(const Items& items, ToJson json) {
    Json list = Json::array();
    for (const auto& item : items) list.push_back(json(item));
    return list;
}

template <class FromJson>
auto list_from(const Json& list, FromJson item) {
    std::vector<decltype(item(list))> items;
    if (!list.is_array()) throw core::FileError("a list was expected");
    for (const Json& json : list) items.push_back(item(json));
    return items;
}

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

/// Parses, and turns every exception of the JSON library into a FileError.
template <class Read>
auto read_json(std::string_view text, Read read) {
    try {
        return read(Json::parse(text));
    } catch (const nlohmann::json::parse_error&) {
        throw core::FileError("truncated or not a JSON file");
    } catch (const nlohmann::json::exception& error) {
        const std::string what = error.what(); // "[json.exception.out_of_range.403] key 'x' not found"
        throw core::FileError(
            fmt::format("not as this program writes it: {}", what.substr(what.find("] ") + 2)));
    }
}

Json header_to_json(const FileHeader& header) {
    Json json{{"format", header.format}, {"version", header.version}, {"program", header.program}};
    if (!header.made_from.empty()) json["made_from"] = header.made_from;
    return json;
}

// ---- the parts of a scene

Json to_json(const model::Material& material) {
    return {{"name", material.name},
            {"reflectance", material.reflectance},
            {"exitance", material.exitance},
            {"sides", enum_to_json(material.sides, sides_words)},
            {"dimming", id_to_json(material.dimming)}};
}

model::Material material_from(const Json& json) {
    return {.name = json.at("name"),
            .reflectance = json.at("reflectance").get<std::vector<double>>(),
            .exitance = json.at("exitance").get<std::vector<double>>(),
            .sides = enum_from<model::Sides>(json.at("sides"), sides_words),
            .dimming = id_from<DimmingId>(json.at("dimming"))};
}

Json to_json(const model::Object& object, const MeshFile& mesh) {
    return {{"name", object.name},
            {"source", object.source},
            {"motion", id_to_json(object.motion)},
            {"mesh", {{"file", mesh.path}, {"hash", mesh.hash}}}};
}

model::Object object_from(const Json& json) {
    model::Object object;
    object.name = json.at("name");
    object.source = json.at("source");
    object.motion = id_from<MotionId>(json.at("motion"));
    return object;
}

Json to_json(const model::KeyTangents& tangents) {
    return {{"translation_in_m_s", to_json(tangents.translation_in)},
            {"translation_out_m_s", to_json(tangents.translation_out)},
            {"rotation_in_wxyz", to_json(tangents.rotation_in)},
            {"rotation_out_wxyz", to_json(tangents.rotation_out)}};
}

model::KeyTangents tangents_from(const Json& json) {
    return {.translation_in = vec3_from(json.at("translation_in_m_s")),
            .translation_out = vec3_from(json.at("translation_out_m_s")),
            .rotation_in = quat_from(json.at("rotation_in_wxyz")),
            .rotation_out = quat_from(json.at("rotation_out_wxyz"))};
}

/// Turn and tangents are written where there are some.
Json to_json(const model::Keyframe& keyframe) {
    Json json{{"time_s", keyframe.time_s},
              {"translation_m", to_json(keyframe.translation)},
              {"rotation_wxyz", to_json(keyframe.rotation)}};
    if (keyframe.turn) json["turn_rad"] = to_json(*keyframe.turn);
    if (keyframe.tangents) json["tangents"] = to_json(*keyframe.tangents);
    return json;
}

model::Keyframe keyframe_from(const Json& json) {
    model::Keyframe keyframe{.time_s = json.at("time_s"),
                             .translation = vec3_from(json.at("translation_m")),
                             .rotation = quat_from(json.at("rotation_wxyz"))};
    if (json.contains("turn_rad")) keyframe.turn = vec3_from(json.at("turn_rad"));
    if (json.contains("tangents")) keyframe.tangents = tangents_from(json.at("tangents"));
    return keyframe;
}

Json to_json(const model::Motion& motion) {
    return {{"name", motion.name},
            {"parent", id_to_json(motion.parent)},
            {"interpolation", enum_to_json(motion.interpolation, interpolation_words)},
            {"rotation_interpolation", enum_to_json(motion.rotation_interpolation, interpolation_words)},
            {"pivot_m", to_json(motion.pivot)},
            {"keyframes", list_to_json(motion.keyframes, [](const auto& key) { return to_json(key); })}};
}

model::Motion motion_from(const Json& json) {
    return {.name = json.at("name"),
            .interpolation = enum_from<model::Interpolation>(json.at("interpolation"), interpolation_words),
            .pivot = vec3_from(json.at("pivot_m")),
            .keyframes = list_from(json.at("keyframes"), keyframe_from),
            .rotation_interpolation =
                enum_from<model::Interpolation>(json.at("rotation_interpolation"), interpolation_words),
            .parent = id_from<MotionId>(json.at("parent"))};
}

Json to_json(const model::Dimming& dimming) {
    return {{"name", dimming.name},
            {"interpolation", enum_to_json(dimming.interpolation, interpolation_words)},
            {"keys", list_to_json(dimming.keys, [](const model::Dimming::Key& key) {
                 return Json{{"time_s", key.time_s}, {"factor", key.factor}};
             })}};
}

model::Dimming dimming_from(const Json& json) {
    return {.name = json.at("name"),
            .interpolation = enum_from<model::Interpolation>(json.at("interpolation"), interpolation_words),
            .keys = list_from(json.at("keys"), [](const Json& key) {
                return model::Dimming::Key{.time_s = key.at("time_s"), .factor = key.at("factor")};
            })};
}

Json to_json(const model::GridMeter& meter) {
    return {{"name", meter.name},
            {"origin_m", to_json(meter.origin)},
            {"edge_u_m", to_json(meter.edge_u)},
            {"edge_v_m", to_json(meter.edge_v)},
            {"count_u", meter.count_u},
            {"count_v", meter.count_v},
            {"motion", id_to_json(meter.motion)}};
}

model::GridMeter meter_from(const Json& json) {
    return {.name = json.at("name"),
            .origin = vec3_from(json.at("origin_m")),
            .edge_u = vec3_from(json.at("edge_u_m")),
            .edge_v = vec3_from(json.at("edge_v_m")),
            .count_u = json.at("count_u"),
            .count_v = json.at("count_v"),
            .motion = id_from<MotionId>(json.at("motion"))};
}

/// Everything that is one value and not a list.
void put_settings(Json& json, const model::Scene& scene) {
    json["title"] = scene.title;
    json["source"] = scene.source.generic_string();
    json["quantity"] = enum_to_json(scene.quantity, quantity_words);
    json["channels"] = scene.channels;
    json["up"] = to_json(scene.up);
    json["accuracy"] = {{"target", scene.accuracy.target},
                        {"degree", optional_to_json(scene.accuracy.degree)},
                        {"element_size_m", optional_to_json(scene.accuracy.element_size)}};
    json["time"] = {
        {"start_s", scene.time.start_s}, {"end_s", scene.time.end_s}, {"frames", scene.time.frames}};
    json["effects"] = {{"interreflection", optional_to_json(scene.effects.interreflection)},
                       {"static_occlusion", optional_to_json(scene.effects.static_occlusion)},
                       {"moving_occlusion", optional_to_json(scene.effects.moving_occlusion)}};
    json["view"] = {{"eye_m", optional_to_json(scene.view.eye)},
                    {"target_m", optional_to_json(scene.view.target)},
                    {"up", to_json(scene.view.up)},
                    {"field_of_view_deg", scene.view.field_of_view_deg}};
    json["export"] = {{"cell_size_m", optional_to_json(scene.exported.cell_size)},
                      {"frames", optional_to_json(scene.exported.frames)}};
}

void get_settings(const Json& json, model::Scene& scene) {
    scene.title = json.at("title");
    scene.source = json.at("source").get<std::string>();
    scene.quantity = enum_from<model::Quantity>(json.at("quantity"), quantity_words);
    scene.channels = json.at("channels").get<std::vector<std::string>>();
    scene.up = vec3_from(json.at("up"));
    const Json& accuracy = json.at("accuracy");
    scene.accuracy = {.target = accuracy.at("target"),
                      .degree = optional_from<int>(accuracy.at("degree")),
                      .element_size = optional_from<double>(accuracy.at("element_size_m"))};
    const Json& time = json.at("time");
    scene.time = {.start_s = time.at("start_s"), .end_s = time.at("end_s"), .frames = time.at("frames")};
    const Json& effects = json.at("effects");
    scene.effects = {.interreflection = optional_from<bool>(effects.at("interreflection")),
                     .static_occlusion = optional_from<bool>(effects.at("static_occlusion")),
                     .moving_occlusion = optional_from<bool>(effects.at("moving_occlusion"))};
    const Json& view = json.at("view");
    scene.view = {.eye = optional_vec3_from(view.at("eye_m")),
                  .target = optional_vec3_from(view.at("target_m")),
                  .up = vec3_from(view.at("up")),
                  .field_of_view_deg = view.at("field_of_view_deg")};
    const Json& exported = json.at("export");
    scene.exported = {.cell_size = optional_from<double>(exported.at("cell_size_m")),
                      .frames = optional_from<std::vector<std::uint32_t>>(exported.at("frames"))};
}

Json to_json(const model::Effect& effect) {
    return {{"name", effect.name},
            {"simulated", effect.simulated},
            {"reason", effect.reason},
            {"risked_error", effect.risked_error},
            {"overridden", effect.overridden}};
}

model::Effect effect_from(const Json& json) {
    return {.name = json.at("name"),
            .simulated = json.at("simulated"),
            .reason = json.at("reason"),
            .risked_error = json.at("risked_error"),
            .overridden = json.at("overridden")};
}

} // namespace

FileHeader header_from_json(std::string_view text) {
    return read_json(text, [](const Json& json) {
        return FileHeader{.format = json.value("format", ""),
                          .version = json.at("version"),
                          .program = json.at("program"),
                          .made_from = json.value("made_from", "")};
    });
}

std::string scene_to_json(const FileHeader& header, const model::Scene& scene,
                          const std::vector<MeshFile>& meshes) {
    Json json = header_to_json(header);
    put_settings(json, scene);
    json["materials"] = list_to_json(scene.materials, [](const auto& material) { return to_json(material); });
    json["objects"] = Json::array();
    for (std::size_t o = 0; o < scene.objects.size(); ++o)
        json["objects"].push_back(to_json(scene.objects[o], meshes.at(o)));
    json["motions"] = list_to_json(scene.motions, [](const auto& motion) { return to_json(motion); });
    json["dimmings"] = list_to_json(scene.dimmings, [](const auto& dimming) { return to_json(dimming); });
    json["meters"] = list_to_json(scene.meters, [](const auto& meter) { return to_json(meter); });
    return dump(json);
}

SceneFile scene_from_json(std::string_view text) {
    return read_json(text, [](const Json& json) {
        SceneFile file;
        get_settings(json, file.scene);
        file.scene.materials = list_from(json.at("materials"), material_from);
        file.scene.objects = list_from(json.at("objects"), object_from);
        file.scene.motions = list_from(json.at("motions"), motion_from);
        file.scene.dimmings = list_from(json.at("dimmings"), dimming_from);
        file.scene.meters = list_from(json.at("meters"), meter_from);
        file.meshes = list_from(json.at("objects"), [](const Json& object) {
            return MeshFile{object.at("mesh").at("file"), object.at("mesh").at("hash")};
        });
        return file;
    });
}

std::string plan_to_json(const FileHeader& header, const model::Plan& plan) {
    Json json = header_to_json(header);
    json["effects"] = list_to_json(plan.effects, [](const auto& effect) { return to_json(effect); });
    json["degree"] = plan.degree;
    json["cluster_degree"] = plan.cluster_degree;
    json["bounces"] = plan.bounces;
    json["single_channel"] = plan.single_channel;
    json["static_occlusion"] = plan.static_occlusion;
    json["moving_occlusion"] = plan.moving_occlusion;
    json["moving_objects"] = list_to_json(plan.moving_objects, [](ObjectId id) { return id.value; });
    json["unknowns"] = plan.unknowns;
    json["predicted_blocks"] = plan.predicted_blocks;
    json["predicted_memory_mib"] = plan.predicted_memory_mib;
    return dump(json);
}

model::Plan plan_from_json(std::string_view text) {
    return read_json(text, [](const Json& json) {
        return model::Plan{
            .effects = list_from(json.at("effects"), effect_from),
            .degree = json.at("degree"),
            .cluster_degree = json.at("cluster_degree"),
            .bounces = json.at("bounces"),
            .single_channel = json.at("single_channel"),
            .static_occlusion = json.at("static_occlusion"),
            .moving_occlusion = json.at("moving_occlusion"),
            .moving_objects = list_from(json.at("moving_objects"),
                                        [](const Json& id) { return ObjectId(id.get<std::uint32_t>()); }),
            .unknowns = json.at("unknowns"),
            .predicted_blocks = json.at("predicted_blocks"),
            .predicted_memory_mib = json.at("predicted_memory_mib"),
        };
    });
}

std::string valid_utf8(const std::string& text) {
    return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

} // namespace kinelux::io
