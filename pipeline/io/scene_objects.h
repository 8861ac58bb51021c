// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/mesh_import.h"
#include "io/scene_schema.h"

// Builds the bodies, materials and motions of a scene file. Private to io.
namespace kinelux::io {

/// A turn, uniform scaling and shift: x -> linear x + translation.
struct Placement {
    Mat3 linear{1.0};
    Quat rotation{1.0, 0.0, 0.0, 0.0}; ///< linear = scale x rotation
    double scale = 1.0;
    Vec3 translation{0.0}; ///< [m]

    Vec3 point(const Vec3& p) const { return linear * p + translation; }
    bool operator==(const Placement&) const = default;
};

/// The matrix without rounding that turns one axis direction into another one.
Mat3 turn_between(const Vec3& from, const Vec3& to);

/// A motion of a mesh file seen from where the mesh has been placed.
model::Motion placed(const model::Motion& motion, const Placement& placement);

/// Unit vector of "x", "y" or "z".
Vec3 axis_vector(const std::string& name);

/// Area that emits light [m2]: both sides of faces that are two-sided, and of sheets where the side is to be found out.
double emitting_area(const model::Mesh& mesh, const std::vector<model::Material>& materials);

/// Appends `part` to `mesh`.
void append(model::Mesh& mesh, const model::Mesh& part);

class SceneBuilder {
public:
    /// @param metres  metres per length unit of the file
    SceneBuilder(const SceneDocument& document, const FolderTree& tree, double metres, model::Scene& scene);

    /// Reads the mesh files, so that their up axis is known. @return  the first stated up axis
    std::optional<Vec3> read_meshes();
    void add_materials();
    void add_motions();
    void add_objects();

private:
    struct FileMotion {
        std::string file;
        Placement placement;
        MotionId id;
    };
    struct MotionEntry {
        const SceneSection* section = nullptr;
        std::optional<MotionId> id;         ///< of keyframes, shared by all objects
        std::vector<FileMotion> from_files; ///< of a glTF node, one for each place it was put
        bool used = false;
    };

    std::filesystem::path path_of(const std::string& name) const;
    std::vector<double> per_channel(const SceneSection& section, const std::string& key) const;
    std::optional<model::Sides> sides_of(const SceneSection& section) const;
    Quat rotation_of(const SceneSection& section) const;

    void add_object(const SceneSection& section);
    std::vector<std::size_t> selected(const SceneSection& section, const ImportedMeshes& meshes) const;
    Placement placement_of(const SceneSection& section, const ImportedMeshes& meshes) const;
    MaterialId file_material(const std::string& file, const model::Material& material);
    MaterialId named_material(const SceneSection& section, const std::string& file,
                              const ImportedMeshes& meshes);
    void derive_materials(const SceneSection& section, model::Mesh& mesh);
    MotionId motion_of(const SceneSection& section, const std::string& file, const ImportedMeshes& meshes,
                       const Placement& placement);
    MotionId node_motion(MotionEntry& entry, const SceneSection& object, const std::string& file,
                         const ImportedMeshes& meshes, const Placement& placement);
    model::Motion keyframed(const SceneSection& section) const;
    std::vector<model::Keyframe> keyframes_of(const SceneSection& section) const;
    std::vector<model::Keyframe> read_csv(const SceneSection& section) const;

    const SceneDocument& document_;
    const FolderTree& tree_;
    double metres_;
    model::Scene& scene_;
    std::map<std::string, ImportedMeshes> meshes_; ///< by the path as written
    std::map<std::string, MaterialId> materials_;  ///< of the scene file, by name
    std::map<std::string, MotionEntry> motions_;
    std::set<std::string> material_names_, object_names_, motion_names_;
};

} // namespace kinelux::io
