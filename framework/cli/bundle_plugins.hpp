// SPDX-License-Identifier: MIT
// The plugins with which the runs of a bundle are repeated.
#pragma once

#include "bundle/bundle.hpp"
#include "cli/command_context.hpp"
#include "host/plugin_host.hpp"
#include "record/files.hpp"

#include <optional>

namespace palpate::cli {

/// The plugins that palpate contains, and those of the bundle if the user allows it. PALPATE_PLUGIN_PATH does not
/// count, so that a bundle gives the same results for all users.
class BundlePlugins {
 public:
  /// `builds`: whether to build the plugins in `sources/` of the bundle. On a terminal, asks the user first. Throws
  /// Error if the user says no, and if a plugin cannot be built.
  BundlePlugins(const CommandEnvironment& program, const UnpackedBundle& bundle, bool builds);

  /// Returns the environment of the program with these plugins.
  const CommandEnvironment& program() const { return *program_; }

 private:
  ScratchFolder builds_;
  std::optional<PluginHost> host_;
  std::optional<CommandEnvironment> program_;
};

}  // namespace palpate::cli
