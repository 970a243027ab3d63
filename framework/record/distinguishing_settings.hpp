// SPDX-License-Identifier: MIT
// Settings that set the runs of one name apart, for the table of `palpate list` and for names that several runs have.
#pragma once

#include "record/row.hpp"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace palpate {

/// A recorded config as far as it can be compared with others.
struct RecordedSettings {
  Row values;  ///< every value by its dotted path
  std::map<std::string, std::set<std::string>>
      groups;  ///< files of configs/KIND/ that wrote any of the values, by KIND
};

/// Returns the groups in the origins of a record, as recorded_origins() returns them.
std::map<std::string, std::set<std::string>> recorded_groups(const std::map<std::string, std::string>& origins);

/// Returns, for each of these runs of one name, up to three settings such as "scene ring" or "taps 30", the most
/// telling first: the one that sets this run apart from most others, then the one that does so from most of the rest,
/// then one for each other block of the config that differs. Of equally telling settings the seed comes first, a group
/// before its values. A setting that is equal in all runs, or is not written in this one, is never returned.
std::vector<std::vector<std::string>> distinguishing_settings(const std::vector<RecordedSettings>& runs);

}  // namespace palpate
