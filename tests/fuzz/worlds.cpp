// SPDX-License-Identifier: MIT
// Files that a scene or a backend is made of.
#include "fuzz/ground.hpp"
#include "fuzz/harness.hpp"

#include "config/compose.hpp"
#include "experiment/from_above.hpp"
#include "record/resolved.hpp"

#include <palpate/error.hpp>

#include <array>

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
    FromAbove(config.options, host(), nullptr);
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
    FromAbove(config.options, host(), nullptr);
  } catch (const Error&) {
  }
}

}  // namespace palpate::fuzz
