// SPDX-License-Identifier: MIT
// A config that is ready to run: options, the resolved tree, and an id computed from its content.
#pragma once

#include "belief/height_map_options.hpp"
#include "config/resolve.hpp"
#include "experiment/experiment_options.hpp"
#include "record/expectation.hpp"

#include <string>
#include <vector>

namespace palpate {

struct ResolvedConfig {
  ExperimentOptions options;
  Tree tree;           ///< all fields with their final values; resolving it again gives the same config
  ResolveNotes notes;  ///< origins of the values
  std::vector<Expectation> expectations;  ///< expectations in `expect:`
  std::string identity;                   ///< 32 hex digits: hash of all values that affect the results of a run
  std::string id;                         ///< the first 12 digits of `identity`
};

/// Returns the options of the belief `height_map` of a config.
HeightMapOptions height_map_options(const ExperimentOptions& options, const PluginSource& plugins);

/// Returns the text whose hash is `identity`. It has the line `palpate-id 1`, then one line `path=value` for each value
/// that affects the results, sorted by bytes.
std::string identity_text(const ResolveNotes& notes);

/// Checks a composed config, loads the plugins that it uses, and returns the resolved config. Ignores the blocks
/// `sweep:`, `tune:` and `compare:`. Throws Error.
ResolvedConfig resolve_experiment(const Tree& composed, const PluginSource& plugins);

/// Number of hex digits of an id.
inline constexpr std::size_t kIdLength = 12;

/// Returns whether the name of a folder begins with an id, as in 910071e8f4bb.old-1.
bool begins_with_id(const std::string& folder);

/// Returns the name of the folder for all runs called `name`: `name`, cut to 64 characters, with '-' in place of all
/// characters except letters, digits, '.', '_' and '-'. The result is never empty and never hidden. If the result
/// differs from `name`, '~' and six hex digits of a hash are appended, so that different names have different folders.
std::string slug(const std::string& name);

}  // namespace palpate
