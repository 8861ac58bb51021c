// SPDX-License-Identifier: GPL-3.0-or-later
// libdraco, which Assimp brings along, exports the symbols of another tinygltf with another layout, and the dynamic
// linker takes whichever comes first. So tinygltf is compiled here, under a name of its own.
#define tinygltf kinelux_tinygltf
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include "core/error.h"
#include "io/gltf_hierarchy.h"
#include "io/mesh_import.h"

namespace kinelux::io {

namespace {

using Index = std::size_t;

[[noreturn]] void refuse(const MeshFile& file, const std::string& what) {
    throw core::FileError(file.name() + ": " + what);
}

std::uint32_t little_endian(const std::string& bytes, Index offset) {
    std::uint32_t value = 0;
    for (Index i = 0; i < 4; ++i)
        value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
    return value;
}

// The frame of a binary file, checked here to the last byte: tinygltf 2.7 forgets the second chunk's header.
void check_binary_frame(const MeshFile& file) {
    constexpr Index header = 12, chunk_header = 8;
    const std::string& bytes = file.bytes;
    if (bytes.size() < header + chunk_header) refuse(file, "is truncated");
    const std::uint32_t version = little_endian(bytes, 4);
    if (version != 2)
        refuse(file, "is of glTF version " + std::to_string(version) + "; convert it to glTF 2.0");
    const Index length = little_endian(bytes, 8);
    if (length > bytes.size()) refuse(file, "is truncated");
    for (Index begin = header; begin + chunk_header <= length;) {
        const Index size = little_endian(bytes, begin);
        if (size > length - begin - chunk_header) refuse(file, "is truncated");
        begin += chunk_header + size;
    }
}

struct FileAccess {
    const MeshFile* file = nullptr;
    std::string failure;

    // Pictures are not read at all; other files only below the folder tree and only beside the glTF file.
    bool readable(const std::filesystem::path& path) const {
        const std::string extension = path.extension().string();
        for (const char* picture : {".png", ".jpg", ".jpeg", ".webp", ".ktx2", ".PNG", ".JPG"})
            if (extension == picture) return false;
        return path.is_absolute();
    }
};

tinygltf::FsCallbacks guarded_files(FileAccess& access) {
    tinygltf::FsCallbacks callbacks{};
    callbacks.user_data = &access;
    callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
    callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&,
                                  void*) { return false; };
    callbacks.FileExists = [](const std::string& path, void* data) {
        std::error_code error;
        return static_cast<FileAccess*>(data)->readable(path) &&
               std::filesystem::is_regular_file(path, error);
    };
    callbacks.ReadWholeFile = [](std::vector<unsigned char>* out, std::string*, const std::string& path,
                                 void* data) {
        FileAccess& own = *static_cast<FileAccess*>(data);
        try {
            own.file->tree.require(path);
            const std::string bytes = read_bytes(path);
            out->assign(bytes.begin(), bytes.end());
            return true;
        } catch (const core::FileError& error) {
            own.failure = error.what();
            return false;
        }
    };
    return callbacks;
}

std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

tinygltf::Model load(const MeshFile& file) {
    if (file.bytes.size() > std::numeric_limits<unsigned>::max()) refuse(file, "is larger than 4 GiB");
    const auto size = static_cast<unsigned>(file.bytes.size());
    FileAccess access{&file, {}};
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks(guarded_files(access));
    loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int,
                             const unsigned char*, int, void*) { return true; },
                          nullptr);
    const std::string folder = std::filesystem::absolute(file.path).parent_path().string();
    tinygltf::Model model;
    std::string errors, warnings;
    bool good = false;
    try {
        if (file.bytes.starts_with("glTF")) {
            check_binary_frame(file);
            good = loader.LoadBinaryFromMemory(&model, &errors, &warnings,
                                               reinterpret_cast<const unsigned char*>(file.bytes.data()),
                                               size, folder);
        } else {
            good = loader.LoadASCIIFromString(&model, &errors, &warnings, file.bytes.data(), size, folder);
        }
    } catch (const core::Error&) {
        throw;
    } catch (const std::exception& error) {
        refuse(file, std::string("is not valid glTF: ") + error.what());
    }
    if (!access.failure.empty()) throw core::FileError(access.failure);
    if (!good && file.bytes.find("_mesh_compression\"") != std::string::npos)
        refuse(file, "uses mesh compression, which is not read; save it without");
    if (!good) refuse(file, "is not valid glTF 2.0: " + one_line(errors));
    if (!model.asset.version.starts_with("2."))
        refuse(file, "is of glTF version " + model.asset.version + "; convert it to glTF 2.0");
    for (const std::string& extension : model.extensionsRequired)
        if (extension.find("compression") != std::string::npos)
            refuse(file, "needs " + extension + ", which is not read; save it without mesh compression");
    return model;
}

