// SPDX-License-Identifier: MIT
// A config ready to run: options, the resolved tree, and the id that it has because of its content.
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
  Tree tree;                              ///< every field with its final value; reads back as the same config
  ResolveNotes notes;                     ///< where the values came from
  std::vector<Expectation> expectations;  ///< of `expect:`
  std::string identity;                   ///< 32 hex digits: a hash of all that decides what a run computes
  std::string id;                         ///< the first 12 of them
};

/// Returns the options of a config's belief, which is height_map.
HeightMapOptions height_map_options(const ExperimentOptions& options, const PluginSource& plugins);

/// Returns the text of which `identity` is the hash: a line `palpate-id 1`, then a line `path=value` for all that
/// decides what a run computes, sorted by bytes.
std::string identity_text(const ResolveNotes& notes);

/// Checks a composed tree (a `sweep:` in it is left aside) and opens the plugins that it names. Throws Error.
ResolvedConfig resolve_experiment(const Tree& composed, const PluginSource& plugins);

/// Hex digits of an id.
inline constexpr std::size_t kIdLength = 12;

/// Whether a folder is named by an id; something may follow it, as in 910071e8f4bb.old-1.
bool begins_with_id(const std::string& folder);

/// Returns the name of the folder of all runs that are called `name`: the letters, digits, '.', '_' and '-' of it, at
/// most 64, never empty or hidden. Of any other name it ends in '~' and six hex digits of its hash, so that other names
/// have other folders.
std::string slug(const std::string& name);

}  // namespace palpate
