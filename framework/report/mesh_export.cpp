// SPDX-License-Identifier: MIT
#include "report/mesh_export.hpp"

#include "gp/candidate_grid.hpp"
#include "record/fields.hpp"
#include "record/mesh_ply.hpp"
#include "record/surface_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace palpate {
namespace {

/// Returns the negative slope of the heights along one axis, by central differences, or one-sided differences at the
/// edges. `at`: index along the axis, less than `count`. Neighbours along the axis are `step` indices apart in
/// `heights`.
double descent(const Eigen::VectorXd& heights, const Eigen::VectorXd& places, int index, int at, int count, int step) {
  const int before = std::max(at - 1, 0);
  const int behind = std::min(at + 1, count - 1);
  if (before == behind) return 0.0;
  return (heights(index + (before - at) * step) - heights(index + (behind - at) * step)) /
         (places(behind) - places(before));
}

}  // namespace

Surface surface_mesh(const CandidateGrid& candidates, const Eigen::VectorXd& heights,
                     const Eigen::VectorXd& deviations) {
  const int columns = candidates.columns;
  const int rows = candidates.rows;
  Surface mesh;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int i = row * columns + column;
      const Eigen::Vector3d upward(descent(heights, candidates.xs, i, column, columns, 1),
                                   descent(heights, candidates.ys, i, row, rows, columns), 1.0);
      mesh.vertices.push_back(
          {{candidates.points(i, 0), candidates.points(i, 1), heights(i)}, upward.normalized(), deviations(i)});
      if (row + 1 == rows || column + 1 == columns) continue;
      mesh.triangles.push_back({i, i + 1, i + columns + 1});
      mesh.triangles.push_back({i, i + columns + 1, i + columns});
    }
  }
  return mesh;
}

std::string header_text(const std::string& text) {
  constexpr std::size_t kLongest = 200;
  static const std::string end = "end_header";  // Some readers end the header at this word anywhere in a line.
  std::string out = text.substr(0, kLongest);
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
  }
  for (auto at = out.find(end); at != std::string::npos; at = out.find(end)) out[at + 3] = ' ';
  return out;
}

ReconstructedSurface reconstruct(Experiment& experiment) {
  experiment.look();
  Belief& belief = experiment.belief();
  ReconstructedSurface out{surface_mesh(grid_of(belief.candidates()), belief.surface(kFineResolution).heights,
                                        belief.values(quantity::kHeightStd)),
                           belief.values(quantity::kObjectProbability), std::nullopt};
  if (const Scene* const truth = experiment.truth()) out.true_height = true_heights(belief.candidates(), *truth);
  return out;
}

std::string surface_ply(const ReconstructedSurface& surface, const std::string& run) {
  const Surface& mesh = surface.mesh;
  std::string out = fmt::format(
      "ply\nformat ascii 1.0\ncomment palpate, {}\n"
      "comment lengths in metres; quality: standard deviation of the height\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n"
      "property double nx\nproperty double ny\nproperty double nz\n"
      "property float quality\nproperty float object_probability\n",
      header_text(run), mesh.vertices.size());
  if (surface.true_height) out += "property float true_height\n";
  if (!mesh.triangles.empty())  // Some readers reject an empty list of faces.
    out += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", mesh.triangles.size());
  out += "end_header\n";
  Eigen::Index i = 0;
  for (const Surface::Vertex& one : mesh.vertices) {
    out += fmt::format("{} {} {} {}", fmt::join(one.position, " "), fmt::join(one.normal, " "),
                       static_cast<float>(one.standard_deviation), static_cast<float>(surface.object_probability(i)));
    out += surface.true_height ? fmt::format(" {}\n", static_cast<float>((*surface.true_height)(i))) : "\n";
    ++i;
  }
  for (const auto& [a, b, c] : mesh.triangles) out += fmt::format("3 {} {} {}\n", a, b, c);
  return out;
}

std::string surface_ply(const Surface& mesh, const std::string& run) {
  return mesh_ply(mesh, "quality",
                  fmt::format("palpate, {}, metres, quality: standard deviation along the normal", header_text(run)));
}

std::string taps_ply(const RecordedRun& recording, const RunResult& counts, const std::string& run) {
  std::string points;
  int contacts = 0;
  const bool any_side = recording.is_any_side();
  for (std::size_t i = 0; i < recording.taps.size(); ++i) {
    const TapRecord& tap = recording.taps[i];
    if (!tap.is_contact()) continue;
    const bool hit = label_now(recording.rows[i], counts).value_or(false);
    Eigen::Vector3d at = *tap.result.contact;
    std::string from;
    if (any_side) {
      const TapLine& line = tap.request.line;
      at = line.at(tap.result.distance.value_or(0.0));
      from = fmt::format(" {} {} {}", -line.direction.x(), -line.direction.y(), -line.direction.z());
    }
    points += fmt::format("{} {} {}{} {} {}\n", at.x(), at.y(), at.z(), from, i + 1, hit ? 1 : 0);
    ++contacts;
  }
  return fmt::format(
      "ply\nformat ascii 1.0\ncomment palpate, {}\ncomment lengths in metres; contacts only\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n{}property int tap\nproperty uchar on_object\n"
      "end_header\n{}",
      header_text(run), contacts, any_side ? "property double nx\nproperty double ny\nproperty double nz\n" : "",
      points);
}

}  // namespace palpate