template <class Number>
double component_value(const unsigned char* bytes, bool normalized) {
    Number number;
    std::memcpy(&number, bytes, sizeof number);
    const auto value = static_cast<double>(number);
    if (!normalized || !std::numeric_limits<Number>::is_integer) return value;
    return std::max(value / static_cast<double>(std::numeric_limits<Number>::max()), -1.0);
}

double component_value(int type, const unsigned char* bytes, bool normalized) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return component_value<std::int8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return component_value<std::uint8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT: return component_value<std::int16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return component_value<std::uint16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_INT: return component_value<std::int32_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return component_value<std::uint32_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return component_value<float>(bytes, normalized);
    default: return component_value<double>(bytes, normalized);
    }
}

// Transforms and parameters that must have `size` numbers where they are given.
Vec3 vec3_or(const std::vector<double>& values, const Vec3& otherwise) {
    return values.size() == 3 ? Vec3(values[0], values[1], values[2]) : otherwise;
}

class GltfReader {
public:
    GltfReader(const MeshFile& file, tinygltf::Model model)
        : file_(file), model_(std::move(model)), collector_(file.channels) {}

    ImportedMeshes read() {
        result_.unit_stated = true;
        result_.up = {0.0, 1.0, 0.0};
        read_nodes();
        for (const tinygltf::Animation& animation : model_.animations) read_animation(animation);
        add_objects();
        note_what_is_left_out();
        collector_.finish(result_);
        return std::move(result_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const { refuse(file_, what); }

    template <class Item>
    const Item& item(const std::vector<Item>& items, int index, const char* what) const {
        if (index < 0 || static_cast<Index>(index) >= items.size())
            fail("refers to " + std::string(what) + " " + std::to_string(index) + " of " +
                 std::to_string(items.size()));
        return items[static_cast<Index>(index)];
    }

    // All components of an accessor in a row; nothing outside its buffer is touched.
    std::vector<double> numbers(int index, int wanted_type, const char* what) const {
        const tinygltf::Accessor& accessor = item(model_.accessors, index, "accessor");
        const std::string name = "accessor " + std::to_string(index) + " (" + what + ")";
        if (accessor.sparse.isSparse) fail(name + " is sparse, which is not read");
        if (accessor.type != wanted_type) fail(name + " is of the wrong type");
        const tinygltf::BufferView& view = item(model_.bufferViews, accessor.bufferView, "buffer view");
        const std::vector<unsigned char>& data = item(model_.buffers, view.buffer, "buffer").data;
        const int component_size =
            tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
        const int stride = accessor.ByteStride(view);
        if (component_size <= 0 || stride <= 0) fail(name + " has a bad layout");
        const auto components =
            static_cast<Index>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(wanted_type)));
        const Index element = components * static_cast<Index>(component_size),
                    step = static_cast<Index>(stride);
        const bool inside =
            view.byteOffset <= data.size() && view.byteLength <= data.size() - view.byteOffset &&
            accessor.byteOffset <= view.byteLength &&
            (accessor.count == 0 ||
             (element <= view.byteLength - accessor.byteOffset &&
              accessor.count - 1 <= (view.byteLength - accessor.byteOffset - element) / step));
        if (!inside) fail(name + " reaches beyond its buffer; the file is truncated or damaged");
        std::vector<double> values;
        values.reserve(accessor.count * components);
        const unsigned char* begin = data.data() + view.byteOffset + accessor.byteOffset;
        for (Index i = 0; i < accessor.count; ++i)
            for (Index c = 0; c < components; ++c)
                values.push_back(component_value(accessor.componentType,
                                                 begin + i * step + c * static_cast<Index>(component_size),
                                                 accessor.normalized));
        return values;
    }

