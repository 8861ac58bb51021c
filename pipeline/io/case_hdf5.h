// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/hdf5_file.h"
#include "model/cluster_tree.h"
#include "model/coefficients.h"
#include "model/patch_set.h"
#include "model/solution.h"

namespace kinelux::io {

// The datasets of the .h5 files of a case; docs/formats.md lists them. Reading checks shapes, not meaning: model::check
// does that. Lists of lists are stored end to end, list i being [NAME_offsets[i], NAME_offsets[i + 1]) of NAME.

void put_patches(Hdf5Writer& file, const model::PatchSet& patches);
model::PatchSet get_patches(const Hdf5Reader& file);

void put_clusters(Hdf5Writer& file, const model::ClusterTree& tree);
model::ClusterTree get_clusters(const Hdf5Reader& file);

void put_coefficients(Hdf5Writer& file, const model::Coefficients& coefficients);
model::Coefficients get_coefficients(const Hdf5Reader& file);

/// Coefficients of which the first rows are done; the hierarchy is left out.
void put_coefficients_so_far(Hdf5Writer& file, const model::CoefficientsSoFar& so_far);
model::CoefficientsSoFar get_coefficients_so_far(const Hdf5Reader& file);

void put_solution(Hdf5Writer& file, const model::Solution& solution);
model::Solution get_solution(const Hdf5Reader& file);

/// A solution of which the first frames are done, with what the solver needs to go on.
void put_solution_so_far(Hdf5Writer& file, const model::Solution& solution, const model::SolverState& state);
model::SolutionSoFar get_solution_so_far(const Hdf5Reader& file);

} // namespace kinelux::io
