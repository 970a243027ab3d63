// SPDX-License-Identifier: MIT
// Where this module lies, and what all runs of its process share.
#pragma once

#include "config/compose.hpp"
#include "experiment/experiment_options.hpp"
#include "record/build_info.hpp"
#include "record/session.hpp"

#include <palpate/error.hpp>

#include <dlfcn.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// What belongs together with this module.
inline Installation find_own_installation() {
  Dl_info self{};
  if (::dladdr(reinterpret_cast<const void*>(&find_own_installation), &self) == 0 || self.dli_fname == nullptr)
    throw Error("palpate", "the path of the module is unknown", {}, Error::Kind::run);
  return find_installation(std::filesystem::weakly_canonical(self.dli_fname));
}

/// What all runs of this process share, in all of its threads. Never destroyed: Python lets go of objects in an order
/// of its own.
struct Home {
  Installation installation = find_own_installation();
  PluginHost host{PluginHost::search_path(installation.plugins)};
};
inline Home& home() {
  static Home* const one = [] {
    auto* const made = new Home;
    made->host.set_group_names(
        [made](const std::string& kind) { return Composer(made->installation.configs, config_keys()).names_of(kind); });
    return made;
  }();
  return *one;
}

/// A wish to stop that a run may be given, and all that the run shares with others.
struct Shop {
  std::atomic<bool> interrupted{false};
  Workshop workshop{home().host, home().installation, {"python"}, &interrupted};
};

inline std::vector<Override> parsed_overrides(const std::vector<std::string>& overrides) {
  std::vector<Override> parsed;
  for (const std::string& text : overrides) parsed.push_back(parse_override(text));
  return parsed;
}

/// One for each call: it keeps the files that it has read, which may have changed by the next call, and is for one
/// thread.
inline Composer composer() { return Composer(home().installation.configs, config_keys()); }

inline ResolvedConfig resolve(const std::string& config, const std::vector<std::string>& overrides) {
  return resolve_experiment(composer().compose(config, parsed_overrides(overrides)), home().host);
}

}  // namespace palpate
