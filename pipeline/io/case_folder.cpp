// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/case_folder.h"

#include <array>
#include <fstream>
#include <iterator>
#include <new>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>

#include "core/error.h"
#include "core/hash.h"
#include "core/run_record.h"
#include "io/case_hdf5.h"
#include "io/case_views.h"
#include "io/hdf5_file.h"
#include "io/scene_json.h"

namespace kinelux::io {

namespace fs = std::filesystem;

namespace {

/// The version that this program writes, and the newest that it reads, of every file below.
constexpr std::int64_t format_version = 1;

struct FileKind {
    const char* name;
    const char* format;
    const char* stage;           ///< the executable that makes it
    const FileKind* predecessor; ///< what it is made from
};

constexpr FileKind scene_kind{"scene.json", "kinelux-scene", "kinelux-clean", nullptr};
constexpr FileKind patches_kind{"patches.h5", "kinelux-patches", "kinelux-fit", &scene_kind};
constexpr FileKind clusters_kind{"clusters.h5", "kinelux-clusters", "kinelux-cluster", &patches_kind};
constexpr FileKind plan_kind{"plan.json", "kinelux-plan", "kinelux-plan", &clusters_kind};
constexpr FileKind coefficients_kind{"coefficients.h5", "kinelux-coefficients", "kinelux-coefficients",
                                     &plan_kind};
constexpr FileKind solution_kind{"solution.h5", "kinelux-solution", "kinelux-solve", &coefficients_kind};
constexpr FileKind rows_kind{"coefficients-so-far.h5", "kinelux-coefficients-so-far", "kinelux-coefficients",
                             &plan_kind};
constexpr FileKind so_far_kind{"solution-so-far.h5", "kinelux-solution-so-far", "kinelux-solve",
                               &coefficients_kind};

std::string what_to_do(const FileKind& kind, const fs::path& folder) {
    if (kind.predecessor == nullptr) return fmt::format("run {} on the scene again", kind.stage);
    return fmt::format("run {} {} again", kind.stage, folder.string());
}

core::FileError bad_file(const FileKind& kind, const fs::path& folder, const std::string& what) {
    return core::FileError(
        fmt::format("{}: {}; {}", (folder / kind.name).string(), what, what_to_do(kind, folder)));
}

/// Runs a reader; whatever goes wrong names the file and what to do.
template <class Read>
auto guarded(const FileKind& kind, const fs::path& folder, Read read) {
    try {
        return read();
    } catch (const core::Error& error) {
        throw bad_file(kind, folder, error.what());
    } catch (const std::bad_alloc&) {
        throw bad_file(kind, folder, "damaged, or larger than the memory");
    } catch (const std::length_error&) {
        throw bad_file(kind, folder, "damaged");
    }
}

std::string read_text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    if (!in) throw core::FileError("cannot be read");
    return text;
}

FileHeader read_header(const FileKind& kind, const fs::path& folder) {
    const fs::path file = folder / kind.name;
    if (file.extension() == ".json") return header_from_json(read_text(file));
    const Hdf5Reader reader(file);
    return {.format = reader.text("format"),
            .version = reader.integer("version"),
            .program = reader.text("program"),
            .made_from = reader.text("made_from")};
}

void check_header(const FileHeader& header, const FileKind& kind) {
    if (header.format != kind.format)
        throw core::FileError(fmt::format("its format is '{}', not '{}'", header.format, kind.format));
    if (header.version > format_version)
        throw core::FileError(
            fmt::format("it has format version {} of Kinelux {}, this is {}, which reads up to {}: "
                        "use the newer program, or",
                        header.version, header.program, core::version(), format_version));
    if (header.version < 1)
        throw core::FileError(fmt::format("there is no format version {}", header.version));
}

/// A file is usable when it and all that it was made from are what they were: an export must not mix an old solution
/// with new patches. @throws FileError  names the first stale file, counted from the scene
void check_origin(const FileKind& kind, const fs::path& folder) {
    if (kind.predecessor != nullptr) check_origin(*kind.predecessor, folder);
    if (!fs::is_regular_file(folder / kind.name)) {
        const std::string stage = kind.predecessor == nullptr
                                      ? fmt::format("{} on the scene", kind.stage)
                                      : fmt::format("{} {}", kind.stage, folder.string());
        throw core::FileError(fmt::format("{}: missing; run {} first", (folder / kind.name).string(), stage));
    }
    guarded(kind, folder, [&] {
        const FileHeader header = read_header(kind, folder);
        check_header(header, kind);
        if (kind.predecessor != nullptr &&
            header.made_from != core::file_hash(folder / kind.predecessor->name))
            throw core::FileError(
                fmt::format("made from another {} than lies beside it", kind.predecessor->name));
    });
}

FileHeader new_header(const FileKind& kind, const fs::path& folder) {
    FileHeader header{
        .format = kind.format, .version = format_version, .program = std::string(core::version())};
    if (kind.predecessor != nullptr) header.made_from = core::file_hash(folder / kind.predecessor->name);
    return header;
}

/// Writes an .h5 file of a case: its header, then what put(file) puts into it.
template <class Put>
void write_hdf5(const FileKind& kind, const fs::path& folder, Put put) {
    const FileHeader header = new_header(kind, folder);
    Hdf5Writer file(folder / kind.name);
    file.attribute("format", header.format);
    file.attribute("version", header.version);
    file.attribute("program", header.program);
    file.attribute("made_from", header.made_from);
    put(file);
    file.finish();
}

/// scene.json without the meshes: enough for names, materials and counts.
SceneFile read_scene_file(const fs::path& folder) {
    check_origin(scene_kind, folder);
    return guarded(scene_kind, folder, [&] { return scene_from_json(read_text(folder / scene_kind.name)); });
}

model::PatchSet read_patches_of(const fs::path& folder, const model::Scene& scene) {
    return guarded(patches_kind, folder, [&] {
        model::PatchSet patches = get_patches(Hdf5Reader(folder / patches_kind.name));
        model::check(patches, scene);
        return patches;
    });
}

void check_layout(const model::UnknownLayout& layout) {
    for (std::size_t e = 0; e < layout.elements(); ++e)
        if (layout.offsets[e + 1] < layout.offsets[e])
            throw core::FileError(fmt::format("element {} ends before it starts", e));
}

/// What an interrupted run has left under this key, if any.
template <class Get, class SoFar = std::invoke_result_t<Get, const Hdf5Reader&>>
std::optional<SoFar> read_so_far(const FileKind& kind, const fs::path& folder, const std::string& key,
                                 Get get) {
    if (!fs::is_regular_file(folder / kind.name)) return std::nullopt;
    return guarded(kind, folder, [&]() -> std::optional<SoFar> {
        check_header(read_header(kind, folder), kind);
        const Hdf5Reader file(folder / kind.name);
        if (file.text("key") != key) return std::nullopt;
        return get(file);
    });
}

} // namespace

