// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/mesh_import.h"
#include "io/number_table.h"
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

/// A turn as it is written in a scene file; several times round where the angle says so.
struct AxisTurn {
    Vec3 axis{0.0};       ///< unit; zero where nothing turns
    double degrees = 0.0; ///< any

    Quat rotation() const;
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
    // In this order:
    void add_dimmings();
    void add_materials();
    void add_motions();
    void add_objects();
    void add_meters();
    void add_parents();
    /// @throws OptionError  a motion or dimming that nothing follows
    void refuse_unused() const;

private:
    struct FileMotion {
        std::string file;
        Placement placement;
        MotionId id;
        MotionId top; ///< of the highest animated node above it, or itself
    };
    struct MotionEntry {
        const SceneSection* section = nullptr;
        std::optional<MotionId> id;         ///< of keyframes, shared by all objects
        std::vector<FileMotion> from_files; ///< of a glTF node, one for each place it was put
        bool used = false;                  ///< by an object, a meter, or a motion that is
    };
    struct DimmingEntry {
        const SceneSection* section = nullptr;
        DimmingId id;
        bool used = false;
    };

    std::filesystem::path path_of(const std::string& name) const;
    std::vector<double> per_channel(const SceneSection& section, const std::string& key) const;
    std::optional<model::Sides> sides_of(const SceneSection& section) const;
    AxisTurn turn_of(const SceneSection& section) const;

    void add_object(const SceneSection& section);
    std::vector<std::size_t> selected(const SceneSection& section, const ImportedMeshes& meshes) const;
    Placement placement_of(const SceneSection& section, const ImportedMeshes& meshes) const;
    MaterialId file_material(const std::string& file, const model::Material& material);
    MaterialId named_material(const SceneSection& section, const std::string& file,
                              const ImportedMeshes& meshes);
    void derive_materials(const SceneSection& section, model::Mesh& mesh);
    /// @param derived  material of the file -> the object's own
    void set_exitance(const SceneSection& section, const model::Mesh& mesh,
                      const std::map<MaterialId, MaterialId>& derived);
    MotionId motion_of(const SceneSection& section, const std::string& file, const ImportedMeshes& meshes,
                       const Placement& placement);
    MotionId node_motion(MotionEntry& entry, const SceneSection& object, const std::string& file,
                         const ImportedMeshes& meshes, const Placement& placement);
    /// The motion that a key of a section names.
    MotionEntry& entry_of(const SceneSection& section, const std::string& key);
    /// The one motion of the scene behind an entry, for meters and other motions, which have no file of their own.
    MotionId carrier(const MotionEntry& entry, const SceneSection& section, const std::string& key) const;
    model::Motion keyframed(const SceneSection& section) const;
    std::vector<model::Keyframe> keyframes_of(const SceneSection& section) const;
    std::vector<model::Keyframe> keyframes_from_csv(const SceneSection& section) const;
    NumberTable read_csv(const SceneSection& section,
                         const std::vector<std::vector<std::string>>& headers) const;
    std::vector<model::Dimming::Key> dimming_keys(const SceneSection& section) const;
    std::vector<model::Dimming::Key> dimming_from_csv(const SceneSection& section) const;
    DimmingId dimming_of(const SceneSection& section);

    const SceneDocument& document_;
    const FolderTree& tree_;
    double metres_;
    model::Scene& scene_;
    std::map<std::string, ImportedMeshes> meshes_; ///< by the path as written
    std::map<std::string, MaterialId> materials_;  ///< of the scene file, by name
    std::map<std::string, MotionEntry> motions_;
    std::map<std::string, DimmingEntry> dimmings_;
    std::set<std::string> material_names_, object_names_, motion_names_;
};

} // namespace kinelux::io
