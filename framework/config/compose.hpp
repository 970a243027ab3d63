// SPDX-License-Identifier: MIT
// Composes a config from groups, its own file and the command line. Each value of the resulting tree has its source
// location and its layer (its priority; see Layer). Keys and values are checked later (config/resolve.hpp).
#pragma once

#include "config/group_files.hpp"
#include "config/keys.hpp"
#include "config/override.hpp"
#include "config/tree.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpate {

/// Version of the format of records, stored as `complete` in their config.yaml. New keys, fields and files do not
/// change the version. A new meaning of an existing key, field or file increments it. palpate reads all versions from 1
/// to kRecordVersion.
inline constexpr std::int64_t kRecordVersion = 1;

/// If a config has the key `complete`, sets Tree::complete in all maps of the config. In these maps, a missing option
/// does not have its default value (see resolve()). Throws Error for a version above kRecordVersion.
void mark_complete(Tree& config);

/// Composes configs. Each file is read only once.
///
/// The field list of the config defines which keys are groups (Field::group()). If the value of a group key is a name,
/// in the file or in an override, the name chooses a file: see GroupFiles. A name without a file is the type of a
/// plugin, which then has its default options. A group within another group, such as scene.effects in scene, replaces
/// the outer group's content at the path of the inner group.
///
/// The group `strategy` is not an option. Its file is a whole config, in strategy/ or in the folder of the config
/// itself. Each whole config can therefore be used as a strategy. A strategy may set all keys that decide the choice of
/// taps and the models (Field::of_strategy()). If the config names a strategy, the groups of the config take precedence
/// over the strategy. If an override names a strategy, the strategy replaces each top-level key that it sets. The
/// belief is an exception: if strategy and config have the same belief type, only the belief options that the strategy
/// sets are replaced.
///
/// The file of a strategy may contain keys of the run (Field::of_run()), but they are ignored. The only exception is a
/// motion that is given as a map (`motion: {...}`), not as a name. This motion is used only if neither another group
/// nor the config sets any part of the motion. A strategy therefore cannot make an arm faster than the config allows.
class Composer {
 public:
  /// `shipped`: folder of the program's own configs. `keys` must outlive the object.
  Composer(std::filesystem::path shipped, const ConfigKeys& keys) : group_files_(std::move(shipped)), keys_(keys) {}

  /// Merges the strategy, then the groups in the order of `defaults`, then the file, then `overrides` in their order.
  ///
  /// A group name in an override replaces the group that was chosen at the same path. Options that the config's own
  /// file sets in this group remain if the new type has them (see resolve()). If the override of a group is a map, the
  /// map is merged into the group. Any other value replaces the old value. Throws Error for missing files, unknown
  /// groups, cycles, and chains of more than 16 groups that build on each other.
  Tree compose(const std::filesystem::path& file, const std::vector<Override>& overrides);

  /// Returns the path of a config file: see GroupFiles::config().
  std::filesystem::path found(const std::filesystem::path& file) const { return group_files_.config(file); }

  /// A group that was read from a file.
  struct Group {
    std::string path;  ///< path in the config, for example belief.height.kernel
    std::string name;
    std::filesystem::path file;
  };
  /// Returns the groups of the last composition, from the lowest layer to the highest.
  const std::vector<Group>& groups() const { return groups_; }

  const GroupFiles& group_files() const { return group_files_; }
  /// Returns the sorted names of all group files that the last composed config could choose for `group`.
  std::vector<std::string> names_of(const std::string& group) const;

 private:
  /// A chosen group: `path` is the path of the group, `value` the name of the chosen file or plugin. The group's key
  /// `type` gets the layer of this name.
  using Choice = Override;

  const Tree& load(const std::filesystem::path& file);

  // The functions take_... remove the choices of groups from a tree and return them.
  std::vector<Choice> take_choices(Tree& own, const std::vector<Override>& overrides) const;
  std::vector<Choice> take_defaults(Tree& own) const;
  void take_names(Tree& tree, const std::string& path, std::vector<Choice>& choices) const;

  void note_group(const Choice& choice, const std::filesystem::path& beside);
  /// Returns the content of a chosen group. The values of its own file are on `layer`, the values of its bases on lower
  /// layers.
  Tree take_group(const Choice& choice, const std::filesystem::path& beside, Layer layer);
  /// Merges groups into `tree`. Each group gets its own layers, beginning with `layer`. Sets `layer` to the next free
  /// layer.
  void lay_groups(Tree& tree, const std::vector<Choice>& choices, const std::filesystem::path& beside, Layer& layer);
  /// Removes the strategy from `choices`, if there is one, and merges it into `tree`. Returns the layer of the value
  /// that names the strategy.
  Layer lay_strategy(Tree& tree, std::vector<Choice>& choices, const std::filesystem::path& beside, Layer& layer,
                     std::vector<std::string>& chain);
  /// Returns whether `strategy`, which an override names, replaces the value at `path` of `own`, the config's own file.
  bool is_replaced(const std::string& path, const Tree& own, const Tree& strategy) const;
  void lay_override(Tree& tree, const Override& one);
  /// Merges the group file of an inner plugin into the tree. An inner plugin is part of another plugin, for example an
  /// item of its list. All other parts of the tree must be merged before.
  void choose_inner(Tree& tree, const Choice& choice, const std::filesystem::path& beside);

  /// Returns the content of a group: the values of its file on layer 0, the values of its bases on lower layers.
  /// `chain`: the groups whose files are being read.
  Tree group_content(const std::string& group, const std::string& name, const SourceLocation& place,
                     const std::filesystem::path& beside, std::vector<std::string>& chain);
  /// Returns the content of a base: a group on which another group builds.
  Tree base_content(const std::string& group, const Tree& name, const std::filesystem::path& beside,
                    std::vector<std::string>& chain);
  void lay_bases(Tree& content, const std::string& group, const std::vector<Choice>& bases,
                 const std::filesystem::path& beside, std::vector<std::string>& chain);
  /// Merges the file of a group into its content. The file may have two keys: the group and its sibling key
  /// (ConfigKeys::beside(); for `backend` this is `motion`). Throws Error for other keys.
  void lay_group_file(Tree& content, const std::string& group, const Tree& own) const;

  /// Returns whether a path leads into a group, to a plugin within another plugin. Example: kernel.kernels.0.kernel.
  bool is_inner(const std::string& path) const;

  GroupFiles group_files_;
  const ConfigKeys& keys_;
  std::map<std::filesystem::path, Tree> loaded_;  ///< trees of all files that were read, by absolute path
  /// Contents of groups that are bases of other groups, by group, name and folder.
  std::map<std::array<std::string, 3>, Tree> bases_;
  std::map<std::string, Tree>
      brought_;  ///< options of the strategy that are used if the config does not set them, by key
  std::vector<Group> groups_;
  std::filesystem::path beside_;  ///< folder of the last composed config
};

}  // namespace palpate