CaseFolder::CaseFolder(fs::path folder, bool create) : folder_(std::move(folder)) {
    std::error_code failed;
    if (fs::exists(folder_) && !fs::is_directory(folder_))
        throw core::FileError(
            fmt::format("{}: is not a folder; name the folder of a case", folder_.string()));
    if (create) fs::create_directories(folder_, failed);
    if (failed)
        throw core::FileError(fmt::format("{}: cannot be made: {}", folder_.string(), failed.message()));
    if (!create && !fs::exists(folder_))
        throw core::FileError(
            fmt::format("{}: there is no such case; run kinelux-clean on the scene first", folder_.string()));
}

model::Scene CaseFolder::read_scene() const {
    SceneFile file = read_scene_file(folder_);
    return guarded(scene_kind, folder_, [&] {
        for (std::size_t o = 0; o < file.meshes.size(); ++o) {
            const MeshFile& mesh = file.meshes[o];
            if (core::file_hash(folder_ / mesh.path) != mesh.hash)
                throw core::FileError(
                    fmt::format("'{}' is not the mesh that was written with it", mesh.path));
            file.scene.objects[o].mesh = read_clean_mesh(folder_ / mesh.path);
        }
        model::check(file.scene);
        return std::move(file.scene);
    });
}

model::PatchSet CaseFolder::read_patches() const {
    check_origin(patches_kind, folder_);
    return read_patches_of(folder_, read_scene_file(folder_).scene);
}