    void read_nodes() {
        hierarchy_.nodes.resize(model_.nodes.size());
        for (Index i = 0; i < model_.nodes.size(); ++i) {
            const tinygltf::Node& node = model_.nodes[i];
            GltfNode& own = hierarchy_.nodes[i];
            own.name = node.name.empty() ? "node " + std::to_string(i) : node.name;
            own.translation = vec3_or(node.translation, Vec3(0.0));
            own.scale = vec3_or(node.scale, Vec3(1.0));
            if (node.rotation.size() == 4) own.rotation = unit_quaternion(node.rotation.data());
            if (node.matrix.size() == 16) own.matrix = glm::make_mat4(node.matrix.data());
            for (const int child : node.children) {
                item(model_.nodes, child, "node");
                int& parent = hierarchy_.nodes[static_cast<Index>(child)].parent;
                if (parent >= 0) fail("node " + std::to_string(child) + " has two parents");
                parent = static_cast<int>(i);
            }
        }
        for (Index i = 0; i < model_.nodes.size(); ++i) {
            Index steps = 0;
            for (int node = static_cast<int>(i); node >= 0;
                 node = hierarchy_.nodes[static_cast<Index>(node)].parent)
                if (++steps > model_.nodes.size()) fail("its nodes are parents of each other in a circle");
        }
    }

    Quat unit_quaternion(const double* xyzw) const {
        const Quat q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
        const double length = glm::length(q);
        if (!(length > 0.0 && std::isfinite(length))) fail("holds a rotation that is zero or not finite");
        return q / length;
    }

    void read_animation(const tinygltf::Animation& animation) {
        for (const tinygltf::AnimationChannel& channel : animation.channels) {
            if (channel.target_node < 0) continue;
            item(model_.nodes, channel.target_node, "node");
            const GltfNode& node = hierarchy_.nodes[static_cast<Index>(channel.target_node)];
            const std::string where = "animation of node '" + node.name + "'";
            if (channel.target_path != "translation" && channel.target_path != "rotation") {
                result_.notes.push_back(where + ": its " + channel.target_path +
                                        " channel is refused; bodies move rigidly");
                continue;
            }
            GltfTrack track;
            track.node = channel.target_node;
            track.is_rotation = channel.target_path == "rotation";
            const bool taken =
                std::any_of(hierarchy_.tracks.begin(), hierarchy_.tracks.end(), [&](const GltfTrack& t) {
                    return t.node == track.node && t.is_rotation == track.is_rotation;
                });
            if (taken || node.matrix) {
                result_.notes.push_back(where + (taken ? ": only the first of several animations is read"
                                                       : ": refused, the node is placed by a matrix"));
                continue;
            }
            read_keys(item(animation.samplers, channel.sampler, "animation sampler"), where, track);
            hierarchy_.tracks.push_back(std::move(track));
        }
    }

    void read_keys(const tinygltf::AnimationSampler& sampler, const std::string& where,
                   GltfTrack& track) const {
        track.interpolation = sampler.interpolation == "STEP"          ? model::Interpolation::Step
                              : sampler.interpolation == "CUBICSPLINE" ? model::Interpolation::Cubic
                                                                       : model::Interpolation::Linear;
        track.times_s = numbers(sampler.input, TINYGLTF_TYPE_SCALAR, "key times");
        for (Index k = 0; k < track.times_s.size(); ++k)
            if (!std::isfinite(track.times_s[k]) || (k > 0 && !(track.times_s[k] > track.times_s[k - 1])))
                fail(where + ": its key times do not increase");
        const Index width = track.is_rotation ? 4 : 3;
        const std::vector<double> values = numbers(
            sampler.output, track.is_rotation ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3, "key values");
        const bool cubic = track.interpolation == model::Interpolation::Cubic;
        const Index keys = track.times_s.size(), per_key = cubic ? 3 : 1;
        if (keys == 0 || values.size() != keys * per_key * width)
            fail(where + ": key times and values differ in number");
        if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
            fail(where + ": a key value is not finite");
        const auto raw = [&](Index entry) {
            const double* v = values.data() + entry * width;
            return Quat(track.is_rotation ? v[3] : 0.0, v[0], v[1], v[2]);
        };
        for (Index k = 0; k < keys; ++k) {
            const Index entry = cubic ? 3 * k + 1 : k;
            // A spline is made unit after it has been evaluated, not at its keys.
            const Quat unit = track.is_rotation ? unit_quaternion(values.data() + entry * width) : raw(entry);
            track.values.push_back(cubic ? raw(entry) : unit);
            if (!cubic) continue;
            track.in_tangents.push_back(raw(entry - 1));
            track.out_tangents.push_back(raw(entry + 1));
        }
    }

