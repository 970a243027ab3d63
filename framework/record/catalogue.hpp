// SPDX-License-Identifier: MIT
// Finds the runs and sweeps in a folder. Also finds the run or sweep that a user names by its directory, by a folder
// that contains it, or by its name. All commands that take a run or a sweep use these functions, so all accept the same
// arguments.
#pragma once

#include "config/tree.hpp"
#include "record/row.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// The runs and sweeps in a folder, up to three levels below it. This suffices for runs/NAME/ID, even if the folder is
/// the parent of `runs`. Links are skipped, and so are hidden folders, where sweeps are prepared. The folders of runs
/// and sweeps are not searched, so the jobs of a sweep do not count as runs.
struct Catalogue {
  std::vector<std::filesystem::path> records;  ///< directories of runs and sweeps, in the order of their start
  int strangers = 0;                           ///< subfolders without a record below them and without a README.md
  int moved_aside = 0;                         ///< runs that --force moved aside: <id>.old-N
};

/// Searches `folder`, which may be a record itself. Folders that this user may not enter count as empty. Does not
/// throw.
Catalogue read_catalogue(const std::filesystem::path& folder);

/// Returns the local time at which the run or sweep in `directory` was started, as 2026-11-24T23:59:28. This is the
/// modification time of config.yaml, which is written only when the run or sweep starts. If a copy does not keep file
/// times (`cp -r`, git), the result is the time of the copy. Returns "" without a config.yaml.
std::string begun_text(const std::filesystem::path& directory);

/// Returns all values of a config, as written, by their dotted paths.
Row settings_of(const Tree& config);
/// Returns all values of the config.yaml of a record. Throws Error.
Row read_settings(const std::filesystem::path& directory);

/// Returns the keys whose values differ between configs from read_settings(). The seed comes first, because most runs
/// with the same name differ in the seed. The key `complete`, the version of the format, is left out.
std::vector<std::string> differing_keys(const std::vector<Row>& configs);

/// The kind of record that a command accepts; records of the other kind are ignored if one of this kind exists.
enum class RecordKind { run, sweep, any };

/// Returns the directory of the record to which `words`, the user's argument, refer. The meanings are tried in this
/// order:
///
/// 1. an existing path: a record, or a folder that contains one;
/// 2. the name of a run: `name` of its config, or its folder in `runs`. A folder of this name that contains no record
///    is ignored;
/// 3. a path or name followed by @latest, which stands for the record that was started last.
///
/// Returns a path without a record unchanged; the caller then reports what is missing there. Throws Error for an
/// unknown name. Throws Error if several records match; the message lists the most recent ones and the settings that
/// distinguish them.
std::filesystem::path find_record(const std::string& words, RecordKind wanted = RecordKind::any,
                                  const std::filesystem::path& runs = "runs");

/// Returns the directories of all records to which several words refer, for commands that treat many records as one
/// sweep. A word refers to the sweep that find_record() finds. A folder or name without a sweep refers to all its runs.
/// With several words, files are skipped, because the * of a shell also matches tables next to runs. Throws Error as
/// find_record() does.
std::vector<std::filesystem::path> find_records(const std::vector<std::string>& words,
                                                const std::filesystem::path& runs = "runs");

}  // namespace palpate
