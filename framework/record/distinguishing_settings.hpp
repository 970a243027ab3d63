// SPDX-License-Identifier: MIT
// Settings by which runs of the same name differ, for the table of `palpate list` and for errors about ambiguous names.
#pragma once

#include "record/row.hpp"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace palpate {

/// The part of a recorded config that can be compared with other configs.
struct RecordedSettings {
  Row values;                                           ///< every value by its dotted path
  std::map<std::string, std::set<std::string>> groups;  ///< files of configs/KIND/ that set any of the values, by KIND
};

/// Returns the groups named in `origins`, which come from recorded_origins().
std::map<std::string, std::set<std::string>> recorded_groups(const std::map<std::string, std::string>& origins);

/// Returns up to three settings, such as "scene ring" or "taps 30", for each of `runs`, which all have the same name.
/// The first setting distinguishes the run from as many other runs as possible, the second from as many of the
/// remaining runs as possible. A setting that distinguishes no further run is returned only if no other returned
/// setting is from the same block of the config. On a tie, the seed comes first, and a group comes before its values.
/// Settings that are equal in all runs, or missing in this run, are never returned.
std::vector<std::vector<std::string>> distinguishing_settings(const std::vector<RecordedSettings>& runs);

}  // namespace palpate
