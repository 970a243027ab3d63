// SPDX-License-Identifier: MIT
// Composes a config from groups, its own file and the command line. Each value of the resulting tree has its source
// location and its layer. Keys and values are checked later (config/resolve.hpp).
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
/// change the version; a new meaning of an existing one increments it. palpate reads all versions from 1 to this one.
inline constexpr std::int64_t kRecordVersion = 1;

/// Marks all groups of a config that has the key `complete`: a missing option then does not have its default
/// (Tree::complete). Throws Error for a version above kRecordVersion.
void mark_complete(Tree& config);

/// Reads each config file once, and composes the files.
///
/// The field list of the config defines which keys are groups (Field::group()). A name at such a key, in the file or as
/// an override, chooses the file of that name: see GroupFiles. A name without a file is the type of a plugin, which
/// then has its default options. A group within another (scene.effects) replaces the content of the outer group at its
/// path.
///
/// The group `strategy` is not an option. Its file is a whole config, in strategy/ or in the folder of the config
/// itself. So each whole config is also a strategy. It may set all keys of the strategy, which decide the choice of
/// taps and the models. A strategy in the config ranks below the groups of the config. A strategy as an override
/// replaces each top-level key that it has. Of a belief of the same type it replaces only the options that it has.
///
/// The file of a strategy may contain keys of the run (Field::of_run()), but they are ignored. The only exception is a
/// motion given as a map (`motion: {...}`), not as a name. This motion is used only if neither a group nor the config
/// sets any part of the motion. So a strategy cannot make an arm faster than the config allows.
class Composer {
 public:
  /// `shipped`: the configs of the program. `keys` must outlive the object.
  Composer(std::filesystem::path shipped, const ConfigKeys& keys) : group_files_(std::move(shipped)), keys_(keys) {}

  /// Merges the strategy, then the groups in the order of `defaults`, then the file, then `overrides` in their order.
  ///
  /// A group in an override replaces the group chosen before at that path. Options that the config's own file sets in
  /// this group remain if the new type has them (see resolve()). A map as an override of a group is merged into the
  /// group; any other value replaces the old one. Throws Error for missing files, unknown groups, cycles, and chains of
  /// more than 16 groups that build on each other.
  Tree compose(const std::filesystem::path& file, const std::vector<Override>& overrides);

  /// See GroupFiles::config().
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
  /// Returns the sorted names that the last composed config may choose for a group.
  std::vector<std::string> names_of(const std::string& group) const;

 private:
  /// The path of a group, and the name chosen for this group. The type of the group gets the layer of the name.
  using Choice = Override;

  const Tree& load(const std::filesystem::path& file);

  // The functions take_... remove the choices from a tree and return them.
  std::vector<Choice> take_choices(Tree& own, const std::vector<Override>& overrides) const;
  std::vector<Choice> take_defaults(Tree& own) const;
  void take_names(Tree& tree, const std::string& path, std::vector<Choice>& choices) const;

  void note_group(const Choice& choice, const std::filesystem::path& beside);
  /// Returns the content of a chosen group, with its own file on `layer` and its bases below.
  Tree take_group(const Choice& choice, const std::filesystem::path& beside, Layer layer);
  /// Merges groups into `tree`, each on its own layers from `layer` on, and sets `layer` to the next free layer.
  void lay_groups(Tree& tree, const std::vector<Choice>& choices, const std::filesystem::path& beside, Layer& layer);
  /// Removes the strategy from `choices`, if there is one, and merges it into `tree`. Returns the layer of its name.
  Layer lay_strategy(Tree& tree, std::vector<Choice>& choices, const std::filesystem::path& beside, Layer& layer,
                     std::vector<std::string>& chain);
  /// Returns whether a strategy as an override replaces the value at `path` of the config's file, `own`.
  bool is_replaced(const std::string& path, const Tree& own, const Tree& strategy) const;
  void lay_override(Tree& tree, const Override& one);
  /// Merges a plugin within another plugin, for example an item of a list, into the otherwise complete tree.
  void choose_inner(Tree& tree, const Choice& choice, const std::filesystem::path& beside);

  /// Returns the content of a group: its file on layer 0, its bases on the layers below. `chain`: the groups whose
  /// files are being read.
  Tree group_content(const std::string& group, const std::string& name, const SourceLocation& place,
                     const std::filesystem::path& beside, std::vector<std::string>& chain);
  /// Returns the content of a group on which another group builds.
  Tree base_content(const std::string& group, const Tree& name, const std::filesystem::path& beside,
                    std::vector<std::string>& chain);
  void lay_bases(Tree& content, const std::string& group, const std::vector<Choice>& bases,
                 const std::filesystem::path& beside, std::vector<std::string>& chain);
  /// Merges the file of a group into its content. Throws Error for keys other than the group and the key next to it.
  void lay_group_file(Tree& content, const std::string& group, const Tree& own) const;

  /// Returns whether a path leads into a group, to a plugin within another one: kernel.kernels.0.kernel.
  bool is_inner(const std::string& path) const;

  GroupFiles group_files_;
  const ConfigKeys& keys_;
  std::map<std::filesystem::path, Tree> loaded_;  ///< read files, by absolute path
  /// Contents of groups that are bases of others, by group, name and folder.
  std::map<std::array<std::string, 3>, Tree> bases_;
  std::map<std::string, Tree>
      brought_;  ///< options of the strategy that are used if the config does not set them, by key
  std::vector<Group> groups_;
  std::filesystem::path beside_;  ///< folder of the last composed config
};

}  // namespace palpate
