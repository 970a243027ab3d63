// SPDX-License-Identifier: MIT
// A config is composed from groups, its own file and the command line. The result is a tree in which every value knows
// its place and its layer; nothing is checked yet but the grammar.
#pragma once

#include "config/keys.hpp"
#include "config/override.hpp"
#include "config/tree.hpp"

#include <palpate/error.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpate {

/// The version of records: `complete` of their config.yaml. What only adds keys, fields or files leaves it as it is;
/// whatever gives another meaning to what was there raises it. All versions from 1 on are read, later ones refused.
inline constexpr std::int64_t kRecordVersion = 1;

/// Takes note of `complete` in a config that was read: what it lacks is then not at its default (Tree::complete).
/// Throws Error for one of a later version than kRecordVersion.
void mark_complete(Tree& config);

/// Reads config files, once each, and composes them.
///
/// Which keys are groups, the field list of the config says (Field::group()). A plain name there, in the file or as an
/// override, chooses the file <folder>/<group>/<name>.yaml, in the first folder that has it of: the config's own, the
/// nearest named `configs` above it, ./configs, and the program's own configs. A name without such a file is taken as
/// the type of a plugin with default options. A group may name a program to be run, so it has to be the user's: what
/// lies in a folder into which all users put files (the sticky bit, as /tmp has it), or in a ./configs that others may
/// write, is refused in words.
///
/// A group within another takes the place of what that one has there, as the set of effects that `scene.effects` names.
/// The group `strategy` is no option: it bundles settings of any keys that decide where to tap and what is believed:
/// its file is a config like any other, in strategy/ or in the folder itself, so that a whole config is a strategy as
/// well. Named by the config it is laid below the groups that the config names; as an override it takes the place of
/// each top-level key that it has. What it says of keys that are the run's own (Field::of_run()) is left out, but for
/// a motion that it writes out (`motion: {...}`; a name is left out): that counts, as a whole, where neither a group
/// nor the config says any of it. So no strategy makes an arm faster than its own config has it.
class Composer {
 public:
  /// `shipped` is the program's own folder of configs; it need not exist. `keys` must outlive it.
  Composer(std::filesystem::path shipped, const ConfigKeys& keys) : shipped_(std::move(shipped)), keys_(keys) {}

  /// The strategy, groups in the order of `defaults`, then the file, then `overrides` in order.
  ///
  /// A group chosen by an override takes the place of the group chosen before at that path; what the file itself says
  /// there stays, as far as the new type has that option (see resolve()). A map given for a group is laid over it; any
  /// other value takes the place of what was there. `file` is taken as found() has it. Throws Error for missing files,
  /// unknown groups, cycles and groups that build on each other more than 16 deep.
  Tree compose(const std::filesystem::path& file, const std::vector<Override>& overrides);

  /// `file`, or where there is none of a relative name configs/..., the program's own of that name: what a checkout has
  /// beside it is there wherever an installed program is called.
  std::filesystem::path found(const std::filesystem::path& file) const;

  /// A group that was read from a file.
  struct Group {
    std::string path;  ///< where it went, `height.kernel`
    std::string name;
    std::filesystem::path file;
  };
  /// Those of the last composition, in the order in which they were laid.
  const std::vector<Group>& groups() const { return groups_; }

  /// The files that a name may choose at a group, by that name, for a config in the folder `beside`.
  std::map<std::string, std::filesystem::path> files_of(const std::string& group,
                                                        const std::filesystem::path& beside) const;
  /// The names that a config may choose at a group, sorted: beside the config of the last composition.
  std::vector<std::string> names_of(const std::string& group) const;

 private:
  /// Of a group by its name, which is the value: the type that the group brings has the layer of that.
  using Choice = Override;

  const Tree& load(const std::filesystem::path& file);
  std::vector<Choice> take_defaults(Tree& own) const;
  /// A plugin inside another, for example an item of a list: it is there only once the whole tree is.
  void choose_inner(Tree& tree, const Choice& choice, const std::filesystem::path& beside);
  void take_names(Tree& tree, const std::string& path, std::vector<Choice>& choices) const;
  /// The group's file, empty if there is none. Throws Error, with `place`, where only one is that others may have put
  /// there.
  std::filesystem::path find_group(const std::string& group, const std::string& name, const Place& place,
                                   const std::filesystem::path& beside) const;
  void note_group(const Choice& choice, const std::filesystem::path& beside);
  Error no_file(const std::string& group, const std::string& name, const Place& place,
                const std::filesystem::path& beside) const;
  /// What a chosen group brings, its own content on `layer`.
  Tree take_group(const Choice& choice, const std::filesystem::path& beside, Layer layer);
  /// Lays the groups over `tree`, each on layers of its own from `layer` on, which becomes the next free one.
  void lay_groups(Tree& tree, const std::vector<Choice>& choices, const std::filesystem::path& beside, Layer& layer);
  /// The same for the strategy among `choices`, if there is one, which is taken out of them. Returns the layer of its
  /// choice.
  Layer lay_strategy(Tree& tree, std::vector<Choice>& choices, const std::filesystem::path& beside, Layer& layer,
                     std::vector<std::string>& chain);
  /// Folders to look in, the first first; and those that are passed over because others may have put something there.
  struct Roots {
    std::vector<std::filesystem::path> safe, open;
  };
  Roots roots(const std::filesystem::path& beside) const;
  /// What a group's file says, on layer 0, laid over what it builds on, on the layers below.
  Tree group_content(const std::string& group, const std::string& name, const Place& place,
                     const std::filesystem::path& beside, std::vector<std::string>& chain);
  /// The same for the group of that name that another builds on.
  Tree base_content(const std::string& group, const Tree& name, const std::filesystem::path& beside,
                    std::vector<std::string>& chain);

  /// Whether a path leads into a group, as kernel.kernels.0.kernel does: to a plugin inside another.
  bool is_inner(const std::string& path) const;

  std::filesystem::path shipped_;
  const ConfigKeys& keys_;
  std::map<std::filesystem::path, Tree> files_;
  /// Of group, name and folder: the content of a group that another builds on. Each is composed once, though many may
  /// build on it.
  std::map<std::array<std::string, 3>, Tree> bases_;
  std::map<std::string, Tree> brought_;  ///< by the strategy of this composition, for runs that do not say them
  std::vector<Group> groups_;
  std::filesystem::path beside_;  ///< the folder of the config of the last composition
  /// Of group, name and folder: where their file is. A sweep composes the same groups again and again.
  mutable std::map<std::array<std::string, 3>, std::filesystem::path> found_;
};

}  // namespace palpate