model::ClusterTree CaseFolder::read_clusters() const {
    check_origin(clusters_kind, folder_);
    const model::PatchSet patches = read_patches_of(folder_, read_scene_file(folder_).scene);
    return guarded(clusters_kind, folder_, [&] {
        model::ClusterTree tree = get_clusters(Hdf5Reader(folder_ / clusters_kind.name));
        model::check(tree, patches);
        return tree;
    });
}

model::Plan CaseFolder::read_plan() const {
    check_origin(plan_kind, folder_);
    return guarded(plan_kind, folder_, [&] { return plan_from_json(read_text(folder_ / plan_kind.name)); });
}

model::Coefficients CaseFolder::read_coefficients() const {
    check_origin(coefficients_kind, folder_);
    return guarded(coefficients_kind, folder_, [&] {
        model::Coefficients coefficients = get_coefficients(Hdf5Reader(folder_ / coefficients_kind.name));
        model::check(coefficients);
        return coefficients;
    });
}

model::Solution CaseFolder::read_solution() const {
    check_origin(solution_kind, folder_);
    return guarded(solution_kind, folder_, [&] {
        model::Solution solution = get_solution(Hdf5Reader(folder_ / solution_kind.name));
        check_layout(solution.layout);
        return solution;
    });
}

void CaseFolder::write_scene(const model::Scene& clean_scene) const {
    // scene.json comes last: it holds the hashes of the meshes, so that an interrupted run is noticed.
    const std::vector<MeshFile> meshes = write_clean_meshes(folder_, clean_scene);
    core::write_whole_file(folder_ / scene_kind.name,
                           scene_to_json(new_header(scene_kind, folder_), clean_scene, meshes));
}

void CaseFolder::write_patches(const model::PatchSet& patches, const model::Scene& scene) const {
    write_patches_view(folder_ / "patches.vtu", patches, scene);
    write_hdf5(patches_kind, folder_, [&](Hdf5Writer& file) { put_patches(file, patches); });
}

void CaseFolder::write_clusters(const model::ClusterTree& tree, const model::PatchSet& patches) const {
    write_clusters_view(folder_ / "clusters.vtu", tree, patches, read_scene_file(folder_).scene);
    write_hdf5(clusters_kind, folder_, [&](Hdf5Writer& file) { put_clusters(file, tree); });
}

void CaseFolder::write_plan(const model::Plan& plan) const {
    core::write_whole_file(folder_ / plan_kind.name, plan_to_json(new_header(plan_kind, folder_), plan));
}

void CaseFolder::write_coefficients(const model::Coefficients& coefficients) const {
    write_hdf5(coefficients_kind, folder_, [&](Hdf5Writer& file) { put_coefficients(file, coefficients); });
    std::error_code ignored;
    fs::remove(folder_ / rows_kind.name, ignored);
}

void CaseFolder::write_solution(const model::Solution& solution) const {
    write_hdf5(solution_kind, folder_, [&](Hdf5Writer& file) { put_solution(file, solution); });
    std::error_code ignored;
    fs::remove(folder_ / so_far_kind.name, ignored);
}

void CaseFolder::write_solution_so_far(const model::Solution& solution, const model::SolverState& state,
                                       const std::string& key) const {
    write_hdf5(so_far_kind, folder_, [&](Hdf5Writer& file) {
        file.attribute("key", key);
        put_solution_so_far(file, solution, state);
    });
}

std::optional<model::SolutionSoFar> CaseFolder::read_solution_so_far(const std::string& key) const {
    return read_so_far(so_far_kind, folder_, key, get_solution_so_far);
}

void CaseFolder::write_coefficients_so_far(const model::CoefficientsSoFar& so_far,
                                           const std::string& key) const {
    write_hdf5(rows_kind, folder_, [&](Hdf5Writer& file) {
        file.attribute("key", key);
        put_coefficients_so_far(file, so_far);
    });
}

std::optional<model::CoefficientsSoFar> CaseFolder::read_coefficients_so_far(const std::string& key) const {
    return read_so_far(rows_kind, folder_, key, [](const Hdf5Reader& file) {
        model::CoefficientsSoFar so_far = get_coefficients_so_far(file);
        model::check(so_far.coefficients);
        return so_far;
    });
}

} // namespace kinelux::io
