// SPDX-License-Identifier: MIT
// Properties of config keys that the composition of configs needs: groups, inheritance between keys, and whether a
// strategy may set a key. All properties come from the field list of the config.
#pragma once

#include <palpate/options.hpp>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// The group `strategy`, which is not an option. Its file is a whole config: see Composer.
constexpr const char* kStrategy = "strategy";

class ConfigKeys {
 public:
  /// `list` visits all top-level keys. Throws std::logic_error for a key whose owner (strategy or run) is not set.
  explicit ConfigKeys(const std::function<void(Fields&)>& list);

  /// Returns whether a name at a dotted path chooses a file. This is true for the paths of groups. It is also true for
  /// a plugin within another plugin if the key of the inner plugin is the name of a plugin kind with group files.
  bool is_group(const std::string& path) const;
  /// Returns whether a name at `path` that has no file is the type of a plugin. `path`: the path of a group, or its
  /// last key.
  bool is_plugin(const std::string& path) const;
  /// Returns whether a top-level key chooses a plugin of a kind without group files. A name at this key is the type of
  /// the plugin, and the plugin's options are merged one by one.
  bool is_typed(const std::string& key) const { return typed_.count(key) > 0; }
  /// Returns the type that a key with is_typed() has if the config sets no type; "" for other keys.
  std::string default_type(const std::string& key) const;
  /// Returns whether a group lies within another group, as scene.effects does.
  bool is_part(const std::string& path) const;
  /// Returns the paths that the field list declares as groups.
  const std::vector<std::string>& groups() const { return groups_; }

  /// Returns whether a strategy may set the value at a dotted path. Unknown paths are accepted here and rejected later.
  bool is_of_strategy(const std::string& path) const;
  /// Returns whether a strategy's value of a top-level key is used only if the config does not set the key. This is
  /// true for the sibling key of a plugin (Field::with_beside()).
  bool is_brought(const std::string& key) const;
  /// Returns the sibling key of a plugin, which contains further options of this plugin: for example `motion` for
  /// `backend`; "" if there is none.
  std::string beside(const std::string& path) const;
  /// Returns whether the group at `choice` decides the value at a dotted path: the path is within the group or within
  /// its sibling key.
  bool is_decided(const std::string& path, const std::string& choice) const;

  /// Returns pairs of paths. The first path of a pair inherits from the second.
  const std::vector<std::pair<std::string, std::string>>& heirs() const { return heirs_; }
  /// Returns the paths that inherit the value at a dotted path. For kernel.nu, these are belief.height.kernel.nu and
  /// belief.label.kernel.nu.
  std::vector<std::string> heirs_of(const std::string& path) const;

 private:
  class Reader;

  std::vector<std::string> groups_;
  std::set<std::string> plugins_;             ///< names of plugin kinds with group files
  std::map<std::string, std::string> typed_;  ///< default type by key
  std::set<std::string> of_run_;
  std::map<std::string, std::string> beside_;  ///< sibling key of a plugin, by the key of the plugin
  std::vector<std::pair<std::string, std::string>> heirs_;
};

/// Returns whether a top-level key describes many runs. A resolved config has no such key.
bool describes_many_runs(const std::string& key);

/// Returns whether a dotted path is `top` or lies within it.
bool is_at_or_below(const std::string& path, const std::string& top);

/// Return the first and the last key of a dotted path.
std::string first_key(const std::string& path);
std::string last_key(const std::string& path);

}  // namespace palpate
