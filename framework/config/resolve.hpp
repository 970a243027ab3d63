// SPDX-License-Identifier: MIT
// Converts a composed config to checked options and to the resolved config, which contains exactly the final values of
// all fields.
#pragma once

#include "config/tree.hpp"

#include <palpate/error.hpp>
#include <palpate/options.hpp>

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// Source of the option lists of plugins. The plugin host implements it and loads a library when its options are
/// needed.
class PluginSource {
 public:
  virtual ~PluginSource() = default;
  /// Passes the options of a plugin to `fields`. Throws Error, without a source location, if the plugin does not exist
  /// or cannot be loaded.
  virtual void describe(const std::string& kind, const std::string& name, Fields& fields) const = 0;
  /// Returns whether the options of a plugin are unknown, because the plugin is not built yet. resolve() then accepts
  /// any options.
  virtual bool is_silent(const std::string&, const std::string&) const { return false; }
};

/// Pairs of kind and name.
using PluginNames = std::set<std::pair<std::string, std::string>>;

/// Further results of resolve().
struct ResolveNotes {
  struct Origin {
    std::string path;   ///< dotted, for example "kernel.length_scale"
    std::string place;  ///< "file:line:column", "command line", or "default"
  };
  std::vector<Origin> origins;  ///< origin of each value, in the order of the resolved config
  std::vector<Origin> dropped;  ///< options that were set for a type that was replaced, and that the final type lacks
  std::vector<std::string> files;  ///< dotted paths of the values that name files (Field::names_file())
  PluginNames plugins;             ///< kind and name of all plugins of the config
  /// One line `path=value` for each value that affects the results of a run, in the order of the fields: see
  /// identity_text().
  std::vector<std::string> identity;
  std::optional<Error> missing;  ///< first missing option; resolve() throws it
};

/// Throws Error if `group`, the options of the plugin at the key `plugin`, contains the key `option`, which must be a
/// sibling key of `plugin` (Field::with_beside()). `option` may be "".
void check_beside(const Tree& group, const std::string& plugin, const std::string& option);

/// Reads `input` into `options` and returns the resolved config. Throws Error, with the source location, for the first
/// unknown key, wrong type, missing unit or value out of range. A missing option is reported last, because an unknown
/// key may be the misspelt name of this option.
///
/// `elsewhere` lists top-level keys that other code reads; hints may suggest these keys, too. In a map with
/// Tree::complete, a missing option has its neutral value (Field::neutral()). If a missing option has no neutral value,
/// it is an error, except for options that are not part of the id.
Tree resolve(Options& options, const Tree& input, const PluginSource& plugins, ResolveNotes& notes,
             const std::vector<std::string>& elsewhere = {});

/// Fills the fields that `describe` lists with the values of a resolved tree. `path`: path of this tree in the config,
/// for messages. The plugin host creates plugins in this way.
void fill(const Tree& resolved, const PluginSource& plugins, const std::string& path,
          const std::function<void(Fields&)>& describe);

}  // namespace palpate
