// SPDX-License-Identifier: MIT
// From a composed tree to checked options and to the resolved config: every field with its final value, nothing else.
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

/// Where plugins' option lists come from. Implemented by the plugin host; a library is opened when it is asked for.
class PluginSource {
 public:
  virtual ~PluginSource() = default;
  /// Lists the options of a plugin to `fields`. Throws Error, without place, when there is no such plugin or when it
  /// cannot be loaded.
  virtual void describe(const std::string& kind, const std::string& name, Fields& fields) const = 0;
  /// Whether a plugin cannot tell its options, because it is not built yet: then any may stand in the config.
  virtual bool is_silent(const std::string&, const std::string&) const { return false; }
};

/// Plugins by kind and name.
using PluginNames = std::set<std::pair<std::string, std::string>>;

/// What resolving found out beside the values.
struct ResolveNotes {
  struct Origin {
    std::string path;   ///< dotted, for example "kernel.length_scale"
    std::string place;  ///< "file:line:column", "command line", or "default"
  };
  std::vector<Origin> origins;  ///< of every value, in the order of the resolved config
  std::vector<Origin> dropped;  ///< options left behind by a type that was chosen after them
  PluginNames plugins;          ///< every plugin that the config names
  /// Lines `path=value` of all that decides what a run computes, in the order of the fields: see identity_of().
  std::vector<std::string> identity;
  std::optional<Error> missing;  ///< the first needed option that is not there; resolve() throws it
};

/// Throws Error where `group`, the options of the plugin at the key `plugin`, holds the `option` that stands beside it:
/// see Field::with_beside(). "" for none.
void check_beside(const Tree& group, const std::string& plugin, const std::string& option);

/// Reads `input` into `options` and returns the resolved tree. Strict: throws Error with the place of the first
/// unknown key, wrong type, missing unit or value out of range, and only then of what is missing, which may stand under
/// an unknown key. `elsewhere` are keys beside those of `options` that
/// others read: the hint of an unknown one names them. In a map that is Tree::complete an option that is missing has
/// its neutral value (Field::neutral). Without one it is an error, unless the option enters no id.
Tree resolve(Options& options, const Tree& input, const PluginSource& plugins, ResolveNotes& notes,
             const std::vector<std::string>& elsewhere = {});

/// Lists the fields that `describe` knows into the values of a tree that was resolved before: how plugins are made.
void fill(const Tree& resolved, const PluginSource& plugins, const std::string& path,
          const std::function<void(Fields&)>& describe);

}  // namespace palpate
