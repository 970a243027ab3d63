// SPDX-License-Identifier: MIT
// The records of a run and their fields: a tap, the times of a tap, the summary. To add a field is to add a line to
// fields.cpp: files, `expect:`, `--where`, `--metric`, `palpate pareto`, pages and the tables of runs/README.md have it
// from there.
#pragma once

#include "experiment/tap_record.hpp"
#include "record/field.hpp"
#include "record/resolved.hpp"

#include <palpate/error.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// What summary.json is made of. Times and memory are absent where nobody measured them.
struct Summary : RunResult {
  const ResolvedConfig& config;
  std::string failure;  ///< "" unless the run failed
  std::optional<double> wall_seconds, compute_seconds;
  std::optional<std::array<double, kPhases>> phases;  ///< seconds, all taps
  std::optional<std::int64_t> peak_rss_bytes;
};

/// The field with the RMSE that a run expects at its end.
inline constexpr const char* kExpectedError = "expected_rmse_m";

/// Wall seconds of one tap by phase, as its line `timing` has them.
struct TapTimes {
  int tap = 0;
  std::array<double, kPhases> seconds{};
  std::optional<double> expected_rmse = std::nullopt;  ///< before the tap, metres; where it was shown
};

/// One of the objects in the line `objects`.
struct ObjectRow : ObjectResult {
  int object = 0;
  std::string type;
};

const FieldList<TapRecord>& tap_list();
const FieldList<Summary>& summary_list();
const FieldList<TapTimes>& timing_list();
const FieldList<ObjectRow>& object_list();

/// What became of each object, where the truth is known; none where it is not.
std::vector<Row> object_rows(const Summary& summary);

/// The fields that every summary has, in their order; those of the models depend on the config.
const std::vector<RecordField>& summary_fields();

/// The field of the summary with that name, or null.
const RecordField* find_summary_field(const std::string& name);

/// The dimension of a column of results.csv: of a field as listed, of any other by the end of its name, `_m` or
/// `_seconds`.
Unit unit_of_column(const std::string& name);

/// Whether a field of the summary depends on clock, memory or machine rather than on the config.
bool depends_on_machine(const std::string& name);

/// Whether a field of a tap or of the summary has a value only where the truth is known.
bool needs_truth(const std::string& name);

// Taps as lines of record.jsonl and rows of taps.csv.

/// Returns the row of a tap after it was made.
Row tap_row(const TapRecord& tap);
/// Returns the row of a tap before it is made: its first field is `intent`, and its result is null or left out.
Row intent_row(const TapRecord& tap);
/// Returns an intent as a tap whose result is unknown.
Row unknown_result_of(const Row& intent);
/// Returns the taps of recorded rows, as far as a resumed run needs them: their state and errors stay in the rows.
/// Throws Error, naming `file` and the tap, for a damaged row.
std::vector<TapRecord> read_taps(const std::vector<Row>& rows, const std::filesystem::path& file);
/// Returns whether the contact of a row is on an object as `counts` reads it; nullopt without a contact.
std::optional<bool> label_now(const Row& row, const RunResult& counts);

const char* outcome_name(Outcome outcome);
const char* source_name(Source source);

/// How far a surface is from the truth, best known first: the fields that a tap and a summary share.
const std::vector<RecordField>& error_fields();

/// Returns the contacts whose label at the end is another than the record of their tap has, by the field `relabelled`
/// of a summary.
std::vector<Relabelled> relabelled_in(const Row& summary);

/// Returns the name of the root mean square error of whole reconstructions: `rmse_m`, or where summaries have only
/// that, `rms_surface_distance_m`, the error from any side.
std::string main_error(const std::vector<Row>& summaries);

/// Adds the errors to a row, null where no truth is known; and finds them in one.
void add_errors(Row& row, const Errors& errors);
Errors errors_in(const Row& row);

}  // namespace palpate
