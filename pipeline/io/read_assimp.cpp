// SPDX-License-Identifier: GPL-3.0-or-later
#include <assimp/DefaultIOSystem.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <sstream>

#include <glm/geometric.hpp>

#include "core/error.h"
#include "io/mesh_import.h"

namespace kinelux::io {

namespace {

// Lets Assimp open only the mesh file and what lies in the scene's folder tree.
class GuardedFiles : public Assimp::DefaultIOSystem {
public:
    explicit GuardedFiles(const MeshFile& file) : file_(file) {}
    bool Exists(const char* file) const override { return readable(file) && DefaultIOSystem::Exists(file); }
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        return readable(file) ? DefaultIOSystem::Open(file, mode) : nullptr;
    }

private:
    bool readable(const char* file) const {
        if (file_.path == file) return true;
        try {
            file_.tree.require(file);
            return true;
        } catch (const core::FileError&) {
            return false;
        }
    }

    const MeshFile& file_;
};

const aiScene* import(Assimp::Importer& importer, const MeshFile& file, const std::string& hint) {
    importer.SetIOHandler(new GuardedFiles(file)); // the importer owns it
    // No post-processing: its steps abort the program on broken files, and polygons and points are ours to cut and join.
    constexpr unsigned steps = 0;
    const auto fail = [&](const std::string& reason) {
        throw core::FileError(file.name() + ": cannot be read as a mesh: " + reason);
    };
    const aiScene* scene = nullptr;
    try {
        scene = hint.empty()
                    ? importer.ReadFile(file.name(), steps)
                    : importer.ReadFileFromMemory(file.bytes.data(), file.bytes.size(), steps, hint.c_str());
    } catch (const std::exception& error) {
        fail(error.what());
    } catch (...) {
        fail("unknown failure");
    }
    if (scene == nullptr || scene->mRootNode == nullptr) fail(importer.GetErrorString());
    return scene;
}

// The counts that OFF and PLY files start with, before Assimp makes room for them: each item takes at least a byte.
void check_counts(const MeshFile& file, const std::string& format) {
    std::istringstream lines(file.bytes.substr(0, 65536));
    std::string word, kind;
    double count = 0.0, largest = 0.0;
    if (format == "off" && lines >> word >> count) largest = count;
    if (format == "off" && lines >> count) largest = std::max(largest, count);
    for (std::string line; format == "ply" && std::getline(lines, line) && !line.starts_with("end_header");) {
        std::istringstream words(line);
        if (words >> word >> kind >> count && word == "element") largest = std::max(largest, count);
    }
    if (largest > static_cast<double>(file.bytes.size()))
        throw core::FileError(file.name() +
                              ": is truncated: it promises more points or faces than it has bytes");
}

Mat4 matrix_of(const aiMatrix4x4& m) {
    return {{m.a1, m.b1, m.c1, m.d1},
            {m.a2, m.b2, m.c2, m.d2},
            {m.a3, m.b3, m.c3, m.d3},
            {m.a4, m.b4, m.c4, m.d4}};
}

// The axis that a turn of Assimp's root node takes to y: formats whose up axis is another one are turned by it.
std::optional<int> axis_turned_to_y(const Mat4& root) {
    constexpr double tolerance = 1e-5; // Assimp's single precision
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 image = glm::normalize(Vec3(root[axis]));
        if (std::abs(image.y - 1.0) < tolerance) return axis;
    }
    return std::nullopt;
}

