// SPDX-License-Identifier: MIT
// Files that a scene or a backend is made of, and arrays of programs.
#include "fuzz/ground.hpp"
#include "fuzz/harness.hpp"

#include "acquisitions/program/maps.hpp"
#include "shapes/height_map/grid.hpp"

#include "config/compose.hpp"
#include "experiment/experiment.hpp"
#include "reading/npy.hpp"
#include "record/resolved_config.hpp"

#include <palpate/error.hpp>

#include <array>
#include <stdexcept>

namespace palpate::fuzz {
namespace {

namespace fs = std::filesystem;

ResolvedConfig with(const std::vector<std::string>& words) {
  Composer composer(shipped_configs(), config_keys());
  std::vector<Override> overrides{parse_override("candidates.count=5"), parse_override("taps=4")};
  for (const std::string& one : words) overrides.push_back(parse_override(one));
  return resolve_experiment(composer.compose(shipped_configs() / "paper" / "object_i.yaml", overrides), host());
}

}  // namespace

void table(const std::string& bytes) {
  static const ResolvedConfig config =
      with({"backend=replay", "backend.record=" + (ground().path() / "table.csv").string()});
  ground().write("table.csv", bytes);
  try {
    Experiment(config.options, {host()});
  } catch (const Error&) {
  }
}

void mesh(const std::string& bytes) {
  static const std::array<const char*, 3> endings{"stl", "obj", "ply"};
  if (bytes.empty()) return;
  const char* const ending = endings[static_cast<unsigned char>(bytes.front()) % endings.size()];
  const fs::path file = ground().write(std::string("mesh.") + ending, bytes.substr(1));
  try {
    const ResolvedConfig config =
        with({"scene.objects=[{type: mesh, file: '" + file.string() + "', unit: 1 mm, at: [11.5 cm, 11.5 cm]}]"});
    Experiment(config.options, {host()});
  } catch (const Error&) {
  }
}

void heights(const std::string& bytes) {
  static const std::array<const char*, 3> files{"map.csv", "map.npy", "map.png"};
  if (bytes.empty()) return;
  shapes::Grid grid;
  try {
    grid = shapes::read_grid(bytes.substr(1), files[static_cast<unsigned char>(bytes.front()) % files.size()]);
  } catch (const Error&) {
    return;
  }
  const bool is_sound = grid.rows() >= 2 && grid.cols() >= 2 && grid.size() <= shapes::kMostNodes && grid.allFinite();
  if (!is_sound || grid.minCoeff() < 0.0 || grid.maxCoeff() <= 0.0)
    throw std::logic_error("a grid was accepted that is none of heights");
}

void scores(const std::string& bytes) {
  constexpr Eigen::Index kCount = 6;
  if (bytes.size() < kNpyStart) return;  // no more is asked for than came
  std::string header;
  try {
    header = bytes.substr(kNpyStart, program::header_length(bytes.substr(0, kNpyStart)));
    program::check_header(header, kCount);
  } catch (const std::runtime_error&) {
    return;
  }
  if (header.find("<f8") == std::string::npos || header.find('6') == std::string::npos)
    throw std::logic_error("a header was accepted that does not say what follows");
}

}  // namespace palpate::fuzz
