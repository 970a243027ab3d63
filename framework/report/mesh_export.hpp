// SPDX-License-Identifier: MIT
// Export of reconstructed surfaces and contacts as PLY, for programs that show meshes. The tables of a run are its
// surface.csv and taps.csv.
#pragma once

#include "experiment/experiment.hpp"
#include "record/run_replay.hpp"

#include <palpate/surface.hpp>

#include <optional>
#include <string>

namespace palpate {

/// Returns a mesh over a grid of candidates: one vertex per candidate, in their order, and two triangles per four
/// neighbours; no triangles if the grid is one candidate wide. `heights` and their `deviations` are metres, one per
/// candidate. Normals follow from central differences of the heights, one-sided at the edges. A direction with a single
/// candidate counts as level.
Surface surface_mesh(const CandidateGrid& candidates, const Eigen::VectorXd& heights,
                     const Eigen::VectorXd& deviations);

/// The reconstructed surface; one value per candidate.
struct ReconstructedSurface {
  Surface mesh;
  Eigen::VectorXd object_probability;  ///< by the footprint of the config
  std::optional<Eigen::VectorXd> true_height;
};

/// Returns the surface after the taps so far; builds the models that it needs.
ReconstructedSurface reconstruct(Experiment& experiment);

/// Returns PLY 1.0 in ASCII: x, y, z, nx, ny, nz in double precision; in single precision, which MeshLab requires,
/// `quality` (the standard deviation), `object_probability` and, if known, `true_height`. ASCII keeps positions exact
/// to the bit on every machine and is readable by people. `run` is a comment that names the run, after header_text().
std::string surface_ply(const ReconstructedSurface& surface, const std::string& run);

/// Returns the finest closed mesh of a run from any side, in the format of mesh_ply().
std::string surface_ply(const Surface& mesh, const std::string& run);

/// Returns the contacts as points: x, y, z; from any side also nx, ny, nz, the direction towards the tool; `tap`, its
/// number; `on_object`, 1 or 0, the label in `counts`, the result after all taps.
std::string taps_ply(const RecordedRun& recording, const RunResult& counts, const std::string& run);

/// Returns text that a PLY header can hold: one line of printable ASCII, at most 200 letters, without the word
/// "end_header".
std::string header_text(const std::string& text);

}  // namespace palpate
