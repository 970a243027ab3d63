// SPDX-License-Identifier: MIT
// Export of reconstructed surfaces and contacts as PLY files, for programs that show meshes. The files surface.csv and
// taps.csv of the run contain the same data as tables.
#pragma once

#include "experiment/experiment.hpp"
#include "record/run_replay.hpp"

#include <palpate/surface.hpp>

#include <optional>
#include <string>

namespace palpate {

/// Returns a mesh over a grid of candidates, with one vertex per candidate in their order. Each square of four
/// neighbours has two triangles; a grid with only one row or column has no triangles. `heights` and their standard
/// deviations `deviations` are in metres, one per candidate. Normals are computed from central differences of the
/// heights, and from one-sided differences at the edges. Along an axis with a single candidate, the slope counts as 0.
Surface surface_mesh(const CandidateGrid& candidates, const Eigen::VectorXd& heights,
                     const Eigen::VectorXd& deviations);

/// The reconstructed surface, with one value per candidate.
struct ReconstructedSurface {
  Surface mesh;
  Eigen::VectorXd object_probability;  ///< p of the footprint
  std::optional<Eigen::VectorXd> true_height;
};

/// Returns the surface after the taps so far. Builds the models that are needed.
ReconstructedSurface reconstruct(Experiment& experiment);

/// Returns the surface as a PLY 1.0 file in ASCII. x, y, z, nx, ny and nz have double precision. `quality` (the
/// standard deviation), `object_probability` and, if known, `true_height` have single precision, because MeshLab
/// requires it. The format ASCII keeps positions exact to the bit on every machine, and people can read the file. `run`
/// names the run and becomes a comment of the file, after conversion by header_text().
std::string surface_ply(const ReconstructedSurface& surface, const std::string& run);

/// Returns `mesh`, the closed surface of a run from any side, in the format of mesh_ply().
std::string surface_ply(const Surface& mesh, const std::string& run);

/// Returns a PLY file with the contacts as points x, y, z. Each point has `tap`, the number of the tap, and
/// `on_object`, 1 or 0. The label `on_object` is taken from `counts`, the result after all taps. Contacts from any side
/// also have nx, ny, nz, the direction from the contact towards the tool.
std::string taps_ply(const RecordedRun& recording, const RunResult& counts, const std::string& run);

/// Returns `text` in a form that a PLY header can contain: one line of printable ASCII with at most 200 characters and
/// without the word "end_header".
std::string header_text(const std::string& text);

}  // namespace palpate
