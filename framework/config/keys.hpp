// SPDX-License-Identifier: MIT
// Properties of config keys that the composition of configs needs: groups, inheritance between keys, and keys of a
// strategy. All properties come from the field list of the config.
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

  /// Returns whether a name at a dotted path chooses a file. This holds for the paths of groups, and for a plugin
  /// within another one if its key is a plugin kind that is a group.
  bool is_group(const std::string& path) const;
  /// Returns whether a name without a file is the type of a plugin. `path`: the path of a group, or its last key.
  bool is_plugin(const std::string& path) const;
  /// Returns whether a top-level key chooses a plugin without group files. A name there is a type, and its options are
  /// merged one by one.
  bool is_typed(const std::string& key) const { return typed_.count(key) > 0; }
  /// Returns the type of a key for which is_typed() holds, in a config without a type there; "" for other keys.
  std::string default_type(const std::string& key) const;
  /// Returns whether a group lies within another group, as scene.effects does.
  bool is_part(const std::string& path) const;
  /// Returns the paths that the field list declares as groups.
  const std::vector<std::string>& groups() const { return groups_; }

  /// Returns whether a strategy may set the value at a dotted path. Unknown paths are accepted here and rejected later.
  bool is_of_strategy(const std::string& path) const;
  /// Returns whether a strategy's value of a top-level key is used only if the config does not set the key. This holds
  /// for keys next to a plugin (Field::with_beside()).
  bool is_brought(const std::string& key) const;
  /// Returns the key next to a plugin that contains further options of this plugin, for example `motion` for `backend`;
  /// "" if there is none.
  std::string beside(const std::string& path) const;
  /// Returns whether the group at `choice` decides the value at a dotted path, which lies within the group or within
  /// the key next to it.
  bool is_decided(const std::string& path, const std::string& choice) const;

  /// Returns pairs of paths. The first path of a pair inherits from the second.
  const std::vector<std::pair<std::string, std::string>>& heirs() const { return heirs_; }
  /// Returns the paths that inherit the value at a dotted path. For kernel.nu, these are belief.height.kernel.nu and
  /// belief.label.kernel.nu.
  std::vector<std::string> heirs_of(const std::string& path) const;

 private:
  class Reader;

  std::vector<std::string> groups_;
  std::set<std::string> plugins_;             ///< names of plugin kinds that are groups
  std::map<std::string, std::string> typed_;  ///< default type by key
  std::set<std::string> of_run_;
  std::map<std::string, std::string> beside_;  ///< key next to a plugin, by the key of the plugin
  std::vector<std::pair<std::string, std::string>> heirs_;
};

/// Returns whether a dotted path is `top` or lies within it.
bool is_at_or_below(const std::string& path, const std::string& top);

/// Return the first and the last key of a dotted path.
std::string first_key(const std::string& path);
std::string last_key(const std::string& path);

}  // namespace palpate
