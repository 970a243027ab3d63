// SPDX-License-Identifier: MIT
#include "report/exchange/exchange.hpp"

#include "experiment/metrics.hpp"

#include <fmt/format.h>

#include <iterator>

namespace palpate {
namespace {

using Buffer = fmt::memory_buffer;

template <class... Values>
void put(Buffer& out, const char* format, const Values&... values) {
  fmt::format_to(std::back_inserter(out), fmt::runtime(format), values...);
}

void begin_header(Buffer& out, const std::string& run, const char* units) {
  put(out, "ply\nformat ascii 1.0\ncomment palpate, {}\ncomment {}\n", header_text(run), units);
}

void declare(Buffer& out, const char* type, std::initializer_list<const char*> names) {
  for (const char* name : names) put(out, "property {} {}\n", type, name);
}

}  // namespace

std::string header_text(const std::string& text) {
  constexpr std::size_t kLongest = 200;
  static const std::string end = "end_header";  // some readers look for it anywhere in a line
  std::string out = text.substr(0, kLongest);
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
  }
  for (auto at = out.find(end); at != std::string::npos; at = out.find(end)) out[at + 3] = ' ';
  return out;
}

ReconstructedSurface reconstruct(Experiment& experiment) {
  experiment.ask(Quantity::height | Quantity::probability);
  const TapBelief& belief = experiment.belief();
  ReconstructedSurface out{surface_mesh(experiment.candidates(), reconstruction(belief)),
                           belief.height_variance().cwiseSqrt(), belief.probability(), std::nullopt};
  if (const Truth* truth = experiment.truth()) out.true_height = truth->height;
  return out;
}

std::string surface_ply(const ReconstructedSurface& surface, const std::string& run) {
  const SurfaceMesh& mesh = surface.mesh;
  Buffer out;
  begin_header(out, run, "lengths in metres; quality: standard deviation of the height");
  put(out, "element vertex {}\n", mesh.points.rows());
  declare(out, "double", {"x", "y", "z", "nx", "ny", "nz"});
  declare(out, "float", {"quality", "on_surface_probability"});
  if (surface.true_height) declare(out, "float", {"true_height"});
  if (!mesh.triangles.empty()) {  // a list of none is more than some readers expect
    put(out, "element face {}\n", mesh.triangles.size());
    put(out, "property list uchar int vertex_indices\n");
  }
  put(out, "end_header\n");
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    put(out, "{} {} {} {} {} {} {} {}", mesh.points(i, 0), mesh.points(i, 1), mesh.points(i, 2), mesh.normals(i, 0),
        mesh.normals(i, 1), mesh.normals(i, 2), static_cast<float>(surface.standard_deviation(i)),
        static_cast<float>(surface.on_surface_probability(i)));
    if (surface.true_height) put(out, " {}", static_cast<float>((*surface.true_height)(i)));
    put(out, "\n");
  }
  for (const auto& [a, b, c] : mesh.triangles) put(out, "3 {} {} {}\n", a, b, c);
  return to_string(out);
}

std::string taps_ply(const Recording& recording, const std::string& run) {
  Buffer points;
  int contacts = 0;
  for (std::size_t i = 0; i < recording.taps.size(); ++i) {
    const PastTap& tap = recording.taps[i];
    if (tap.contact.outcome != Outcome::contact) continue;
    const bool hit = recording.rows[i].flag("on_surface").value_or(false);
    put(points, "{} {} {} {} {}\n", tap.target.x, tap.target.y, tap.contact.height, i + 1, hit ? 1 : 0);
    ++contacts;
  }
  Buffer out;
  begin_header(out, run, "lengths in metres; contacts only");
  put(out, "element vertex {}\n", contacts);
  declare(out, "double", {"x", "y", "z"});
  declare(out, "int", {"tap"});
  declare(out, "uchar", {"on_surface"});
  put(out, "end_header\n");
  return to_string(out) + to_string(points);
}

}  // namespace palpate
