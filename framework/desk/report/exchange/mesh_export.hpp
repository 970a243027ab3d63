// SPDX-License-Identifier: MIT
// Export of reconstructed surfaces and contacts as PLY, for programs that show meshes. The tables of a run are its
// surface.csv and taps.csv.
#pragma once

#include "experiment/experiment.hpp"
#include "record/run_replay.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A mesh over a grid of candidates: one vertex per candidate, in their order, and two triangles per four neighbours;
/// no triangles if the grid is one candidate wide.
struct SurfaceMesh {
  using Triples = Eigen::Matrix<double, Eigen::Dynamic, 3>;
  Triples points;   ///< x, y, z, metres; one row per vertex
  Triples normals;  ///< unit vectors, upward
  /// Indices of each triangle's vertices, counter-clockwise seen from above.
  std::vector<std::array<int, 3>> triangles;
};

/// Returns the mesh of `heights`, metres, one per candidate of a grid. Normals follow from central differences of the
/// heights, one-sided at the edges. A direction with a single candidate counts as level.
SurfaceMesh surface_mesh(const CandidateGrid& candidates, const VectorView& heights);

/// The reconstructed surface with its uncertainty; one value per candidate.
struct ReconstructedSurface {
  SurfaceMesh mesh;
  Eigen::VectorXd standard_deviation;  ///< of the height, metres
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
