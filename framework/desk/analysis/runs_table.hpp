// SPDX-License-Identifier: MIT
// What runs and sweeps come to at a glance, a line each: the table of `palpate list`. Of a run that has ended config
// and summary are read, and no tap: there may be hundreds.
#pragma once

#include "record/distinctions.hpp"
#include "record/row.hpp"
#include "sweep/condition.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// A run or a sweep as it is listed.
struct ListedRecord {
  /// `name`, `begun`, `strategy`, `scene`, of a run `taps`, errors and `state`; of a sweep `jobs` and how many are
  /// `jobs_done`, `jobs_failed` and `jobs_running`; `directory`. Null is what is not known.
  Row row;
  Row beside;  ///< what else a condition may name: fields of the summary, then keys of the config
  RecordedSettings config;
  std::string swept;  ///< of a sweep, the swept keys: "seed (30), acquisition (2)"
};

/// Reads the one in `directory`. A strategy and a scene are called as the group is that a config named, else by what
/// they are made of: the type of the acquisition, the shapes of the objects. Throws Error for a damaged one.
ListedRecord list_record(const std::filesystem::path& directory);

/// Gives each row `apart`, what sets it apart from those of its name: what is swept, then distinguishing_settings()
/// among runs, or among sweeps, as the config of a sweep has no defaults; null where there is nothing. Takes the
/// configs away.
void tell_apart(std::vector<ListedRecord>& records);

/// The rows of those of which `where` holds. A name that only others have is null, as everywhere in conditions. Throws
/// Error for a name that none has.
std::vector<Row> rows_where(const std::vector<ListedRecord>& records, const Condition& where);

/// The rows under a header; "" if there are none.
std::string runs_table(const std::vector<Row>& rows);

}  // namespace palpate
