// SPDX-License-Identifier: MIT
// What the field list of a config says of its keys for those who compose configs: which are groups, which take over
// what they do not say, and which a strategy sets.
#pragma once

#include <palpate/options.hpp>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// The group that is no option: its file is a config like any other. See Composer.
constexpr const char* kStrategy = "strategy";

class ConfigKeys {
 public:
  /// `list` visits all top-level keys. Throws std::logic_error for one that does not say whether a strategy sets it.
  explicit ConfigKeys(const std::function<void(Fields&)>& list);

  /// Whether a name at a dotted path chooses a file: at the path of a group, and wherever a plugin of a kind that is a
  /// group stands under the kind's name, as in another plugin.
  bool is_group(const std::string& path) const;
  /// Whether a name without such a file is the type of a plugin; `path` is that of a group, or its last key.
  bool is_plugin(const std::string& path) const;
  /// Whether a group lies within another, as scene.effects does.
  bool is_part(const std::string& path) const;
  /// The paths that the list calls groups.
  const std::vector<std::string>& groups() const { return groups_; }

  /// Whether the value at a dotted path may come from a strategy. What no list knows may: it is refused later.
  bool is_of_strategy(const std::string& path) const;
  /// Whether a strategy brings a top-level key along only for runs that do not say it: Field::with_beside().
  bool is_brought(const std::string& key) const;
  /// The key beside the plugin at a top-level path that has its options, "" for none: `motion` of `backend`.
  std::string beside(const std::string& path) const;
  /// Whether what is chosen at `choice`, a group, decides the value at a dotted path: within the group, or beside it.
  bool is_decided(const std::string& path, const std::string& choice) const;

  /// Pairs of paths: what the first does not say, the second says.
  const std::vector<std::pair<std::string, std::string>>& heirs() const { return heirs_; }
  /// Where else the value at a dotted path is taken over: that of kernel.nu at height.kernel.nu and label.kernel.nu.
  std::vector<std::string> heirs_of(const std::string& path) const;

 private:
  class Reader;

  std::vector<std::string> groups_;
  std::set<std::string> plugins_;  ///< groups that are plugins: their names
  std::set<std::string> of_run_;
  std::map<std::string, std::string> beside_;  ///< by the plugin's key
  std::vector<std::pair<std::string, std::string>> heirs_;
};

/// Whether a dotted path is `top` or leads to something within it.
bool is_at_or_below(const std::string& path, const std::string& top);

/// The first and the last key of a dotted path.
std::string first_key(const std::string& path);
std::string last_key(const std::string& path);

}  // namespace palpate