// A rotation without rounding that takes `axis` back from y.
Mat4 turn_from_y_to(int axis) {
    if (axis == 2) return {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {0, 0, 0, 1}};
    if (axis == 0) return {{0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    return Mat4(1.0);
}

class AssimpReader {
public:
    AssimpReader(const MeshFile& file, const aiScene& scene)
        : file_(file), scene_(scene), collector_(file.channels) {}

    ImportedMeshes read(const std::string& format) {
        const Mat4 root = root_correction(format);
        visit(*scene_.mRootNode, root, {}, 0);
        if (scene_.HasAnimations()) result_.notes.emplace_back("animations are read from glTF files only");
        if (scene_.HasLights()) result_.notes.emplace_back("lights without a surface are not read");
        if (textured_)
            result_.notes.emplace_back("textures are not read, only the plain colours of materials");
        if (dropped_faces_ > 0)
            result_.notes.push_back(std::to_string(dropped_faces_) +
                                    " points, lines or broken faces are left out");
        collector_.finish(result_);
        return std::move(result_);
    }

private:
    // Undoes the turn to y-up that Assimp puts into the root node, so that coordinates stay those of the file.
    Mat4 root_correction(const std::string& format) {
        const std::optional<int> axis = axis_turned_to_y(matrix_of(scene_.mRootNode->mTransformation));
        const bool known = format == "dae" || format == "ifc" || format == "step" || format == "stp";
        if (known) {
            result_.unit_stated = true; // Assimp applies the unit of these
            result_.up[axis.value_or(1)] = 1.0;
        }
        if (format == "fbx") read_fbx_unit();
        const bool turned = axis && *axis != 1 && (known || format == "3ds" || format == "dxf");
        if (turned && !known) result_.up[*axis] = 1.0;
        return turned ? turn_from_y_to(*axis) : Mat4(1.0);
    }

    void read_fbx_unit() {
        double centimetres = 0.0;
        float single = 0.0F;
        const aiMetadata* data = scene_.mMetaData;
        if (data == nullptr) return;
        if (!data->Get("UnitScaleFactor", centimetres) && data->Get("UnitScaleFactor", single))
            centimetres = single;
        if (!(centimetres > 0.0)) return;
        result_.metres_per_unit = 0.01 * centimetres;
        result_.unit_stated = true;
        int axis = 1;
        if (data->Get("UpAxis", axis) && axis >= 0 && axis < 3) result_.up[axis] = 1.0;
    }

    void visit(const aiNode& node, const Mat4& parent, std::vector<std::string> names, int depth) {
        constexpr int deepest = 1000;
        if (depth > deepest) throw core::FileError(file_.name() + ": its nodes are nested too deeply");
        const Mat4 world = parent * matrix_of(node.mTransformation);
        if (node.mName.length > 0) names.emplace_back(node.mName.C_Str());
        add_object(node, world, names);
        for (unsigned i = 0; i < node.mNumChildren; ++i) visit(*node.mChildren[i], world, names, depth + 1);
    }

    void add_object(const aiNode& node, const Mat4& world, std::vector<std::string> names) {
        model::Object object;
        for (unsigned i = 0; i < node.mNumMeshes; ++i)
            if (node.mMeshes[i] < scene_.mNumMeshes)
                append(*scene_.mMeshes[node.mMeshes[i]], world, object.mesh);
        if (object.mesh.triangles.empty()) return;
        std::string name = node.mName.C_Str();
        const bool plain = name.empty() || name.front() == '<' || &node == scene_.mRootNode;
        if (plain) name = file_.path.stem().string();
        object.name = unique_name(name, taken_);
        object.source = plain ? file_.name() : file_.name() + ":" + name;
        names.push_back(object.name);
        result_.objects.push_back(std::move(object));
        result_.groups.push_back(std::move(names));
    }

    void append(const aiMesh& part, const Mat4& world, model::Mesh& mesh) {
        std::vector<std::uint32_t> numbers; // in `mesh`, of the points of `part`; those at one place are one
        std::map<std::array<double, 3>, std::uint32_t> known;
        for (unsigned i = 0; i < part.mNumVertices; ++i) {
            const aiVector3D& p = part.mVertices[i];
            const Vec3 point(world * glm::dvec4(p.x, p.y, p.z, 1.0));
            const auto [place, is_new] = known.try_emplace({point.x, point.y, point.z}, mesh.points.size());
            if (is_new) mesh.points.push_back(point);
            numbers.push_back(place->second);
        }
        const MaterialId material = material_of(part.mMaterialIndex);
        const bool mirrored = glm::determinant(Mat3(world)) < 0.0;
        for (unsigned f = 0; f < part.mNumFaces; ++f, ++face_) {
            const std::vector<std::uint32_t> corners = corners_of(part.mFaces[f], numbers);
            if (corners.size() < 3) {
                ++dropped_faces_;
                continue;
            }
            std::vector<Vec3> points;
            points.reserve(corners.size());
            for (const std::uint32_t corner : corners) points.push_back(mesh.points[corner]);
            for (model::Triangle t : triangulate_polygon(points)) {
                if (mirrored) std::swap(t[1], t[2]);
                mesh.triangles.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
                mesh.materials.push_back(material);
                mesh.source_faces.push_back(face_);
            }
        }
    }

    // Nothing where an index is out of range.
    static std::vector<std::uint32_t> corners_of(const aiFace& face,
                                                 const std::vector<std::uint32_t>& numbers) {
        std::vector<std::uint32_t> corners;
        for (unsigned i = 0; i < face.mNumIndices; ++i) {
            if (face.mIndices[i] >= numbers.size()) return {};
            corners.push_back(numbers[face.mIndices[i]]);
        }
        return corners;
    }

    MaterialId material_of(unsigned index) {
        if (index >= scene_.mNumMaterials) return collector_.default_grey();
        const auto known = materials_.find(index);
        if (known != materials_.end()) return known->second;
        const aiMaterial& material = *scene_.mMaterials[index];
        aiString name;
        material.Get(AI_MATKEY_NAME, name);
        aiColor3D diffuse, emission(0.0F, 0.0F, 0.0F);
        int two_sided = 0;
        material.Get(AI_MATKEY_COLOR_EMISSIVE, emission);
        material.Get(AI_MATKEY_TWOSIDED, two_sided);
        textured_ = textured_ || material.GetTextureCount(aiTextureType_DIFFUSE) > 0;
        const std::string text = name.C_Str();
        const bool made_up = text == AI_DEFAULT_MATERIAL_NAME || text.empty();
        if (made_up || material.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse) != AI_SUCCESS)
            return materials_[index] = made_up ? collector_.default_grey() : collector_.undescribed(text);
        return materials_[index] = collector_.add(text, {diffuse.r, diffuse.g, diffuse.b},
                                                  {emission.r, emission.g, emission.b},
                                                  two_sided != 0 ? model::Sides::Both : model::Sides::Auto);
    }

    const MeshFile& file_;
    const aiScene& scene_;
    MaterialCollector collector_;
    ImportedMeshes result_;
    std::map<unsigned, MaterialId> materials_;
    std::set<std::string> taken_;
    std::uint32_t face_ = 0;
    std::size_t dropped_faces_ = 0;
    bool textured_ = false;
};

} // namespace

ImportedMeshes read_assimp(const MeshFile& file, const std::string& hint) {
    std::string format = hint;
    if (format.empty() && !file.path.extension().empty()) format = file.path.extension().string().substr(1);
    for (char& c : format) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    check_counts(file, format);
    Assimp::DefaultLogger::kill(); // nothing on our terminal
    Assimp::Importer importer;
    const aiScene* scene = import(importer, file, hint);
    return AssimpReader(file, *scene).read(format);
}

} // namespace kinelux::io
