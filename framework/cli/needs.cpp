// SPDX-License-Identifier: MIT
#include "cli/needs.hpp"

#include "config/trouble.hpp"
#include "record/run_directory.hpp"

#include <fmt/format.h>

namespace palpate::cli {
namespace {

/// Hears which plugins a config names. What is not built is silent about its options.
class Listener final : public PluginSource {
 public:
  Listener(const PluginHost& host, Needs& needs) : host_(host), needs_(needs) {}
  bool is_silent(const std::string& kind, const std::string& name) const override {
    needs_.plugins.emplace(kind, name);
    return !host_.has(kind, name);
  }
  void describe(const std::string& kind, const std::string& name, Fields& fields) const override {
    host_.describe(kind, name, fields);
  }

 private:
  const PluginHost& host_;
  Needs& needs_;
};

/// What is wrong with the config ends the hearing, and the command itself says it.
void hear(const Program& program, const Tree& config, Needs& needs) {
  resolve_experiment(config, Listener(program.host, needs));
}

}  // namespace

void need_everything(Program&, Needs& needs) { needs.whole = needs.every_plugin = true; }

void need_config(Program& program, const std::string& config, const std::vector<std::string>& overrides, bool sweeps,
                 Needs& needs) {
  trouble_in([&] {
    std::vector<Override> read;
    for (const std::string& text : overrides) read.push_back(parse_override(text));
    const Tree tree = program.composer.compose(config, read);
    if (sweeps && tree.find("sweep") != nullptr) need_everything(program, needs);
    hear(program, tree, needs);
  });
}

void need_record(Program& program, const std::string& directory, Needs& needs) {
  if (is_sweep(directory)) return need_everything(program, needs);
  trouble_in([&] { hear(program, read_run_config(directory), needs); });
}

void need_whole(Program& program, const std::string& directory, Needs& needs) {
  needs.whole = true;
  need_record(program, directory, needs);
}

void need_listing(Program& program, const std::string& what, Needs& needs) {
  for (const auto& [kind, name] : plugins_of_build(program.installation.plugins)) {
    if (what.empty() || what == kind || what == kind + "/" + name) needs.plugins.emplace(kind, name);
  }
}

void print_needs(const Program& program, const Needs& needs) {
  const auto known = plugins_of_build(program.installation.plugins);
  if (known.empty()) return;
  if (needs.whole) fmt::print("palpate_whole\n");
  if (needs.every_plugin) fmt::print("palpate_plugins\n");
  for (const auto& [kind, name] : needs.plugins) {
    if (known.count({kind, name}) != 0) fmt::print("palpate_{}_{}\n", kind, name);
  }
}

}  // namespace palpate::cli
