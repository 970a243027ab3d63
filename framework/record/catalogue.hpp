// SPDX-License-Identifier: MIT
// Which runs and sweeps a folder holds, and which one of them a person means who gives a directory, a folder with one
// in it, or a name. Every command that takes a run or a sweep asks here, and so all understand the same words.
#pragma once

#include "config/tree.hpp"
#include "record/row.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// What lies in a folder of runs, three folders deep: runs/NAME/ID and one above. Links and hidden folders, where a
/// sweep is drafted, are not entered; neither are runs and sweeps, so that a sweep's jobs are no runs of their own.
struct Catalogue {
  std::vector<std::filesystem::path>
      records;          ///< directories of runs and sweeps, in the order in which they were begun
  int strangers = 0;    ///< folders right in it with no record below and no README.md
  int moved_aside = 0;  ///< runs that --force moved out of the way: <id>.old-N
};

/// Looks through `folder`, which may be a record itself. What may not be entered holds nothing. Throws nothing.
Catalogue read_catalogue(const std::filesystem::path& folder);

/// When the run or sweep in `directory` was begun, local time, as 2026-11-24T23:59:28: its config.yaml is written then
/// and never again. A copy that does not keep times (`cp -r`, git) was begun when it was made. "" if nothing tells.
std::string begun_text(const std::filesystem::path& directory);

/// Every value of a config, as it is written there, by its dotted path.
Row settings_of(const Tree& config);
/// The same of the config.yaml of a record. Throws Error.
Row read_settings(const std::filesystem::path& directory);

/// The keys at which configs, as of read_settings(), differ: the seed first, as it is what most runs of a name differ
/// by; never `complete`, the version of the record's form.
std::vector<std::string> differing_keys(const std::vector<Row>& configs);

/// What a command can do something with; where that is there, the other is not meant.
enum class Wanted { run, sweep, any };

/// The directory of the record that `words` mean, in this order:
///
/// 1. a path that exists: a record itself, or a folder with one below;
/// 2. the name of a run, as its config has it or as its folder in `runs` is called; also where a folder of that name
///    has no record below;
/// 3. either with @latest behind it: of several the one that was begun last.
///
/// A path at which there is no record comes back as it is: who reads it knows what is missing there. Throws Error for a
/// name that nothing has, and where several are meant, with what sets the last of them apart.
std::filesystem::path find_record(const std::string& words, Wanted wanted = Wanted::any,
                                  const std::filesystem::path& runs = "runs");

/// Returns the directories of all records that several such words mean, for commands that take many as one sweep. A
/// word means the sweep that find_record() finds; a folder or a name that has no sweep means all its runs. Among
/// several words files are passed over: a shell's * names the tables beside runs, too. Throws Error as find_record()
/// does.
std::vector<std::filesystem::path> find_records(const std::vector<std::string>& words,
                                                const std::filesystem::path& runs = "runs");

}  // namespace palpate
