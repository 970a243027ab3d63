// SPDX-License-Identifier: MIT
// The table of `palpate list`, with one line per run or sweep. A folder may hold hundreds of runs. For a run that has
// ended, the list therefore reads only the config and the summary, but no taps.
#pragma once

#include "record/distinguishing_settings.hpp"
#include "record/row.hpp"
#include "sweep/where_condition.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// A run or a sweep in the list.
struct ListedRecord {
  /// Fields that are shown. All records have `name`, `begun`, `strategy`, `scene` and `directory`. A run also has
  /// `taps`, errors and `state`; a sweep also has `jobs`, `jobs_done`, `jobs_failed` and `jobs_running`. Unknown values
  /// are null.
  Row row;
  Row beside;  ///< further fields for conditions: fields of the summary, and keys of the config that the summary lacks
  RecordedSettings config;
  std::string swept;  ///< swept keys of a sweep: "seed (30), acquisition (2)"
};

/// Reads the run or sweep in `directory`. The fields `strategy` and `scene` contain the names of the config groups that
/// were chosen. If the config names no group, they contain the type of the acquisition and the shapes of the objects.
/// Throws Error for a damaged record.
ListedRecord list_record(const std::filesystem::path& directory);

/// Adds the field `apart` to each row: its differences from other records with the same name, or null if there are
/// none. The differences are the swept keys and the distinguishing_settings(). Runs are compared with runs and sweeps
/// with sweeps, because configs of sweeps lack the default values. Moves the configs out of `records`, so they are
/// empty afterwards.
void add_differences(std::vector<ListedRecord>& records);

/// Returns the rows of the records that satisfy `where`. A field that only other records have is null. Throws Error for
/// a field that no record has.
std::vector<Row> rows_where(const std::vector<ListedRecord>& records, const WhereCondition& where);

/// Returns a line of titles and one line per row. Returns "" if there are no rows.
std::string runs_table(const std::vector<Row>& rows);

}  // namespace palpate
