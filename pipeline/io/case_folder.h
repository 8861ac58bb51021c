// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "model/cluster_tree.h"
#include "model/coefficients.h"
#include "model/patch_set.h"
#include "model/plan.h"
#include "model/scene.h"
#include "model/solution.h"

namespace kinelux::io {

/// The folder that the stages of one case read from and write into. Every file states its format version and the hash
/// of the file it was made from; reading refuses a newer version and a file made from something else than what lies
/// beside it. Files are written aside and renamed when whole.
///
///   scene.json        the effective scene without meshes (units applied, defaults filled in)   made by clean
///   clean.vtm         the cleaned meshes, one clean/<object>.vtp each                          made by clean
///   patches.h5/.vtu   made from scene.json          clusters.h5/.vtu   made from patches.h5
///   plan.json         made from clusters.h5         coefficients.h5    made from plan.json
///   solution.h5       made from coefficients.h5
class CaseFolder {
public:
    /// @throws FileError  `folder` exists and is not a folder, or cannot be made (create = true)
    explicit CaseFolder(std::filesystem::path folder, bool create = false);

    const std::filesystem::path& path() const { return folder_; }
    std::filesystem::path file(const std::string& name) const { return folder_ / name; }

    // Each read throws FileError: missing (says which stage makes it), truncated, newer version, foreign origin.
    model::Scene read_scene() const; ///< with the cleaned meshes
    model::PatchSet read_patches() const;
    model::ClusterTree read_clusters() const;
    model::Plan read_plan() const;
    model::Coefficients read_coefficients() const;
    model::Solution read_solution() const;

    void write_scene(const model::Scene& clean_scene) const;
    void write_patches(const model::PatchSet& patches, const model::Scene& scene) const;
    void write_clusters(const model::ClusterTree& tree, const model::PatchSet& patches) const;
    void write_plan(const model::Plan& plan) const;
    void
    write_coefficients(const model::Coefficients& coefficients) const; ///< and removes coefficients-so-far.h5
    void write_solution(const model::Solution& solution) const;        ///< and removes solution-so-far.h5

    /// What an interrupted computation of the coefficients has left: coefficients-so-far.h5.
    /// @param key  a hash of all that decides the result
    void write_coefficients_so_far(const model::CoefficientsSoFar& so_far, const std::string& key) const;
    /// @return  nothing when there is none, or one with another key
    /// @throws FileError  damaged
    std::optional<model::CoefficientsSoFar> read_coefficients_so_far(const std::string& key) const;

    /// What an interrupted solve has left: solution-so-far.h5.
    /// @param key  a hash of all that decides the result
    void write_solution_so_far(const model::Solution& solution, const model::SolverState& state,
                               const std::string& key) const;
    /// @return  nothing when there is none, or one with another key
    /// @throws FileError  damaged
    std::optional<model::SolutionSoFar> read_solution_so_far(const std::string& key) const;

private:
    std::filesystem::path folder_;
};

} // namespace kinelux::io
