// SPDX-License-Identifier: MIT
// The parts of the build that a command line needs besides `palpate` itself. The script ./palpate calls the program
// with --needs before the other arguments, and then builds the parts that it prints.
#pragma once

#include "cli/command_context.hpp"

#include <string>
#include <vector>

namespace palpate::cli {

/// Collects the parts that a command needs. As a PluginSource, this object records each plugin whose options are read.
/// The functions do not throw, because the command itself reports an invalid config. If the options of a plugin name
/// another plugin, the other plugin becomes known only after the first is built.
class NeededParts final : public PluginSource {
 public:
  explicit NeededParts(CommandEnvironment& program) : program_(program) {}

  /// Adds palpate-whole.
  void whole() { whole_ = true; }
  /// Adds all plugins of this build.
  void every_plugin() { every_plugin_ = true; }
  /// Adds palpate-whole and all plugins. A sweep needs all plugins, because the plugins of its jobs are known only
  /// after it is planned.
  void everything() { whole_ = every_plugin_ = true; }
  /// Adds the plugins of a config, including those that the config chooses by default. If `sweeps` is set, a config
  /// with a 'sweep:' block needs everything.
  void config(const std::string& file, const std::vector<std::string>& overrides, bool sweeps);
  /// Adds the plugins of a run. A sweep needs everything.
  void record(const std::string& directory);
  void whole_and_record(const std::string& directory) {
    whole();
    record(directory);
  }
  /// Adds the plugins that `palpate plugins` lists for the argument "", KIND or KIND/NAME.
  void listing(const std::string& what);

  /// Prints the build targets of the needed parts, one per line. Prints nothing in an installed program, which has all
  /// parts.
  void print() const;

  /// Returns whether a plugin is not built. The options of such a plugin are unknown.
  bool is_silent(const std::string& kind, const std::string& name) const override;
  void describe(const std::string& kind, const std::string& name, Fields& fields) const override;

 private:
  CommandEnvironment& program_;
  bool whole_ = false;
  bool every_plugin_ = false;
  mutable PluginNames plugins_;
};

}  // namespace palpate::cli
