// SPDX-License-Identifier: MIT
// The table of `palpate list`: runs and sweeps, one line each. For a run that has ended, config and summary are read,
// but no taps: a folder may hold hundreds of runs.
#pragma once

#include "record/distinguishing_settings.hpp"
#include "record/row.hpp"
#include "sweep/condition.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// A run or a sweep in the list.
struct ListedRecord {
  /// Fields `name`, `begun`, `strategy`, `scene` and `directory`; for a run `taps`, errors and `state`; for a sweep
  /// `jobs`, `jobs_done`, `jobs_failed` and `jobs_running`. Unknown values are null.
  Row row;
  Row beside;  ///< further names for conditions: fields of the summary, then keys of the config
  RecordedSettings config;
  std::string swept;  ///< swept keys of a sweep: "seed (30), acquisition (2)"
};

/// Reads the run or sweep in `directory`. Strategy and scene have the name of the group in the config; otherwise the
/// type of the acquisition and the shapes of the objects. Throws Error for a damaged record.
ListedRecord list_record(const std::filesystem::path& directory);

/// Adds to each row `apart`, the differences from other rows with the same name: swept keys, then
/// distinguishing_settings(), among runs or among sweeps (configs of sweeps have no defaults); null for no difference.
/// Moves the configs out of `records`.
void add_differences(std::vector<ListedRecord>& records);

/// Returns the rows of the records that satisfy `where`. A name that only other records have is null. Throws Error for
/// a name that no record has.
std::vector<Row> rows_where(const std::vector<ListedRecord>& records, const Condition& where);

/// Returns the rows below a line of titles; "" without rows.
std::string runs_table(const std::vector<Row>& rows);

}  // namespace palpate
