// SPDX-License-Identifier: MIT
// What a run found out, as programs that show meshes read it: PLY. Tables are the run's own surface.csv and taps.csv.
#pragma once

#include "experiment/from_above.hpp"
#include "record/recording.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A vertex a candidate, in the order of the candidates; two triangles for every four neighbours, none where the grid
/// is one candidate wide.
struct SurfaceMesh {
  using Triples = Eigen::Matrix<double, Eigen::Dynamic, 3>;
  Triples points;   ///< x, y, z, metres, a vertex a row
  Triples normals;  ///< of length 1, upward
  /// Vertices of a triangle, counter-clockwise seen from above: its normal looks upward, as those of its vertices do.
  std::vector<std::array<int, 3>> triangles;
};

/// `heights` in metres, one for each of `candidates`, which are a grid. Normals are those of central differences of the
/// heights, one-sided at the edges; a direction with a single candidate is level.
SurfaceMesh surface_mesh(const Candidates& candidates, const VectorView& heights);

/// The surface as reconstructed, with what is known of its error; values a candidate.
struct ReconstructedSurface {
  SurfaceMesh mesh;
  Eigen::VectorXd standard_deviation;  ///< of the height, metres
  Eigen::VectorXd object_probability;  ///< by the config's footprint
  std::optional<Eigen::VectorXd> true_height;
};

/// As of now; builds the models that it needs.
ReconstructedSurface reconstruct(FromAbove& experiment);

/// PLY 1.0 in ASCII: x, y, z, nx, ny, nz in double precision and, in single precision because MeshLab reads it in no
/// other, `quality`, the standard deviation; also `object_probability` and, where it is known, `true_height`.
/// ASCII, because positions then read back bit for bit in any program on any machine, people can look into the file,
/// and a grid of candidates is small. `run` names the run in a comment: what could break a header in it is replaced.
std::string surface_ply(const ReconstructedSurface& surface, const std::string& run);

/// The same of a run from any side: its finest closed mesh, as mesh_ply() has it.
std::string surface_ply(FromAnySide& experiment, const std::string& run);

/// The contacts as points: x, y, z, from any side nx, ny and nz, from where the tool came, `tap` (its number),
/// `on_object` (1 or 0), as `counts`, those after all taps, read it.
std::string taps_ply(const Recording& recording, const RunResult& counts, const std::string& run);

/// Text as a PLY header can hold it: one line of printable ASCII, at most 200 letters, without the word that ends it.
std::string header_text(const std::string& text);

}  // namespace palpate
