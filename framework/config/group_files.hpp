// SPDX-License-Identifier: MIT
// Searches for the files of config groups.
#pragma once

#include "config/tree.hpp"

#include <palpate/error.hpp>

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpate {

/// Finds the file <folder>/<group>/<name>.yaml of a group. It searches the folder of the config, the nearest folder
/// named `configs` above it, ./configs, and the configs of the program. The first file found is used.
///
/// A group file may name a program that a run starts, so other users must not be able to supply a group file. A file is
/// rejected if all users may put files into its folder, as into /tmp (sticky bit). In ./configs, a file is also
/// rejected if others may write there.
class GroupFiles {
 public:
  /// `shipped`: the configs of the program. The folder need not exist.
  explicit GroupFiles(std::filesystem::path shipped) : shipped_(std::move(shipped)) {}

  /// Returns the file of a group for a config in the folder `beside`; "" if there is none. Throws Error, which names
  /// `place`, if the only file is in a folder where other users may write. Throws Error if the permissions of a folder
  /// forbid the search.
  std::filesystem::path find(const std::string& group, const std::string& name, const SourceLocation& place,
                             const std::filesystem::path& beside) const;

  /// Returns all files of a group for a config in the folder `beside`, by their names.
  std::map<std::string, std::filesystem::path> list(const std::string& group,
                                                    const std::filesystem::path& beside) const;

  /// Returns the error for a name that has no file, with the nearest name as the hint.
  Error missing(const std::string& group, const std::string& name, const SourceLocation& place,
                const std::filesystem::path& beside) const;

  /// Returns `file`. If `file` is a relative name configs/... that does not exist, returns the program's own config of
  /// this name instead. An installed program therefore finds its configs from every working folder.
  std::filesystem::path config(const std::filesystem::path& file) const;

  /// Returns the folder that contains the group folder of `file`. The search for groups on which the group of `file`
  /// builds starts in this folder.
  static std::filesystem::path root_of(const std::filesystem::path& file, const std::string& group);

 private:
  /// Folders to search. All safe folders are searched before the open folders.
  struct Roots {
    std::vector<std::filesystem::path> safe;
    std::vector<std::filesystem::path> open;  ///< folders in which other users may have put a file
  };
  Roots roots(const std::filesystem::path& beside) const;

  std::filesystem::path shipped_;
  /// Cached results of find() by group, name and folder, because a sweep needs the same groups for each job.
  mutable std::map<std::array<std::string, 3>, std::filesystem::path> found_;
};

}  // namespace palpate
