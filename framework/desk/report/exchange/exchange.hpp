// SPDX-License-Identifier: MIT
// What a run found out, as programs that show meshes read it: PLY. Tables are the run's own surface.csv and taps.csv.
#pragma once

#include "experiment/experiment.hpp"
#include "record/recording.hpp"
#include "report/exchange/surface_mesh.hpp"

#include <optional>
#include <string>

namespace palpate {

/// The surface as reconstructed, with what is known of its error; values a candidate.
struct ReconstructedSurface {
  SurfaceMesh mesh;
  Eigen::VectorXd standard_deviation;      ///< of the height, metres
  Eigen::VectorXd on_surface_probability;  ///< by the config's footprint
  std::optional<Eigen::VectorXd> true_height;
};

/// As of now; builds the models that it needs.
ReconstructedSurface reconstruct(Experiment& experiment);

/// PLY 1.0 in ASCII: x, y, z, nx, ny, nz in double precision and, in single precision because MeshLab reads it in no
/// other, `quality`, the standard deviation; also `on_surface_probability` and, where it is known, `true_height`.
/// ASCII, because positions then read back bit for bit in any program on any machine, people can look into the file,
/// and a grid of candidates is small. `run` names the run in a comment: what could break a header in it is replaced.
std::string surface_ply(const ReconstructedSurface& surface, const std::string& run);

/// The contacts as points: x, y, z, `tap` (its number), `on_surface` (1 or 0).
std::string taps_ply(const Recording& recording, const std::string& run);

/// Text as a PLY header can hold it: one line of printable ASCII, at most 200 letters, without the word that ends it.
std::string header_text(const std::string& text);

}  // namespace palpate
