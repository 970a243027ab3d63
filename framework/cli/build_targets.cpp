// SPDX-License-Identifier: MIT
#include "cli/build_targets.hpp"

#include "cli/output.hpp"
#include "config/catch_error.hpp"
#include "record/run_directory.hpp"

#include <fmt/format.h>

namespace palpate::cli {

void NeededParts::config(const std::string& file, const std::vector<std::string>& overrides, bool sweeps) {
  catch_error([&] {
    std::vector<Override> read;
    for (const std::string& text : overrides) read.push_back(parse_override(text));
    const Tree tree = program_.composer.compose(file, read);
    if (sweeps && (tree.find("sweep") != nullptr || tree.find("compare") != nullptr)) everything();
    resolve_experiment(tree, *this);
  });
}

void NeededParts::record(const std::string& directory) {
  if (is_sweep(directory)) return everything();
  catch_error([&] { resolve_experiment(read_run_config(directory), *this); });
}

void NeededParts::listing(const std::string& what) {
  for (const auto& [kind, name] : plugins_of_build(program_.installation.plugins)) {
    if (what.empty() || what == kind || what == fmt::format("{}/{}", kind, name)) plugins_.emplace(kind, name);
  }
}

void NeededParts::print() const {
  const auto known = plugins_of_build(program_.installation.plugins);
  if (known.empty()) return;
  if (whole_) print_out("palpate_whole\n");
  if (every_plugin_) print_out("palpate_plugins\n");
  for (const auto& [kind, name] : plugins_) {
    if (known.count({kind, name}) != 0) print_out("palpate_{}_{}\n", kind, name);
  }
}

bool NeededParts::is_silent(const std::string& kind, const std::string& name) const {
  plugins_.emplace(kind, name);
  return !program_.host.has(kind, name);
}

void NeededParts::describe(const std::string& kind, const std::string& name, Fields& fields) const {
  program_.host.describe(kind, name, fields);
}

}  // namespace palpate::cli
