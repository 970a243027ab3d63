// SPDX-License-Identifier: MIT
// The installation of this module, and the plugin host. All runs of the process share these two objects.
#pragma once

#include "config/compose.hpp"
#include "experiment/experiment_options.hpp"
#include "record/build_info.hpp"
#include "record/run.hpp"

#include <palpate/error.hpp>

#include <dlfcn.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// Finds the installation to which this module belongs. Throws Error if the module's path is unknown.
inline Installation find_own_installation() {
  Dl_info self{};
  if (::dladdr(reinterpret_cast<const void*>(&find_own_installation), &self) == 0 || self.dli_fname == nullptr)
    throw Error("palpate", "the path of the module is unknown", {}, Error::Kind::run);
  return find_installation(std::filesystem::weakly_canonical(self.dli_fname));
}

struct ModuleEnvironment {
  Installation installation = find_own_installation();
  PluginHost host{PluginHost::search_path(installation.plugins)};
};

/// Returns the environment that all threads share. The environment is never destroyed, because Python destroys objects
/// in an unspecified order.
inline ModuleEnvironment& module_environment() {
  static ModuleEnvironment* const one = [] {
    auto* const made = new ModuleEnvironment;
    made->host.set_group_names(
        [made](const std::string& kind) { return Composer(made->installation.configs, config_keys()).names_of(kind); });
    return made;
  }();
  return *one;
}

/// Environment of one run, with a separate flag that interrupts this run.
struct InterruptibleEnvironment {
  std::atomic<bool> interrupted{false};
  RunEnvironment run_environment{
      module_environment().host, module_environment().installation, {"python"}, &interrupted};
};

inline std::vector<Override> parsed_overrides(const std::vector<std::string>& overrides) {
  std::vector<Override> parsed;
  for (const std::string& text : overrides) parsed.push_back(parse_override(text));
  return parsed;
}

/// Returns a new composer. A composer caches the files that it reads, and only one thread may use it. Each call of the
/// module therefore needs a new composer.
inline Composer composer() { return Composer(module_environment().installation.configs, config_keys()); }

inline ResolvedConfig resolve(const std::string& config, const std::vector<std::string>& overrides) {
  return resolve_experiment(composer().compose(config, parsed_overrides(overrides)), module_environment().host);
}

}  // namespace palpate