    // Objects in the order of the scene's tree.
    void add_objects() {
        std::vector<int> roots;
        if (!model_.scenes.empty()) {
            roots = item(model_.scenes, std::max(model_.defaultScene, 0), "scene").nodes;
            if (model_.scenes.size() > 1)
                result_.notes.emplace_back("only the default one of several scenes is read");
        } else {
            for (Index i = 0; i < model_.nodes.size(); ++i)
                if (hierarchy_.nodes[i].parent < 0) roots.push_back(static_cast<int>(i));
        }
        std::vector<std::uint8_t> seen(model_.nodes.size(), 0);
        std::vector<int> open(roots.rbegin(), roots.rend());
        while (!open.empty()) {
            const int node = open.back();
            open.pop_back();
            const tinygltf::Node& own = item(model_.nodes, node, "node");
            if (seen[static_cast<Index>(node)]++ != 0) continue;
            if (own.mesh >= 0) add_object(node);
            open.insert(open.end(), own.children.rbegin(), own.children.rend());
        }
    }

    void add_object(int node) {
        model::Object object;
        const std::string& name = hierarchy_.nodes[static_cast<Index>(node)].name;
        const Mat4 world = hierarchy_.rest_world_from_node(node);
        const tinygltf::Mesh& mesh = item(model_.meshes, model_.nodes[static_cast<Index>(node)].mesh, "mesh");
        for (const tinygltf::Primitive& primitive : mesh.primitives)
            append(primitive, world, object.mesh, name);
        if (object.mesh.triangles.empty()) return;
        object.name = unique_name(name, taken_);
        object.source = file_.name() + ":" + name;
        object.motion = motion_of(node);
        std::vector<std::string> names{object.name, mesh.name};
        for (int n = node; n >= 0; n = hierarchy_.nodes[static_cast<Index>(n)].parent)
            names.push_back(hierarchy_.nodes[static_cast<Index>(n)].name);
        result_.objects.push_back(std::move(object));
        result_.groups.push_back(std::move(names));
    }

    // The motion of the nearest animated node above, which is carried by those above that.
    std::optional<MotionId> motion_of(int node) {
        const int mover = hierarchy_.mover_of(node);
        if (mover < 0) return std::nullopt;
        const auto known = motions_.find(mover);
        if (known != motions_.end()) return known->second;
        const GltfNode& own = hierarchy_.nodes[static_cast<Index>(mover)];
        const auto parent = own.parent >= 0 ? motion_of(own.parent) : std::nullopt;
        std::optional<model::Motion> motion = hierarchy_.motion_of(mover);
        if (!motion) {
            result_.notes.push_back("animation of node '" + own.name +
                                    "' is refused: with its scaled parents it is not a rigid motion");
            return motions_[mover] = parent;
        }
        motion->name = unique_name(motion->name, motion_names_);
        motion->parent = parent;
        result_.motions.push_back(std::move(*motion));
        return motions_[mover] = MotionId(result_.motions.size() - 1);
    }

    void append(const tinygltf::Primitive& primitive, const Mat4& world, model::Mesh& mesh,
                const std::string& node) {
        const bool is_surface = primitive.mode == TINYGLTF_MODE_TRIANGLES ||
                                primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
                                primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
        const auto position = primitive.attributes.find("POSITION");
        if (!is_surface || position == primitive.attributes.end()) {
            ++lines_;
            return;
        }
        const std::vector<double> values = numbers(position->second, TINYGLTF_TYPE_VEC3, "positions");
        const Index count = values.size() / 3;
        const auto base = static_cast<std::uint32_t>(mesh.points.size());
        for (Index i = 0; i < count; ++i)
            mesh.points.emplace_back(world *
                                     glm::dvec4(values[3 * i], values[3 * i + 1], values[3 * i + 2], 1.0));

        std::vector<std::uint32_t> corners(count);
        for (Index i = 0; i < count; ++i) corners[i] = static_cast<std::uint32_t>(i);
        if (primitive.indices >= 0) {
            const std::vector<double> indices = numbers(primitive.indices, TINYGLTF_TYPE_SCALAR, "indices");
            corners.clear();
            for (const double index : indices) {
                if (!(index >= 0.0 && index < static_cast<double>(count)))
                    throw core::GeometryError(file_.name() + ": node '" + node +
                                              "' names a vertex that does not exist");
                corners.push_back(static_cast<std::uint32_t>(index));
            }
        }
        if (primitive.mode == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0)
            fail("node '" + node + "' ends in the middle of a triangle");
        const MaterialId material = material_of(primitive.material);
        const bool mirrored = glm::determinant(Mat3(world)) < 0.0;
        for (model::Triangle t : triangles(corners, primitive.mode)) {
            if (mirrored) std::swap(t[1], t[2]);
            mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
            mesh.materials.push_back(material);
            mesh.source_faces.push_back(face_++);
        }
    }

    static std::vector<model::Triangle> triangles(const std::vector<std::uint32_t>& corners, int mode) {
        std::vector<model::Triangle> result;
        if (mode == TINYGLTF_MODE_TRIANGLES) {
            for (Index i = 0; i + 2 < corners.size(); i += 3)
                result.push_back({corners[i], corners[i + 1], corners[i + 2]});
            return result;
        }
        for (Index i = 0; i + 2 < corners.size(); ++i) {
            if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
                result.push_back({corners[i + 1], corners[i + 2], corners[0]});
            else if (i % 2 == 0)
                result.push_back({corners[i], corners[i + 1], corners[i + 2]});
            else
                result.push_back({corners[i], corners[i + 2], corners[i + 1]});
        }
        return result;
    }

    MaterialId material_of(int index) {
        if (index < 0) return collector_.default_grey();
        const tinygltf::Material& material = item(model_.materials, index, "material");
        const auto known = materials_.find(index);
        if (known != materials_.end()) return known->second;
        const auto& pbr = material.pbrMetallicRoughness;
        const Vec3 colour = pbr.baseColorFactor.size() >= 3
                                ? Vec3(pbr.baseColorFactor[0], pbr.baseColorFactor[1], pbr.baseColorFactor[2])
                                : Vec3(1.0);
        Vec3 emission = vec3_or(material.emissiveFactor, Vec3(0.0));
        const auto strength = material.extensions.find("KHR_materials_emissive_strength");
        if (strength != material.extensions.end() && strength->second.Has("emissiveStrength"))
            emission *= strength->second.Get("emissiveStrength").GetNumberAsDouble();
        const std::string name = material.name.empty() ? "material " + std::to_string(index) : material.name;
        if (pbr.baseColorTexture.index >= 0 || material.emissiveTexture.index >= 0) textured_.push_back(name);
        if (material.alphaMode == "BLEND") transparent_.push_back(name);
        return materials_[index] = collector_.add(
                   name, colour, emission, material.doubleSided ? model::Sides::Both : model::Sides::Auto);
    }

    void note_what_is_left_out() {
        auto& notes = result_.notes;
        if (!textured_.empty())
            notes.push_back("textures are not read, only the factors of: " + short_list(textured_));
        if (!transparent_.empty())
            notes.push_back("transparent materials are opaque here: " + short_list(transparent_));
        if (lines_ > 0)
            notes.push_back(std::to_string(lines_) + " primitives of points or lines are left out");
        if (!model_.skins.empty())
            notes.emplace_back("skins are not read; their meshes keep the shape they are stored in");
        std::vector<std::string> lights;
        for (const tinygltf::Light& light : model_.lights)
            lights.push_back(light.type + " light '" + light.name + "'");
        if (!lights.empty())
            notes.push_back(
                "lights without a surface (KHR_lights_punctual) are not read; emissive materials are: " +
                short_list(lights));
    }

    const MeshFile& file_;
    tinygltf::Model model_;
    MaterialCollector collector_;
    GltfHierarchy hierarchy_;
    ImportedMeshes result_;
    std::map<int, MaterialId> materials_;
    std::map<int, std::optional<MotionId>> motions_;
    std::set<std::string> taken_, motion_names_;
    std::vector<std::string> textured_, transparent_;
    std::size_t lines_ = 0;
    std::uint32_t face_ = 0;
};

} // namespace

ImportedMeshes read_gltf(const MeshFile& file) { return GltfReader(file, load(file)).read(); }

} // namespace kinelux::io
